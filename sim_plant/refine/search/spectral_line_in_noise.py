"""Whether noise alone may look like a spectral line: drives' noise moves several channels at once.

The chi-square of a free spectral line is a sum over channels. Noise that reaches several together,
as that of a drive does below some hertz, counts several times in that sum: the sum is distributed
as a chi-square of fewer degrees of freedom times a factor.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import chdtrc

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.spectra.coordinates import RecordAxes, spectra
from sim_plant.refine.spectra.spectral_lines import SpectralLines

UNEXPLAINED = CRITERIA.search.unexplained


def may_be_noise(
    objective: Objective, record_axes: Sequence[RecordAxes], spectrum: SpectralLines, at: float
) -> bool:
    """Return whether noise reaches the line at ``at`` more often than theory has ``periodic``.

    That theory sums over independent channels. Here the seeded runs of the declaration give the
    distribution of the sum, within an octave around the spectral line.
    Equation: D = c X, X of n degrees of freedom, c = v / 2m, n = 2 m^2 / v with m and v the mean
    and variance of D in noise  [Satterthwaite 1946].
    """
    seen = np.concatenate(
        [_around(r, spectrum, at) for r in noise_spectra(objective, record_axes)]
    )
    if seen.size < UNEXPLAINED.fewest_bins or not np.var(seen) > 0.0:
        return False
    scale = float(np.var(seen) / (2.0 * np.mean(seen)))
    degrees = float(np.mean(seen)) / scale
    value = float(np.interp(at, spectrum.frequency, spectrum.chi2_reduction)) / scale
    alone = chdtrc(UNEXPLAINED.periodic_degrees, UNEXPLAINED.periodic)
    return bool(chdtrc(degrees, max(value, 0.0)) > alone)


def noise_spectra(
    objective: Objective, record_axes: Sequence[RecordAxes]
) -> list[Sequence[SpectralLines]]:
    """Return the spectra of free spectral lines in every seeded run of noise, of all records."""
    rows = zip(
        record_axes, objective.whitening.noise, objective.whitening.realisations, strict=True
    )
    return [
        spectra(axes, noise.whiten(run)[noise.analogue])
        for axes, noise, runs in rows
        for run in runs
    ]


def _around(spectra: Sequence[SpectralLines], spectrum: SpectralLines, at: float) -> Array:
    """Return the values of the same spectrum within half an octave to either side."""
    same = [s for s in spectra if (s.axis, s.roll) == (spectrum.axis, spectrum.roll)]
    root = np.sqrt(2.0)
    parts = [
        s.chi2_reduction[(s.frequency >= at / root) & (s.frequency <= at * root)] for s in same
    ]
    return np.concatenate(parts) if parts else np.zeros(0)
