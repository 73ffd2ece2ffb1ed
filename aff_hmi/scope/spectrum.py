"""What repeats in a window of ticks: its strongest frequencies, of any cause."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

MOST_LINES = 8
LEAST_TICKS = 64
LEAST_RATIO = 4.0  # of a line to the median of all: noise alone is above it once in 65 000 lines
MOST_MISSING = 0.02
_BESIDE = 3  # lines of a Hann window on each side of a tone


def lines_of(
    time_s: NDArray[np.float64], values: NDArray[np.floating], cycle_s: float
) -> list[tuple[float, float]]:
    """Return (frequency in Hz, amplitude in the unit of the values), the largest first.

    Mean and slope are taken out, a Hann window keeps tones apart that are three lines away; where
    a tone lies between two lines, and how large it is, follows from the ratio of the two. Ticks
    that are missing are filled in where they are few, else there is no spectrum.
    """
    known = np.isfinite(values)
    at, signal = time_s[known], np.asarray(values, dtype=np.float64)[known]
    if len(at) < LEAST_TICKS or cycle_s <= 0.0:
        return []
    count = round((at[-1] - at[0]) / cycle_s) + 1
    if len(at) < (1.0 - MOST_MISSING) * count:
        return []
    even_s = at[0] + cycle_s * np.arange(count)
    even = np.interp(even_s, at, signal)
    least = 1e-9 * float(np.abs(even).max())  # below it is how numbers are rounded
    even -= np.polynomial.Polynomial.fit(even_s, even, 1)(even_s)
    window = np.hanning(count)
    size = 2.0 / window.sum() * np.abs(np.fft.rfft(even * window))
    floor = float(np.median(size[1:]))
    found: list[tuple[float, float]] = []
    left = size.copy()
    left[:_BESIDE] = left[-1] = 0.0  # the rest of the slope
    while len(found) < MOST_LINES:
        n = int(np.argmax(left))
        if not left[n] > max(LEAST_RATIO * floor, least):
            break
        if size[n] >= max(size[n - 1], size[n + 1]):
            side = 1 if size[n + 1] > size[n - 1] else -1
            ratio = size[n + side] / size[n]
            shift = max(0.0, (2.0 * ratio - 1.0) / (ratio + 1.0))  # exact of a Hann window's tone
            top = float(size[n] * (1.0 - shift**2) / np.sinc(shift))
            found.append(((n + side * shift) / (count * cycle_s), top))
        left[max(0, n - _BESIDE) : n + _BESIDE + 1] = 0.0
    return found
