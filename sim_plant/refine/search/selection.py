"""What the search has found so far, as a value, and which candidate it accepts next."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.search.candidate import Candidate, FittedCandidate, Progress
from sim_plant.refine.search.completeness import Spectra
from sim_plant.refine.search.strongest_zone import Heard
from sim_plant.refine.search.unexplained import Unknown
from sim_plant.refine.spectra.coordinates import RecordAxes, is_periodic, orders_of

ACCEPTANCE = CRITERIA.search.acceptance
Ranges = Mapping[str, tuple[float, float]]
"""Low and high of numbers by name."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AcceptedEffect:
    """One accepted effect, and what it was chosen against.

    Attributes
    ----------
    runner_up : the next best candidate, if there is one.
    margin : by how much the runner-up's score is behind.
    rejected : the best other candidates and their scores, best first.
    ambiguous : effects and places that explain as much.
    shared : the records show that it, or what stood in for it, is there, and not which of them.
    rival : a fit that has the runner-up; None where it was not fitted.
    """

    hypothesis: Hypothesis
    score: float
    runner_up: EffectAt | None
    margin: float
    rejected: tuple[tuple[EffectAt, float], ...]
    ambiguous: tuple[EffectAt, ...] = ()
    shared: bool = False
    rival: Fit | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Extension:
    """One more effect, and the fit that has it."""

    accepted: AcceptedEffect
    fit: Fit

    @property
    def hypothesis(self) -> Hypothesis:
        """The effect that is added."""
        return self.accepted.hypothesis


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Selection:
    """Everything that was found.

    Attributes
    ----------
    nominal, fit : without effects, and with those accepted.
    record_axes : time, travel and angles of each record. ``heard_declared`` : what is left there.
    spectra_declared, spectra_left : of free spectral lines in what ``nominal`` and ``fit`` leave.
    accepted : effects of ``fit``, in order.
    unknown : what no effect explains.
    adjustments : changes of declared numbers as re-estimated with the effects, by path: none where
        structure is left that is no spectral line, for they may then have imitated it.
    chi2_of_free_terms : what free terms took up before the search.
    wander_is_free : ``fit`` is weighed with the sizes of its effects free to change slowly.
    ranges : intervals of the numbers of each effect, also of those that no record shows; empty
        until the search is over.
    """

    nominal: Fit
    fit: Fit
    record_axes: tuple[RecordAxes, ...]
    spectra_declared: Spectra
    spectra_left: Spectra
    accepted: tuple[AcceptedEffect, ...] = ()
    unknown: tuple[Unknown, ...] = ()
    adjustments: Mapping[str, float] = field(default_factory=dict)
    chi2_of_free_terms: float = 0.0
    wander_is_free: bool = False
    heard_declared: tuple[Heard, ...] = ()
    ranges: tuple[Ranges, ...] = ()


def alike_margin(explained: float) -> float:
    """Return by how much (chi2) a rival may be behind and still be the true one.

    Equation: max(margin, 4 e^2 X): a response that is wrong by the share e can shift the
    difference of two candidates that explain X by 2 e sqrt(X dX); solved for dX it is 4 e^2 X
    [own].
    """
    error = CRITERIA.search.exchange.model_error
    return max(ACCEPTANCE.margin, 4.0 * error**2 * explained)


def least_score(selection: Selection, candidate: FittedCandidate) -> float:
    """Return the score that a candidate needs beside the effects found, given what those leave.

    A declared number gains as an effect no more than its tolerance cost, z squared, however
    plainly the records show it: none of the other bounds is a ruler for it.

    - As a first effect it needs the square of ``outside_prior_sd``, where it `is_outside`.
    - As a later one it needs no more than a first effect does, where it `is_shown`.
    """
    if is_shown(selection, candidate):
        return ACCEPTANCE.score
    h, aperiodic = candidate.hypothesis, ACCEPTANCE.score
    if selection.accepted:
        aperiodic = later_score(selection)
    elif is_first(selection) and is_outside(candidate):
        aperiodic = CRITERIA.search.degeneracy.outside_prior_sd**2
    return least_beside(selection, ACCEPTANCE.periodic_score if orders_of(h, 1.0) else aperiodic)


def is_shown(selection: Selection, candidate: FittedCandidate) -> bool:
    """Return whether the records show a later effect that is a declared number, by themselves.

    By more than any other effect needs beside those found (`least_beside`): that bounds what
    their models have wrong of the records, and so how far that moves a number. Of one that
    ``ends_conflict`` it, or what stood in for it, is shown (a drag at one of six idlers, or the
    zero of the cell before them): several numbers answer more of what a size wanders, so beside
    that all of it counts. None on a roll with a profile: its mean radius is that's own.
    """
    seen = replace(selection, wander_is_free=False) if candidate.ends_conflict else selection
    least = least_beside(seen, ACCEPTANCE.later_score)
    there = bool(selection.accepted) and candidate.chi2_by_records > least
    return there and not _is_shaped(selection, candidate.hypothesis)


