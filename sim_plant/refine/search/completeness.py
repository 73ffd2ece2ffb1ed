"""Whether an effect explains what a free spectral line at its own coordinate would."""

from __future__ import annotations

from collections.abc import Sequence

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.search.candidate import sure_fall
from sim_plant.refine.search.unexplained import strongest_peak
from sim_plant.refine.spectra.coordinates import (
    RecordAxes,
    is_periodic,
    periodic_chi2_reduction,
    spectra,
)
from sim_plant.refine.spectra.spectral_lines import SpectralLines

COMPLETENESS = CRITERIA.search.completeness
NOISE_PEAK = CRITERIA.search.unexplained.periodic
"""A free spectral line of less chi-square may be noise."""

Spectra = tuple[tuple[SpectralLines, ...], ...]
"""Spectra of free spectral lines, per record."""


def sure_excess(objective: Objective) -> float:
    """Return the cost by which what is left surely exceeds noise."""
    return COMPLETENESS.sure_sd * objective.cost_standard_deviation


def remaining_spectra(
    objective: Objective, fit: Fit, record_axes: Sequence[RecordAxes]
) -> Spectra:
    """Return the spectra of free spectral lines in a fit's residual, per record.

    Coarse words are left out: their steps pass at a rate of their own, a spectral line that no
    effect causes.
    """
    rows = zip(record_axes, objective.split(fit.residual), objective.whitening.noise, strict=True)
    return tuple(tuple(spectra(axes, part[noise.analogue])) for axes, part, noise in rows)


def explains_own_spectral_lines(
    objective: Objective, base: Fit, before: Spectra, record_axes: Sequence[RecordAxes], fit: Fit
) -> bool:
    """Return whether the effects that ``fit`` adds to ``base`` explain their own spectral lines.

    An effect that is not periodic must explain what the strongest free spectral line would, and a
    fair share of all that is left: the largest of up to three true ones does, an imitation of
    something else seldom. ``before`` are the spectra of what ``base`` leaves.
    """
    chi2_reduction = base.cost - fit.cost
    fresh = fit.hypotheses[len(base.hypotheses) :]
    periodic = [
        h for h in fresh if periodic_chi2_reduction(h, record_axes[0], before[0]) is not None
    ]
    if not periodic:
        sure = objective.excess(base.cost, base.residual) - sure_excess(objective)
        peak = strongest_peak(before)[2] - NOISE_PEAK
        needed = max(COMPLETENESS.explained_share * peak, COMPLETENESS.fair_share * sure)
        return sure_fall(objective, base, fit) > needed
    left = remaining_spectra(objective, fit, record_axes)
    for h in periodic:
        peak = _strongest_chi2_reduction(h, record_axes, before)
        rest = _strongest_chi2_reduction(h, record_axes, left)
        partly = (
            chi2_reduction < COMPLETENESS.explained_share * (peak - NOISE_PEAK)
            or rest > COMPLETENESS.left_share * peak
        )
        if partly and rest > NOISE_PEAK:
            return False
    return True


def left_at_own_line(
    objective: Objective, fit: Fit, record_axes: Sequence[RecordAxes], h: Hypothesis
) -> float:
    """Return how much of the spectral line of one of its effects a fit leaves (chi2).

    Less what noise leaves in the mean; 0 of an effect without a line, or where no more is left.
    """
    if not record_axes or not is_periodic(h):
        return 0.0
    left = remaining_spectra(objective, fit, record_axes)
    noise = max(line.degrees for record in left for line in record)
    return max(0.0, _strongest_chi2_reduction(h, record_axes, left) - noise)


def leaves_much(objective: Objective, base: Fit, fit: Fit) -> bool:
    """Return whether ``fit`` leaves more than two true effects at one spectral line would.

    Two such effects have four free numbers at one coordinate: they explain any line there in part.
    """
    left = objective.excess(fit.cost, fit.residual) - sure_excess(objective)
    return left > COMPLETENESS.twins_left_share * (base.cost - fit.cost)


def _strongest_chi2_reduction(
    h: Hypothesis, record_axes: Sequence[RecordAxes], spectra: Spectra
) -> float:
    rows = zip(record_axes, spectra, strict=True)
    return max(periodic_chi2_reduction(h, axes, record) or 0.0 for axes, record in rows)
