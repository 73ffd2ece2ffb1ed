"""Terms that compete with the library: free spectral lines in time, travel and roll angle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA

SPECTRA = CRITERIA.spectra


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpectralLines:
    """What a free spectral line explains at every frequency: a spectrum of the residual.

    Attributes
    ----------
    axis : ``time`` (Hz), ``travel`` (1/m) or ``angle`` (order).
    roll : body whose angle it is, empty else.
    frequency : cycles per unit (bins,).
    chi2_reduction : by how much chi-square falls per bin; itself chi-square distributed, with
        ``degrees`` degrees of freedom, when there is no line.
    """

    axis: str
    roll: str
    frequency: Array
    chi2_reduction: Array
    degrees: int

    @property
    def extent(self) -> float:
        """How long the record is, in s, m or turns, as the axis has it."""
        return 0.5 / float(self.frequency[1] - self.frequency[0])

    @property
    def peak(self) -> tuple[float, float]:
        """Coordinate and chi-square reduction of the strongest line."""
        return self.peak_from(0.0)

    def peak_from(self, lowest: float) -> tuple[float, float]:
        """Coordinate and chi-square reduction of the strongest line from ``lowest`` on."""
        within = np.where(self.frequency >= lowest, self.chi2_reduction, -np.inf)
        at = int(np.argmax(within))
        return float(self.frequency[at]), float(within[at])


def speed_weights(speed_m_s: Array, count: int = 3) -> Array:
    """Return orthonormal polynomials of speed (count, samples): a line may grow with speed.

    A constant speed leaves one of them.
    """
    spread = float(np.std(speed_m_s))
    size = speed_m_s.size
    if spread < SPECTRA.least_speed_spread * float(np.mean(np.abs(speed_m_s))) or count == 1:
        return np.ones((1, size))
    unit = (speed_m_s - speed_m_s.mean()) / spread
    basis, _ = np.linalg.qr(np.vander(unit, count, increasing=True))
    weights: Array = (basis * np.sqrt(size)).T
    return weights


def spectral_lines(
    whitened: Array,
    position: Array,
    weights: Array,
    *,
    axis: str,
    roll: str = "",
    highest: float,
    lowest: float,
) -> SpectralLines:
    """Return the chi-square reduction of a line over ``position`` (samples,): s, m or turns.

    Its size is free in every channel.

    Equation: D(k) = 2/N sum_channels sum_weights |sum_n w_n x_n exp(-2 pi j k u_n)|^2, by binning
    the samples on a grid of u, ``cells_per_cycle`` of ``highest``, and one FFT per row (up to
    5 % of D is lost at ``highest``).
    k: frequency, n: sample, w: ``weights``, x: ``whitened``, u: ``position``.
    """
    along = position - position[0]
    extent = float(along[-1])
    wanted = max(SPECTRA.fewest_cells, 2.0 * SPECTRA.cells_per_cycle * highest * extent)
    cells = 1 << int(np.ceil(np.log2(wanted)))
    # pad to twice the extent: bins at half the resolution
    step = 2.0 * extent / cells
    at = np.clip((along / step + 0.5).astype(np.int64), 0, cells - 1)
    chi2_reduction = np.zeros(cells // 2 + 1)
    samples = whitened.shape[1]
    for row in whitened:
        for weight in weights:
            spectrum = np.fft.rfft(np.bincount(at, row * weight, cells))
            chi2_reduction += 2.0 / samples * np.abs(spectrum) ** 2
    frequency = np.arange(chi2_reduction.size) / (2.0 * extent)
    keep = (frequency >= lowest) & (frequency <= highest)
    return SpectralLines(
        axis=axis,
        roll=roll,
        frequency=frequency[keep],
        chi2_reduction=chi2_reduction[keep],
        degrees=2 * whitened.shape[0] * weights.shape[0],
    )