def _is_shaped(selection: Selection, h: Hypothesis) -> bool:
    """Return whether an effect is at a roll for which a profile was found."""
    found = (a.hypothesis for a in selection.accepted)
    return h.location in {f.location for f in found if f.effect.profiles is not None}


def by_what_records_say(selection: Selection, candidate: FittedCandidate) -> bool:
    """Return whether a candidate is claimed by what the records say, less than others need."""
    if is_first(selection):
        return is_outside(candidate)
    less = candidate.ends_conflict or candidate.score < least_beside(selection, ACCEPTANCE.score)
    return less and is_shown(selection, candidate)


def is_first(selection: Selection) -> bool:
    """Return whether what is looked for stands beside no effect, nor beside half of a pair."""
    return not selection.accepted and not selection.fit.hypotheses


def later_score(selection: Selection) -> float:
    """Return the score that an effect without a spectral line needs beside those found.

    What a model has wrong can be imitated, and a right effect leaves no more than
    ``remainder_share`` of what it explains. Apart from their model error those found explain less,
    so what they were accepted for counts, if that is more. A declared number does more than it
    gains: beside one it is ``later_score`` always.
    Equation: max(score, min(later_score, remainder_share X)), X what those found explain; of none
    it is ``score``  [own].
    """
    if any(a.hypothesis.effect.declared_as for a in selection.accepted):
        return ACCEPTANCE.later_score
    here = selection.nominal.cost - selection.fit.cost
    explained = max(here, sum(a.score for a in selection.accepted))
    left = CRITERIA.search.unexplained.remainder_share * explained
    return max(ACCEPTANCE.score, min(ACCEPTANCE.later_score, left))


def is_outside(candidate: FittedCandidate) -> bool:
    """Return whether a candidate is a declared number that is surely not within its tolerance.

    Its whole interval is not, and the records alone show its change by more than what models have
    wrong ever came to (``later_score``).
    """
    return candidate.beyond_tolerance and candidate.chi2_by_records > ACCEPTANCE.later_score


def least_beside(selection: Selection, least: float) -> float:
    """Return the score that an effect needs here, if ``least`` is what it needs found alone."""
    explained = selection.nominal.cost - selection.fit.cost
    return max(
        least,
        ACCEPTANCE.explained_share * explained,
        ACCEPTANCE.free_term_share * selection.chi2_of_free_terms,
        sum(_share_left(selection, f.hypothesis) * f.score for f in selection.accepted),
    )


def _share_left(selection: Selection, h: Hypothesis) -> float:
    """Return the share of what an effect explains that it leaves at any coordinate.

    That is what its size wanders. And a shape that was fitted order by order, without a named
    profile, is known at the present radius only: as the roll gets smaller its orders change, and
    leave something everywhere.
    """
    own = {name for pair in h.effect.quadratures for name in (pair.cos, pair.sin)}
    has_free_orders = h.effect.profiles is not None and not own.isdisjoint(h.names)
    own_wander = 0.0 if selection.wander_is_free else h.effect.wander
    return max(own_wander, ACCEPTANCE.explained_share if has_free_orders else 0.0)


def rank(fitted: Sequence[FittedCandidate]) -> list[FittedCandidate]:
    """Return the best fit of every effect and place, best score first."""
    finite = [c for c in fitted if np.isfinite(c.score)]
    finite.sort(key=lambda c: -c.score)
    best: dict[EffectAt, FittedCandidate] = {}
    for c in finite:
        best.setdefault(c.hypothesis.key, c)
    return list(best.values())


def confirmed_scores(
    selection: Selection,
    fitted: Sequence[FittedCandidate],
    rise_without: Callable[[Fit], float],
    progress: Progress,
) -> list[FittedCandidate]:
    """Return fits, small scores limited to what is lost without the effect, best first.

    ``rise_without`` gives by how much the cost rises when the last effect of a fit is removed and
    all else fitted again. Candidates are judged by it in order of score, until one passes and
    ``most_looks`` were judged, so several imitations of one thing hide nothing behind them. All
    others score no higher than the best judged, so that a margin is between like and like; but of
    first effects not those that are no claim by their own score, which differ in what they need.
    """
    ranked = rank(fitted)
    looked_at: list[FittedCandidate] = []
    below: list[FittedCandidate] = []
    best, passed = 0.0, False
    for c in ranked:
        least = least_score(selection, c)
        enough = passed and len(looked_at) >= ACCEPTANCE.most_looks
        if enough or c.score < best - ACCEPTANCE.margin:
            break
        if c.score < least:
            below.append(c)
            continue
        seen = c
        if c.score < ACCEPTANCE.beyond_doubt:
            seen = c.at_most(rise_without(c.fit) - c.penalty)
            if seen.score < least:
                progress(f"  {c.hypothesis.key}: not missed when all else is fitted again")
        passed = passed or seen.score >= least
        looked_at.append(seen)
        best = max(best, seen.score)
    rest = ranked[len(looked_at) + len(below) :]
    if looked_at:
        rest = [c.at_most(best) for c in rest]
        below = below if is_first(selection) else [c.at_most(best) for c in below]
    return sorted([*looked_at, *below, *rest], key=lambda c: -c.score)


