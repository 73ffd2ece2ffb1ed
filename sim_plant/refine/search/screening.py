"""First look: what every hypothesis would explain, by one linear step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.fit.projection import Inner
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.search.candidate import (
    Candidate,
    FittedCandidate,
    Progress,
    bic_penalty,
    sure_part,
)
from sim_plant.refine.search.like_idlers import LikeIdlers
from sim_plant.refine.spectra.coordinates import RecordAxes, periodic_chi2_reduction
from sim_plant.refine.spectra.spectral_lines import SpectralLines

SCREENING = CRITERIA.search.screening


def by_periodic_chi2(
    hypotheses: Sequence[Hypothesis],
    record_axes: Sequence[RecordAxes],
    spectra: Sequence[Sequence[SpectralLines]],
) -> tuple[list[Hypothesis], list[Hypothesis]]:
    """Return periodic hypotheses whose spectral line a record has, and those not periodic."""
    periodic, others = [], []
    strongest = max(s.peak[1] for record in spectra for s in record)
    degrees = min(s.degrees for record in spectra for s in record)
    for h in hypotheses:
        profile = len(h.effect.quadratures) > SCREENING.profile_pairs
        alone = SCREENING.periodic_chi2_reduction * (
            SCREENING.profile_chi2_share if profile else 1.0
        )
        least = max(alone + degrees, SCREENING.strongest_share * strongest)
        if h.effect.resonant:
            least = SCREENING.resonance_share * strongest
        chi2_reduction = [
            periodic_chi2_reduction(h, t, s) for t, s in zip(record_axes, spectra, strict=True)
        ]
        known = [value for value in chi2_reduction if value is not None]
        if not known:
            others.append(h)
        elif max(known) >= least:
            periodic.append(h)
    return periodic, others


def screen(
    objective: Objective, fit: Fit, hypotheses: Sequence[Hypothesis], progress: Progress
) -> list[Candidate]:
    """Return candidates among ``hypotheses``, best score first, sensitivities taken at ``fit``.

    Of many like idlers every third is tried first, then the neighbours of the best. Effects that
    the fit has already are left out.
    """
    taken = {h.key for h in fit.hypotheses}
    group = [h for h in hypotheses if h.key not in taken]
    if not group:
        return []
    like = LikeIdlers.of(group, objective.pool.twins[0].declaration)
    residual = objective.residual(objective.pool.one(fit.case), fit.shifts)
    progress(f"  {len(group)} hypotheses")
    candidates = _screened(objective, fit, like.thinned(group), residual)
    more = like.neighbours(group, candidates)
    if more:
        candidates += _screened(objective, fit, more, residual)
    return sorted(candidates, key=lambda c: -c.score)


def _screened(
    objective: Objective, fit: Fit, hypotheses: Sequence[Hypothesis], residual: Array
) -> list[Candidate]:
    """Return a first look at every hypothesis, best first."""
    columns = sensitivities(objective, fit, hypotheses)
    inners = objective.projector.inners(residual, columns)
    rows = zip(hypotheses, inners, strict=True)
    looks = [linear_candidate(objective, h, inner) for h, inner in rows]
    return sure_looks(objective, residual, looks, columns)


def sure_looks(
    objective: Objective, residual: Array, looks: Sequence[Candidate], columns: Sequence[Array]
) -> list[Candidate]:
    """Return first looks, best first; the foremost, which may be fitted, by their sure part.

    ``columns`` are those that each of them was made from. See ``candidate.sure_part``.
    """
    left = objective.projector.project(residual)
    quantisation_chi2 = objective.quantisation_chi2(left)
    rows = sorted(zip(looks, columns, strict=True), key=lambda row: -row[0].score)
    if quantisation_chi2 <= 0.0:
        return [c for c, _ in rows]
    top = 2 * SCREENING.shortlist_length
    sure: set[int] = set()
    while unsure := [k for k, (c, _) in enumerate(rows[:top]) if id(c) not in sure]:
        k = unsure[0]
        looked = sure_look(objective, left, quantisation_chi2, *rows[k])
        sure.add(id(looked))
        rows[k] = looked, rows[k][1]
        rows.sort(key=lambda row: -row[0].score)
    return [c for c, _ in rows]


def sure_look(
    objective: Objective, left: Array, quantisation_chi2: float, c: Candidate, columns: Array
) -> Candidate:
    """Return a first look by what it surely explains of ``left``, the projected residual.

    ``quantisation_chi2`` is that of ``left``, ``columns`` are those that the look was made from.
    """
    h = c.hypothesis
    if not np.isfinite(columns).all() or not c.chi2_reduction > 0.0:
        return c
    sizes = np.ones(1)
    if not h.curved:
        first, absent = (
            np.array(h.start[: h.strength_count]),
            np.array(h.absent[: h.strength_count]),
        )
        sizes = (np.array(c.start[: h.strength_count]) - absent) / (first - absent)
    rest = left - objective.projector.project(columns @ sizes)
    sure = sure_part(
        c.chi2_reduction, before=quantisation_chi2, after=objective.quantisation_chi2(rest)
    )
    return replace(c, chi2_reduction=sure)


def sensitivities(objective: Objective, fit: Fit, hypotheses: Sequence[Hypothesis]) -> list[Array]:
    """Return, per hypothesis, what its typical effects change at ``fit`` (rows, numbers).

    Responses are whitened. Effects that are not locked to an order are simulated once a search,
    at the first fit that they are looked at from: for a first look that serves later fits too.
    """
    simulate_responses(objective, fit, hypotheses)
    known = objective.pool.responses
    if not hypotheses:
        return []
    every = objective.whitened_all(
        [change for h in hypotheses for change in known[_response_key(h)]]
    )
    ends = np.cumsum([len(known[_response_key(h)]) for h in hypotheses])
    return list(np.split(every, ends[:-1], axis=1))


def simulate_responses(objective: Objective, fit: Fit, hypotheses: Sequence[Hypothesis]) -> None:
    """Simulate what ``sensitivities`` of these needs and is not known yet, side by side.

    One line alone takes nearly as long as four in lanes.
    """
    known = objective.pool.responses
    fresh = [h for h in hypotheses if h.effect.order_locked or _response_key(h) not in known]
    case = fit.case
    cases = [
        replace(case, effects=(*case.effects, added)) for h in fresh for added in h.start_effects()
    ]
    start, *runs = objective.pool.run([case, *cases], keep=False)
    rest = iter(runs)
    for h in fresh:
        known[_response_key(h)] = [
            [(y - b).astype(np.float32) for y, b in zip(next(rest), start, strict=True)]
            for _ in h.start_effects()
        ]


def responses_of(objective: Objective, h: Hypothesis) -> list[list[Array]]:
    """Return what each typical effect of ``h`` changes per record, see ``sensitivities``."""
    return list(objective.pool.responses[_response_key(h)])


def _response_key(h: Hypothesis) -> tuple[object, ...]:
    """Return what the simulated responses of a hypothesis depend on."""
    return (h.key, h.fixed, h.names, h.start, h.record_index)


def shortlist(candidates: Sequence[Candidate], *, beside_half: bool = False) -> list[Candidate]:
    """Return the best few of distinct effect and place; curved ones get a second chance.

    Of a curved effect each choice of options at a place counts as distinct: at a first size one
    may imitate another. ``beside_half``: looked at from half of a pair, whose numbers have moved
    to imitate the other half. What a linear step explains from there is too little to rank by.
    """
    best = candidates[0].score if candidates else 0.0
    floor = SCREENING.shortlist_floor * CRITERIA.search.acceptance.periodic_score
    kept: list[Candidate] = []
    for c in candidates:
        curved = not all(c.hypothesis.linear) or bool(c.hypothesis.moment_parameter)
        share = SCREENING.shortlist_share_curved if curved else SCREENING.shortlist_share
        share = 0.0 if beside_half else share
        if c.score < max(floor, share * best):
            continue
        same = [k for k in kept if _form(k.hypothesis) == _form(c.hypothesis)]
        effect = [k for k in kept if k.hypothesis.effect.name == c.hypothesis.effect.name]
        if same or len(effect) >= SCREENING.shortlist_places:
            continue
        kept.append(c)
    return kept[: SCREENING.shortlist_length]


def without_failed(
    candidates: Sequence[Candidate], tried: Sequence[Candidate], fitted: Sequence[FittedCandidate]
) -> list[Candidate]:
    """Return first looks without those that were ``tried`` and gave no estimate.

    A first look that no fit bears out is no rival of one that is fitted.
    """
    known = {c.hypothesis.key for c in fitted}
    failed = {c.hypothesis.key for c in tried} - known
    return [c for c in candidates if c.hypothesis.key not in failed]


def _form(h: Hypothesis) -> tuple[object, ...]:
    """Return what a shortlist has once: effect and place, of a curved one with its options."""
    return (h.key, h.fixed) if h.curved else (h.key,)


def linear_candidate(objective: Objective, h: Hypothesis, inner: Inner) -> Candidate:
    """Return a hypothesis with what one linear step explains; a curved one at its typical size.

    ``inner`` are products of responses to typical effects with the residual, so size 1
    is the typical one.
    """
    if not np.isfinite(inner.gram).all():
        return Candidate(hypothesis=h, chi2_reduction=-np.inf, penalty=0.0, start=h.start)
    if h.curved:
        saved = 2.0 * float(inner.against[0]) - float(inner.gram[0, 0])
        price = bic_penalty(objective, h.strength_count)
        return Candidate(hypothesis=h, chi2_reduction=saved, penalty=price, start=h.start)
    use = list(range(inner.against.size))
    if len(h.effect.quadratures) > SCREENING.profile_pairs:
        use = paying_orders(objective, h, inner)
    linear = inner.of(use).fit()
    # a strength that cannot go backwards is left out where it would
    while use:
        wrong = [k for k, at in enumerate(use) if not h.linear[at] and linear.values[k] <= 0.0]
        if not wrong:
            break
        use = [at for k, at in enumerate(use) if k not in wrong]
        if use:
            linear = inner.of(use).fit()
    return Candidate(
        hypothesis=h,
        chi2_reduction=linear.chi2_reduction if use else 0.0,
        penalty=bic_penalty(objective, max(1, len(use))),
        start=_start(h, use, linear.values),
    )


def _start(h: Hypothesis, use: Sequence[int], sizes: Array) -> tuple[float, ...]:
    """Return numbers to begin a fit with: strengths in ``use`` at their linear sizes."""
    start = list(h.absent)
    start[h.strength_count :] = h.start[h.strength_count :]
    smallest, largest = SCREENING.first_size
    for k, at in enumerate(use):
        size = float(sizes[k])
        if not h.linear[at]:
            size = min(max(size, smallest), largest)
        value = h.absent[at] + size * (h.start[at] - h.absent[at])
        start[at] = min(max(value, h.low[at]), h.high[at])
    return tuple(start)


def paying_orders(objective: Objective, h: Hypothesis, inner: Inner) -> list[int]:
    """Return the columns of a profile whose orders pay for themselves, one order at the least.

    The order that is missed least is left out until each would be missed by more than its price:
    twelve numbers for a roll with one bump would lose to any effect of two.
    """
    at = {name: k for k, name in enumerate(h.names)}
    pairs = [(at[p.cos], at[p.sin]) for p in h.effect.quadratures if p.cos in at and p.sin in at]

    def explained(some: list[tuple[int, int]]) -> float:
        use = [k for pair in some for k in pair]
        part = np.ix_(use, use)
        against = inner.against[use]
        return float(against @ np.linalg.lstsq(inner.gram[part], against, rcond=1e-9)[0])

    while len(pairs) > 1:
        left = [explained([p for p in pairs if p is not out]) for out in pairs]
        best = int(np.argmax(left))
        if explained(pairs) - left[best] > bic_penalty(objective, 2):
            break
        del pairs[best]
    return [k for pair in pairs for k in pair]
