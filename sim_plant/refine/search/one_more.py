"""One more effect of a group beside those found: screen, fit, score, accept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sim_plant.refine.fit.gauss_newton import Fit, gauss_newton_fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.search.added_effect import rolling_only
from sim_plant.refine.search.candidate import Candidate, FittedCandidate, Progress, sure_fall
from sim_plant.refine.search.completeness import explains_own_spectral_lines
from sim_plant.refine.search.degenerate_pair import better_pair
from sim_plant.refine.search.effect_fit import fit_candidates
from sim_plant.refine.search.outside_prior import by_records, ending_conflict
from sim_plant.refine.search.own_moments import more_than_model_errors
from sim_plant.refine.search.screening import screen, shortlist, without_failed
from sim_plant.refine.search.selection import (
    ACCEPTANCE,
    Extension,
    Selection,
    accept,
    also_explained_by,
    confirmed_scores,
    is_shown,
)
from sim_plant.refine.search.set_apart import JudgedApart
from sim_plant.refine.spectra.coordinates import is_periodic


def best_of(
    objective: Objective,
    selection: Selection,
    group: Sequence[Hypothesis],
    progress: Progress,
    rivals: Sequence[FittedCandidate] = (),
    events: Sequence[Candidate] = (),
    apart: JudgedApart | None = None,
    *,
    beside_half: bool = False,
) -> Extension | None:
    """Return the effect of a group that is accepted in addition to those found, or None.

    ``rivals`` are fits made already that compete with the group, ``events`` further first looks.
    With ``apart`` the group is looked at and judged apart from what those found leave by nature.
    ``beside_half``: those found are half of a pair, see `shortlist`.
    """
    base = selection.fit
    weigh, judged = (objective, selection) if apart is None else (apart.objective, apart.selection)
    periodic = not group or is_periodic(group[0])
    lasting = base if periodic else looked_from(base, apart)
    candidates = [*screen(weigh, lasting, group, progress), *events]
    candidates.sort(key=lambda c: -c.score)
    tried = shortlist(candidates, beside_half=beside_half)
    fitted = [*rivals, *fit_candidates(objective, base, tried, progress)]
    candidates = without_failed(candidates, tried, fitted)
    if apart is not None:
        fitted = [apart.re_evaluated_candidate(c) for c in fitted]
    fitted = more_than_model_errors(weigh, base, fitted, progress)
    fitted = [by_records(weigh, c) for c in fitted]
    if selection.accepted:
        shown = [c for c in fitted if is_shown(judged, c)]
        rest = [c for c in fitted if not is_shown(judged, c)]
        fitted = [*shown, *ending_conflict(weigh, base, rest)]
    scored = confirmed_scores(
        judged, fitted, lambda fit: chi2_without_last(objective, fit, apart), progress
    )
    extension = accept(judged, scored, candidates, progress)
    if extension is None or extension.accepted.score >= ACCEPTANCE.beyond_doubt:
        return extension
    pair = better_pair(objective, base, selection.record_axes[0], extension.hypothesis, candidates)
    if pair:
        progress(f"  as well told by {' and '.join(map(str, pair))} together")
    return also_explained_by(extension, pair)


def looked_from(fit: Fit, apart: JudgedApart | None) -> Fit:
    """Return the fit from which effects that are not periodic get their first look.

    Declared numbers may have moved to imitate the effect, so all but effective radii are back as
    declared. Not with ``apart``: a strong spectral line answers to declared numbers by more than
    to a weak effect, so no linear step finds back.
    """
    return fit if apart is not None else replace(fit, shifts=rolling_only(fit.shifts))


def chi2_without_last(objective: Objective, fit: Fit, apart: JudgedApart | None = None) -> float:
    """Return how much the cost rises without the last effect, all else fitted anew from here.

    With ``apart`` that is the cost apart from what those found leave by nature. Both are at the
    declared drive tick. A fit that was made again finds a better place for the declared numbers
    too, and a quick tick moves the speed at which a quantised loop rests: those shares are not
    the effect's.
    """
    there = gauss_newton_fit(
        objective, fit.hypotheses, fit.values, fit.shifts, rounds=2, quick=False
    )
    without = gauss_newton_fit(
        objective, fit.hypotheses[:-1], there.values[:-1], there.shifts, rounds=2, quick=False
    )
    if apart is not None:
        without, there = (apart.re_evaluated_fit(f, quick=False) for f in (without, there))
    return sure_fall(objective if apart is None else apart.objective, without, there)


def explains_own_lines(
    objective: Objective, selection: Selection, fit: Fit, apart: JudgedApart | None = None
) -> bool:
    """Return whether the effects that ``fit`` adds explain their own spectral lines."""
    if apart is not None:
        return apart.explains_own_spectral_lines(fit)
    return explains_own_spectral_lines(
        objective, selection.fit, selection.spectra_left, selection.record_axes, fit
    )
