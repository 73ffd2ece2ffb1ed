"""First look: what every hypothesis would explain, by one linear step."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.fit.projection import Gain
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.spectra.coordinates import Travel, line_support
from sim_plant.refine.spectra.line_spectrum import LineSpectrum

LINE_WORTH_A_TRY = 80.0
"""Free-line drop over its degrees of freedom below which no order-locked effect is simulated."""
FEW_IDLERS = 8
MANY = 2
"""An effect of more pairs of numbers than this is a profile: it has the orders that pay."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Candidate:
    """One hypothesis with its linear gain.

    Attributes
    ----------
    score : drop less q ln(N/4), the price of q numbers.
    start : numbers to begin the fit with.
    """

    hypothesis: Hypothesis
    gain: Gain
    score: float
    start: tuple[float, ...]

    def trimmed(self) -> tuple[Hypothesis, tuple[float, ...]]:
        """Return the hypothesis without the orders that did not pay their price, and its start."""
        h = self.hypothesis
        kept = [k for k, (s, a) in enumerate(zip(self.start, h.absent, strict=True)) if s != a]
        if not kept or len(kept) == len(h.names):
            return h, self.start

        def pick(row: tuple[float, ...]) -> tuple[float, ...]:
            return tuple(row[k] for k in kept)

        fewer = replace(
            h,
            names=tuple(h.names[k] for k in kept),
            strengths=len(kept),
            start=pick(h.start),
            absent=pick(h.absent),
            low=pick(h.low),
            high=pick(h.high),
            linear=tuple(h.linear[k] for k in kept),
        )
        return fewer, pick(self.start)


def bic_penalty(objective: Objective, numbers: int) -> float:
    """Return the cost drop that this many free numbers must pay [BIC]."""
    return numbers * math.log(objective.rows / 4.0)


def with_line_support(
    hypotheses: Sequence[Hypothesis],
    travels: Sequence[Travel],
    spectra: Sequence[Sequence[LineSpectrum]],
) -> tuple[list[Hypothesis], list[Hypothesis]]:
    """Return hypotheses whose line is in some record, and those that are no lines."""
    lines, others = [], []
    strongest_line = max(s.peak[1] for record in spectra for s in record)
    degrees = min(s.degrees for record in spectra for s in record)
    for h in hypotheses:
        # a profile spreads what it does over many orders: each of them is small
        alone = LINE_WORTH_A_TRY * (0.5 if len(h.effect.quadratures) > MANY else 1.0)
        least = max(alone + degrees, 0.01 * strongest_line)
        support = [line_support(h, t, s) for t, s in zip(travels, spectra, strict=True)]
        seen = [value for value in support if value is not None]
        if not seen:
            others.append(h)
        elif max(seen) >= (0.3 * strongest_line if h.effect.name == "roll_bounce" else least):
            lines.append(h)
    return lines, others


def screen(
    objective: Objective, fit: Fit, hypotheses: Sequence[Hypothesis], residual: Array, base: Fit
) -> list[Candidate]:
    """Return all hypotheses, best score first; sensitivities are taken at ``base``."""
    columns = sensitivities(objective, base, hypotheses)
    candidate = [
        linear_candidate(objective, h, residual, column)
        for h, column in zip(hypotheses, columns, strict=True)
    ]
    return sorted(candidate, key=lambda s: -s.score)


def sensitivities(
    objective: Objective, base: Fit, hypotheses: Sequence[Hypothesis]
) -> list[Array]:
    """Return, per hypothesis, what its probes change at ``base`` (rows, numbers), whitened."""
    case = base.case
    probes = [added for h in hypotheses for added in h.probes()]
    cases = [replace(case, effects=(*case.effects, added)) for added in probes]
    start, *runs = objective.pool.run([case, *cases])
    rest = iter(runs)
    return [
        np.stack([objective.column(next(rest), start, 1.0) for _ in h.probes()], axis=1)
        for h in hypotheses
    ]


