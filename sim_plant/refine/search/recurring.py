"""Something that comes again and again: how much is left repeats along time, travel or an angle.

What stands still, bursts or knocks at a rhythm need not leave the same each time, so it has no
spectral line of its own, or a comb of them. How large it is repeats all the same.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import median_filter

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.noise.innovations import filter_taps
from sim_plant.refine.spectra.coordinates import RecordAxes, spectra
from sim_plant.refine.spectra.spectral_lines import SpectralLines

RECURRING = CRITERIA.search.recurring


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Recurrence:
    """A rhythm in how much is left.

    Attributes
    ----------
    axis, roll : as of a spectrum. frequency : times per unit of the axis.
    strength : mean power of its harmonics over the power beside them.
    """

    axis: str
    roll: str
    frequency: float
    strength: float


def recurrences(axes: RecordAxes, white: Array) -> list[Recurrence]:
    """Return the rhythm of innovations (channels, judged samples) along each axis, best first.

    Only of axes that have one, and that the record does not tell from the best.
    """
    size = sizes_of(white)
    steady = replace(axes, speed_m_s=np.full_like(axes.speed_m_s, np.max(np.abs(axes.speed_m_s))))
    fastest_Hz = 0.5 / (filter_taps(axes.sample_time_s) * axes.sample_time_s)
    found = []
    for spectrum in spectra(steady, size):  # one size at every speed
        unit_s = (axes.time_s[-1] - axes.time_s[0]) / spectrum.extent
        comb = comb_of(spectrum, fastest_Hz * unit_s)
        if comb is not None:
            found.append(
                Recurrence(
                    axis=spectrum.axis, roll=spectrum.roll, frequency=comb[0], strength=comb[1]
                )
            )
    most = max((r.strength for r in found), default=0.0)
    alike = [r for r in found if r.strength > RECURRING.alike_share * most]
    return sorted(alike, key=lambda r: -r.strength)


def sizes_of(white: Array) -> Array:
    """Return how large innovations (channels, samples) are, no more than events count them.

    About their mean, in standard deviations of each channel.
    """
    size = np.minimum(np.abs(white), CRITERIA.search.events.sample_power**0.5)
    size -= size.mean(axis=1, keepdims=True)
    spread: Array = size.std(axis=1, keepdims=True)
    scaled: Array = size / np.where(spread > 0.0, spread, 1.0)
    return scaled


def strongest_channel(white: Array, time_s: Array, period_s: float) -> int:
    """Return the channel in which a rhythm is strongest: by the power of all its harmonics."""
    n = np.arange(1, RECURRING.harmonics + 1)
    waves = np.exp(-2j * np.pi * np.outer(n / period_s, time_s))
    power = np.abs(sizes_of(white) @ waves.T) ** 2
    return int(np.argmax(power.sum(axis=1)))


def comb_of(spectrum: SpectralLines, highest: float) -> tuple[float, float] | None:
    """Return the fundamental of a comb of spectral lines and its strength, or None.

    The lowest that is strong: its multiples have combs too. Each harmonic is weighed against the
    spectrum beside it, for what is left changes slowly with speed and tension.
    Equation: S(n f) / median of S around n f, n = 1 .. ``harmonics``; ``harmonics_shown`` of them,
    the first among them, have to be above ``strength``, for at half of f the first is none; their
    mean is largest at the fundamental  [own].
    """
    bin_width = float(spectrum.frequency[1] - spectrum.frequency[0])
    first = round(float(spectrum.frequency[0]) / bin_width)
    beside = median_filter(spectrum.chi2_reduction, size=RECURRING.beside_bins, mode="nearest")
    ratio = np.concatenate([np.zeros(first), spectrum.chi2_reduction / np.maximum(beside, 1e-12)])
    n = np.arange(1, RECURRING.harmonics + 1)
    lowest = CRITERIA.search.unexplained.spectral_line_cycles / spectrum.extent
    highest = min(highest, (ratio.size - 1) * bin_width / n[-1])
    tried = np.arange(lowest, highest, bin_width / (2 * n[-1]))
    at = np.rint(tried[:, np.newaxis] * n / bin_width).astype(np.int64)
    powers = ratio[at] if tried.size else np.zeros((0, n.size))
    shown = np.sort(powers, axis=1)[:, -RECURRING.harmonics_shown]
    strong = np.minimum(shown, powers[:, 0]) > RECURRING.strength
    if not strong.any():
        return None
    begun = tried[int(np.argmax(strong))]
    near = strong & (tried < begun + RECURRING.skirt_bins * bin_width)
    best = int(np.argmax(np.where(near, powers.mean(axis=1), 0.0)))
    return float(tried[best]), float(powers[best].mean())
