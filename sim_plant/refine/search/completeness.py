"""Whether an effect explains what a free line at its own coordinates would explain."""

from __future__ import annotations

import math
from collections.abc import Sequence

from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.search.unexplained import LINE_THRESHOLD, strongest_line
from sim_plant.refine.spectra.coordinates import Travel, line_support, spectra
from sim_plant.refine.spectra.line_spectrum import LineSpectrum

COMPLETENESS = 0.8
LEFT_OVER = 0.15
FAIR_SHARE = 0.3
SURE = 3.0
"""Standard deviations of a chi-square cost by which what is left surely exceeds noise."""


def cost_standard_deviation(objective: Objective) -> float:
    """Return the cost to which noise alone is known."""
    return SURE * math.sqrt(2.0 * objective.expected_cost)


def remaining_spectra(
    objective: Objective, fit: Fit, travels: Sequence[Travel]
) -> list[list[LineSpectrum]]:
    """Return the free-line spectra of a fit's residual, per record.

    Coarse words are left out: their steps pass at a rate of their own, a line that nothing causes.
    """
    return [
        spectra(travel, part[noise.analogue])
        for travel, part, noise in zip(
            travels, objective.split(fit.residual), objective.noise, strict=True
        )
    ]


def explains_own_lines(
    objective: Objective,
    base: Fit,
    before: Sequence[Sequence[LineSpectrum]],
    travels: Sequence[Travel],
    fit: Fit,
) -> bool:
    """Return whether the effects that ``fit`` adds to ``base`` explain their own lines.

    An effect that is no line must explain what the strongest free line would, and a fair share of
    all that is left: the largest of up to three true ones does, an imitation of something else
    seldom.
    """
    chi2_reduction = base.cost - fit.cost
    fresh = fit.hypotheses[len(base.hypotheses) :]
    locked = [h for h in fresh if line_support(h, travels[0], before[0]) is not None]
    if not locked:
        sure = base.cost - objective.expected_cost - cost_standard_deviation(objective)
        line = strongest_line(before)[2] - LINE_THRESHOLD
        return chi2_reduction > max(COMPLETENESS * line, FAIR_SHARE * sure)
    left = remaining_spectra(objective, fit, travels)
    for h in locked:
        line = max(_support(h, t, s) for t, s in zip(travels, before, strict=True))
        rest = max(_support(h, t, s) for t, s in zip(travels, left, strict=True))
        partly = chi2_reduction < COMPLETENESS * (line - LINE_THRESHOLD) or rest > LEFT_OVER * line
        if partly and rest > LINE_THRESHOLD:
            return False
    return True


def _support(h: Hypothesis, travel: Travel, found: Sequence[LineSpectrum]) -> float:
    return line_support(h, travel, found) or 0.0
