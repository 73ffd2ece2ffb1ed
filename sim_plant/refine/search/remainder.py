"""What the effects found leave: its class, and whether they imitate what is not there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import gauss_newton_fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.search.selection import Selection, imitates
from sim_plant.refine.search.set_apart import set_apart, wander_of
from sim_plant.refine.search.unexplained import Unknown, what_is_left


def classified(objective: Objective, selection: Selection) -> Selection:
    """Return the selection with the class of what is left, slow changes of effects apart.

    What is left beside a strong effect is looked at for an imitation as an effect is accepted
    there: apart from the strong one's own spectral lines, at which its model error lies.
    """
    wander = wander_of(objective, selection)
    apart = set_apart(objective, selection, at_spectral_lines=False, wander=wander)
    weigh, seen = (objective, selection) if apart is None else (apart.objective, apart.selection)
    fit = seen.fit
    unknown = what_is_left(weigh, selection.nominal, fit, selection.record_axes, seen.spectra_left)
    nominal_excess = selection.nominal.cost - objective.expected_cost
    excess = weigh.excess(fit.cost, fit.residual)
    if not unknown and imitates(selection.accepted, excess, nominal_excess):
        apart = set_apart(objective, selection, at_spectral_lines=True, wander=wander)
        if apart is not None:
            fit = apart.selection.fit
            excess = apart.objective.excess(fit.cost, fit.residual)
        if imitates(selection.accepted, excess, nominal_excess):
            unknown = [Unknown(unknown_class="broadband", chi2_reduction=excess, coordinate={})]
    return replace(selection, unknown=tuple(unknown))


def shown_before(objective: Objective, selection: Selection) -> list[int]:
    """Return indices of effects that a record shows before an unknown event begins in it.

    With them it is as quiet as noise there, which is what makes the event one: what comes later
    says nothing against them. Without the effect, all else as it is, that part has more by what a
    later effect needs.
    """
    events = [u.coordinate for u in selection.unknown if u.unknown_class == "event"]
    if not events:
        return []
    record = int(events[0].get("record", 1)) - 1
    step_s = objective.pool.twins[record].declaration.sample_time_s
    first = objective.whitening.noise[record].first
    end = max(0, round(float(events[0]["from_s"]) / step_s) - first)
    fit = selection.fit

    def before(residual: Array) -> float:
        return float(np.sum(objective.split(residual)[record][:, :end] ** 2))

    found, least = [], CRITERIA.search.acceptance.later_score
    for k in range(len(fit.hypotheses)):
        fewer = fit.without_effect_at(k)
        without = gauss_newton_fit(
            objective, fewer.hypotheses, fewer.values, fit.shifts, rounds=0, quick=False
        )
        if before(without.residual) - before(fit.residual) > least:
            found.append(k)
    return found