def every_third_idler(
    hypotheses: Sequence[Hypothesis], rollers: Sequence[str]
) -> list[Hypothesis]:
    """Return the hypotheses with every third idler only: response changes slowly along the web.

    Not so on a short line, and not for what sits in a load cell: each reading is its own.
    """
    idlers = [name for name in rollers if name]
    if len(idlers) <= FEW_IDLERS:
        return list(hypotheses)
    left_out = {name for k, name in enumerate(idlers) if k % 3 != 1}
    return [h for h in hypotheses if h.effect.place == "cell" or h.location not in left_out]


def neighbours(
    hypotheses: Sequence[Hypothesis], ranked: Sequence[Candidate], rollers: Sequence[str]
) -> list[Hypothesis]:
    """Return hypotheses not ranked yet within two idlers of the best of their effect."""
    idlers = [name for name in rollers if name]
    near: set[tuple[str, str]] = set()
    for name in {s.hypothesis.effect.name for s in ranked}:
        best = [s for s in ranked if s.hypothesis.effect.name == name]
        for s in best[:2]:
            if (
                s.score > 0.0
                and s.score > 0.3 * ranked[0].score
                and s.hypothesis.location in idlers
            ):
                at = idlers.index(s.hypothesis.location)
                near |= {(name, other) for other in idlers[max(0, at - 2) : at + 3]}
    done = {s.hypothesis.key for s in ranked}
    return [h for h in hypotheses if h.key in near and h.key not in done]


def paying_orders(
    objective: Objective, h: Hypothesis, residual: Array, columns: Array
) -> list[int]:
    """Return the columns of a profile whose orders pay for themselves, one order at the least.

    The order that is missed least is left out until each would be missed by more than its price:
    twelve numbers for a roll with one bump would lose to any effect of two.
    """
    cut = objective.projector.project(columns)
    inner, against = columns.T @ cut, cut.T @ residual
    at = {name: k for k, name in enumerate(h.names)}
    pairs = [(at[p.cos], at[p.sin]) for p in h.effect.quadratures if p.cos in at and p.sin in at]

    def chi2_reduction(some: list[tuple[int, int]]) -> float:
        use = [k for pair in some for k in pair]
        part = np.ix_(use, use)
        return float(against[use] @ np.linalg.lstsq(inner[part], against[use], rcond=1e-9)[0])

    while len(pairs) > 1:
        left = [chi2_reduction([p for p in pairs if p is not out]) for out in pairs]
        best = int(np.argmax(left))
        if chi2_reduction(pairs) - left[best] > bic_penalty(objective, 2):
            break
        del pairs[best]
    return [k for pair in pairs for k in pair]


def linear_candidate(
    objective: Objective, h: Hypothesis, residual: Array, columns: Array
) -> Candidate:
    """Return the gain of one hypothesis; columns are whole probes, so 1 is the typical size."""
    if not np.isfinite(columns).all():
        nothing = Gain(
            chi2_reduction=0.0, values=np.zeros(1), covariance=np.zeros((1, 1)), seen=0.0
        )
        return Candidate(hypothesis=h, gain=nothing, score=-np.inf, start=h.start)
    use = list(range(columns.shape[1]))
    if len(h.effect.quadratures) > MANY:
        use = paying_orders(objective, h, residual, columns)
    gain = objective.projector.gain(residual, columns[:, use])
    # a strength that cannot go backwards is left out where it would
    while use:
        wrong = [k for k, at in enumerate(use) if not h.linear[at] and gain.values[k] <= 0.0]
        if not wrong:
            break
        use = [at for k, at in enumerate(use) if k not in wrong]
        if use:
            gain = objective.projector.gain(residual, columns[:, use])
    if not use:
        gain = replace(gain, chi2_reduction=0.0)
    start = list(h.absent)
    start[h.strengths :] = h.start[h.strengths :]
    for k, at in enumerate(use):
        size = float(gain.values[k])
        if not h.linear[at]:
            size = min(max(size, 0.1), 3.0)
        value = h.absent[at] + size * (h.start[at] - h.absent[at])
        start[at] = min(max(value, h.low[at]), h.high[at])
    return Candidate(
        hypothesis=h,
        gain=gain,
        score=gain.chi2_reduction - bic_penalty(objective, max(1, len(use))),
        start=tuple(start),
    )