def accept(
    selection: Selection,
    scored: Sequence[FittedCandidate],
    candidates: Sequence[Candidate],
    progress: Progress,
) -> Extension | None:
    """Return the effect that explains most, or None when none may be claimed.

    ``candidates`` are first looks; those that were not fitted compete by their linear score. What
    is no claim by its own score hides no effect that is claimed `by_what_records_say`, nor is it a
    rival of it: healthy records, and what models have wrong, reach more than a tolerance costs.
    """
    claims = [c for c in scored if c.score >= least_score(selection, c)]
    if claims and claims[0] is not scored[0]:
        claims = [c for c in claims if by_what_records_say(selection, c)]
    if not claims:
        return None
    best = claims[0]
    h = best.hypothesis
    alone = by_what_records_say(selection, best)
    others = _others(claims, []) if alone else _others(scored, candidates)
    runner_up, second_score = others[0] if others else (None, 0.0)
    if (
        runner_up
        and best.score < ACCEPTANCE.weak
        and not alone
        and best.score - second_score < ACCEPTANCE.margin
        and not is_periodic(h)
    ):
        progress(f"  {h.key}: weak, and not to be told from {runner_up}")
        return None
    progress(f"  best: {h.key}, score {best.score:.0f}")
    margin = alike_margin(best.chi2_reduction)
    alike = [place for place, value in others if best.score - value < margin]
    shared = alone and best.ends_conflict
    if shared:
        alike += [c.hypothesis.key for c in scored if c.ends_conflict and c is not best]
    accepted = AcceptedEffect(
        hypothesis=h,
        score=best.score,
        runner_up=runner_up,
        margin=best.score - max(second_score, 0.0),
        rejected=tuple(others[: ACCEPTANCE.reported_rejected]),
        ambiguous=tuple(dict.fromkeys(alike)),
        shared=shared,
        rival=next((c.fit for c in scored if c.hypothesis.key == runner_up), None),
    )
    return Extension(accepted=accepted, fit=best.fit)


def also_explained_by(extension: Extension, places: Sequence[EffectAt]) -> Extension:
    """Return the extension with further places named that explain as much."""
    named = tuple(dict.fromkeys([*extension.accepted.ambiguous, *places]))
    return replace(extension, accepted=replace(extension.accepted, ambiguous=named))


def preferred(
    complete: Sequence[Extension], partial: Sequence[Extension]
) -> tuple[Extension | None, bool]:
    """Return the extension to go on with, and whether it is accepted alone.

    ``complete`` explain their own spectral lines, ``partial`` leave much of them. A complete one
    that explains less than a partial one gives way to that: it may be half of a pair.
    """
    best = min([*partial, *complete], key=lambda e: e.fit.cost, default=None)
    return best, best in complete


def at_noise_floor(selection: Selection, expected_cost: float, sure_excess: float) -> bool:
    """Return whether what is left is surely less than a further effect would have to explain.

    That is ``floor_share`` of what effects explained, for no model is exact. It has to be more
    than ``sure_excess``, to which noise is known: with weak effects it is not.
    """
    excess = selection.fit.cost - expected_cost
    explained = selection.nominal.cost - selection.fit.cost
    return excess + sure_excess < ACCEPTANCE.floor_share * explained


def imitates(effects: Sequence[AcceptedEffect], excess: float, nominal_excess: float) -> bool:
    """Return whether effects beside a spectral line leave too much to be more than an imitation.

    More is left than a fair share of what those without a spectral line explain, and than
    ``imitated_share`` of what there was without effects (``nominal_excess``). The larger
    ``remainder_share``, as `what_is_left` has it, would be too much beside a strong roll: more
    than any delay explains. Both excesses are chi-squares.
    """
    beside = [e for e in effects if not is_periodic(e.hypothesis)]
    if not beside or len(beside) == len(effects):
        return False
    most = CRITERIA.search.completeness.fair_share * (excess + sum(e.score for e in beside))
    return excess > max(most, CRITERIA.search.unexplained.imitated_share * nominal_excess)


def standing(effects: Sequence[AcceptedEffect], excess: float) -> list[int]:
    """Return indices of effects that may be claimed where ``excess`` (chi2) is left irregular.

    Those at a coordinate of their own that explain a good part of it: what is irregular has a
    share at every spectral line.
    """
    least = CRITERIA.search.completeness.fair_share * excess
    return [k for k, e in enumerate(effects) if is_periodic(e.hypothesis) and e.score > least]


def _others(
    scored: Sequence[FittedCandidate], candidates: Sequence[Candidate]
) -> list[tuple[EffectAt, float]]:
    """Return all but the best with their scores, best first."""
    best = scored[0].hypothesis.key
    others = [(c.hypothesis.key, c.score) for c in scored[1:] if c.hypothesis.key != best]
    fitted = {c.hypothesis.key for c in scored}
    others += [(c.hypothesis.key, c.score) for c in candidates if c.hypothesis.key not in fitted]
    return sorted(others, key=lambda row: -row[1])
