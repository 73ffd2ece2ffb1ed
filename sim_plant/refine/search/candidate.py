"""One effect at one place as a candidate: what it explains, what its numbers cost, its start."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.hypotheses import Hypothesis

Progress = Callable[[str], None]
"""Takes one sentence for the user on what is being done."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Candidate:
    """A hypothesis after its first look, one linear step.

    Attributes
    ----------
    chi2_reduction : fall of the cost; minus infinity where it cannot be simulated.
    penalty : price of its free numbers [BIC].
    start : numbers to begin the fit with.
    """

    hypothesis: Hypothesis
    chi2_reduction: float
    penalty: float
    start: tuple[float, ...]

    @property
    def score(self) -> float:
        """Fall of the cost less the price of the numbers."""
        return self.chi2_reduction - self.penalty

    def trimmed(self) -> tuple[Hypothesis, tuple[float, ...]]:
        """Return the hypothesis without the numbers that were left at absence, and its start.

        The first look leaves there an order that saves less than its penalty.
        """
        h = self.hypothesis
        kept = [k for k, (s, a) in enumerate(zip(self.start, h.absent, strict=True)) if s != a]
        if not kept or len(kept) == len(h.names):
            return h, self.start

        def pick(row: tuple[float, ...]) -> tuple[float, ...]:
            return tuple(row[k] for k in kept)

        fewer = replace(
            h,
            names=tuple(h.names[k] for k in kept),
            strength_count=len(kept),
            start=pick(h.start),
            absent=pick(h.absent),
            low=pick(h.low),
            high=pick(h.high),
            linear=tuple(h.linear[k] for k in kept),
        )
        return fewer, pick(self.start)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FittedCandidate:
    """A fit with one more effect, its last.

    Attributes
    ----------
    fit : all effects, the candidate last.
    chi2_reduction : sure fall of the cost against the fit without it, see ``sure_fall``.
    penalty : price of its free numbers [BIC].
    ceiling : the score is no higher: what is lost when the effect is taken out again.
    chi2_by_records : of an effect that is a change of declared numbers, the chi-square of that
        change by the records alone, without the prior of its tolerance; 0 of any other effect.
    ends_conflict : with the effect declared numbers are together within their tolerances, which
        they are not without it; ``chi2_by_records`` is then without the priors of those that stood
        in for it either.
    beyond_tolerance : the effect is one declared number, and no end of its interval is within the
        tolerance of that.
    """

    fit: Fit
    chi2_reduction: float
    penalty: float
    ceiling: float = math.inf
    chi2_by_records: float = 0.0
    ends_conflict: bool = False
    beyond_tolerance: bool = False

    @property
    def hypothesis(self) -> Hypothesis:
        """The effect that the fit adds."""
        return self.fit.hypotheses[-1]

    @property
    def score(self) -> float:
        """Fall of the cost less the price of the numbers, no higher than the ceiling."""
        return min(self.chi2_reduction - self.penalty, self.ceiling)

    def at_most(self, score: float) -> FittedCandidate:
        """Return the candidate with a score no higher than this."""
        return replace(self, ceiling=score)


def bic_penalty(objective: Objective, numbers: int) -> float:
    """Return the fall of the cost that this many free numbers must pay.

    Equation: q ln(N / 4) of q ``numbers`` and N rows  [BIC].
    """
    return numbers * math.log(objective.rows / 4.0)


def sure_fall(objective: Objective, base: Fit, fit: Fit) -> float:
    """Return by how much ``fit`` costs less than ``base``, as far as that is sure.

    A word whose count is larger than its noise (an angle, a radius) leaves steps in the residual,
    which drift slowly, and anything slow explains some of them: an effect counts where other
    channels, or more of a word than its steps, show it. See ``sure_part``.
    """
    steps = objective.quantisation_chi2
    return sure_part(base.cost - fit.cost, before=steps(base.residual), after=steps(fit.residual))


def sure_part(fall: float, *, before: float, after: float) -> float:
    """Return the sure part of a fall of the cost.

    ``before`` and ``after`` are the parts by quantisation (``Objective.quantisation_chi2``) of the
    residuals that it fell from and to.
    Equation: min of the falls of the cost and of the cost less that part  [own].
    """
    return min(fall, fall - before + after)


def fitted_candidate(objective: Objective, base: Fit, fit: Fit) -> FittedCandidate:
    """Return ``fit``, which has one more effect than ``base``, with what that one is worth."""
    return FittedCandidate(
        fit=fit,
        chi2_reduction=sure_fall(objective, base, fit),
        penalty=bic_penalty(objective, len(fit.hypotheses[-1].names)),
    )
