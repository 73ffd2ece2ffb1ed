"""What is left on the record judged with the next best explanation in the place of an effect."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from sim_plant.refine.confirm import RecordWithTwin
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, gauss_newton_fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.judge.holdout import evaluate
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.search.candidate import Progress
from sim_plant.refine.search.outside_prior import total_shifts
from sim_plant.refine.search.selection import AcceptedEffect, Selection

ROUNDS = CRITERIA.search.exchange.rounds


def with_rivals_refitted(
    objective: Objective, selection: Selection, progress: Progress
) -> Selection:
    """Return the selection with each effect's rival in its place, beside all others.

    Numbers are fitted again, the responses to declared numbers are those that ``objective`` has:
    to take them anew around each rival costs a third of a whole run. None is where the search
    fitted no rival, and none beside something unknown: that would go into what either leaves.
    """
    if not selection.accepted:
        return selection
    progress("the next best explanation of each effect in its place")
    accepted = tuple(
        replace(a, rival=None if selection.unknown else _refitted(objective, selection, k, a))
        for k, a in enumerate(selection.accepted)
    )
    return replace(selection, accepted=accepted)


def _refitted(
    objective: Objective, selection: Selection, at: int, accepted: AcceptedEffect
) -> Fit | None:
    """Return the fit with the runner-up in the place of effect ``at``, its shifts those of all."""
    rival, found = accepted.rival, selection.fit
    if rival is None or accepted.runner_up in {h.key for h in found.hypotheses}:
        return None
    rows = zip(rival.hypotheses, rival.values, strict=True)
    there = [(h, values) for h, values in rows if h.key == accepted.runner_up]
    if not there:  # the runner-up is another one by now, which was not fitted
        return None
    start = found.with_effect_at(at, *there[-1])
    fit = gauss_newton_fit(
        objective, start.hypotheses, start.values, rival.shifts, rounds=ROUNDS, quick=False
    )
    if not math.isfinite(fit.cost):
        return None
    return replace(fit, shifts=total_shifts(objective, fit))


def left_by_rivals(
    judged: RecordWithTwin,
    selection: Selection,
    workers: int,
    progress: Progress,
    *,
    held_out: bool,
) -> tuple[Mapping[str, float], ...]:
    """Return rms by channel on a record, per effect with its rival in its place; empty of none."""
    return tuple(
        _left(judged, a.rival, workers, progress, held_out=held_out)
        if a.rival is not None and _stands_beside_the_rest(selection, a.rival)
        else {}
        for a in selection.accepted
    )


def _stands_beside_the_rest(selection: Selection, rival: Fit) -> bool:
    """Return whether all that is claimed, and no more, is beside the rival: none was withdrawn."""
    return not selection.unknown and len(rival.hypotheses) == len(selection.fit.hypotheses)


def _left(
    judged: RecordWithTwin, rival: Fit, workers: int, progress: Progress, *, held_out: bool
) -> dict[str, float]:
    shifts = tuple(sorted(rival.shifts.items()))
    with SimulationPool([judged.twin], workers, progress) as pool:
        found = evaluate(pool, judged.measured, rival.effects, shifts, find_angles=held_out)
    return dict(zip(found.channels, map(float, found.rms_amended), strict=True))
