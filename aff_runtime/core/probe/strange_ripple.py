"""Ripple of rolls that the site does not know: lines in what a regression leaves."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
PADDED = 8
LOBE_BINS = 2.0  # of a Hann window: half of its main lobe
AROUND_BINS = 30
CLEAR_OF_NOISE = 20.0
"""Over the median of the power around: noise does that once in a million places."""
ROUNDS, MOST = 3, 8
SAMPLES_PER_PERIOD = 8.0
BEYOND_TONES = 1.3
"""Lines are looked for up to the higher of the two; what is above spoils no tone."""
FAINTEST, SPANNED = 1e-6, 1e-10
"""Rounding, over what the signal moves, and of a column that says nothing new."""


def drifting(angle_rad: Floats, drift: Floats) -> list[Floats]:
    """Return the columns of a ripple whose amplitude and phase change evenly."""
    turn = np.cos(angle_rad), np.sin(angle_rad)
    return [*turn, drift * turn[0], drift * turn[1]]


@dataclass(frozen=True, slots=True, kw_only=True)
class RippleLine:
    """One line: where, and its amplitude in what the regression left, in the signal's unit."""

    frequency_Hz: float
    amplitude: float


def strange_lines(
    time_s: Floats, signal: Floats, design: Floats, highest_Hz: float
) -> tuple[RippleLine, ...]:
    """Return the lines that no column of ``design`` explains.

    A line that is found becomes a column, and what is then left is looked at again: a roll that
    does not turn quite evenly leaves some more beside its first line.

    Parameters
    ----------
    time_s, signal : one entry per good sample of an even cycle; samples may be missing.
    design : (samples, columns).
    highest_Hz : of the tones.
    """
    span_s = float(time_s[-1] - time_s[0])
    drift = (time_s - 0.5 * (time_s[0] + time_s[-1])) / span_s
    basis = _basis(design)
    residual = signal - basis @ (basis.T @ signal)
    faint = FAINTEST * float(np.std(signal))
    lines: list[RippleLine] = []
    for _ in range(ROUNDS):
        new = [one for one in _lines(time_s, residual, highest_Hz) if one.amplitude > faint]
        if not new:
            break
        lines += new
        turns = [math.tau * line.frequency_Hz * time_s for line in new]
        more = np.column_stack([column for turn in turns for column in drifting(turn, drift)])
        more = _basis(more - basis @ (basis.T @ more))
        basis = np.column_stack([basis, more])
        residual = residual - more @ (more.T @ residual)
    return tuple(lines)


def _basis(columns: Floats) -> Floats:
    """Return an orthonormal basis of what the columns span; a tenth of the time of a QR."""
    power, directions = np.linalg.eigh(columns.T @ columns)
    kept = power > SPANNED * power[-1]
    return np.asarray(columns @ (directions[:, kept] / np.sqrt(power[kept])))


def _lines(time_s: Floats, residual: Floats, highest_Hz: float) -> list[RippleLine]:
    """Return the lines that stand out of the noise around them, the strongest first.

    A Hann window keeps a line to itself; its place is that of the parabola through the peak of
    the padded spectrum.
    """
    cycle_s = float(np.median(np.diff(time_s)))
    at = np.rint((time_s - time_s[0]) / cycle_s).astype(np.int64)
    even = np.zeros(int(at[-1]) + 1)
    even[at] = residual
    padded = PADDED * even.size
    window = np.hanning(even.size)
    power = np.abs(np.fft.rfft(window * even, padded)) ** 2
    to_Hz = max(BEYOND_TONES * highest_Hz, 1.0 / (SAMPLES_PER_PERIOD * cycle_s))
    power = power[: round(to_Hz * padded * cycle_s)]
    clear = power > CLEAR_OF_NOISE * _around(power)
    lobe = round(LOBE_BINS * PADDED)
    peaks: dict[int, float] = {}
    for k in np.argsort(power[lobe:-1])[::-1] + lobe:
        low, peak, high = power[k - 1 : k + 2]
        if not clear[k] or peak < max(low, high) or any(abs(k - f) < lobe for f in peaks):
            continue
        peaks[int(k)] = k + 0.5 * (low - high) / (low - 2.0 * peak + high)
        if len(peaks) == MOST:
            break
    return [
        RippleLine(
            frequency_Hz=float(place / (padded * cycle_s)),
            amplitude=float(2.0 * math.sqrt(power[k]) / window.sum()),
        )
        for k, place in peaks.items()
    ]


def _around(power: Floats) -> Floats:
    """Return the median of the power ``AROUND_BINS`` to both sides, per place."""
    bins = np.pad(power[::PADDED], AROUND_BINS, mode="symmetric")
    windows = np.lib.stride_tricks.sliding_window_view(bins, 2 * AROUND_BINS + 1)
    return np.asarray(np.repeat(np.median(windows, axis=1), PADDED)[: power.size])
