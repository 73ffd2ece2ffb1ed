"""Probe tones: where they stand, and the wave of low peak that plays them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
import numpy.typing as npt

PERIOD_S = 10.0
"""Every tone is a multiple of the frequency 1/PERIOD_S, so the wave repeats, and is short enough
to seek phases that keep its peak low within some ticks. With n actuators probed at once each has
a wave of tones of its own, and all take n times as long to repeat."""
MAX_SHIFTS = 400
"""Places that are tried for a tone: 20 Hz to either side at n = 1, wider than any band."""
LOUDEST = 1.5
ROUNDS = 300
"""Rounds of clipping, one a tick: twice as many lower the peak of 40 tones by 3 to 5 % more."""
CLIP_FIRST_HALF, CLIP_SECOND_HALF = 0.85, 0.93
"""Share of the peak that a round leaves: far at first, then finely."""
OVERSAMPLED = 4
"""Samples per period of the highest tone, at least, where phases are sought."""
NEARLY = 1.0 - 1e-9
"""Rounding of a distance is no reason to leave a place."""


def step_Hz(cycle_s: float, waves: int = 1) -> float:
    """Return the frequency that every tone is a multiple of: once in a whole number of cycles.

    Parameters
    ----------
    waves : how many are played at once, one per probed actuator; each has tones of its own.
    """
    return 1.0 / (_period(cycle_s, waves) * cycle_s)


def _period(cycle_s: float, waves: int) -> int:
    """Return after how many samples a wave repeats."""
    return max(1, round(waves * PERIOD_S / cycle_s))


def place_tones(
    wanted_Hz: Iterable[float], taken_Hz: Sequence[float], spacing_Hz: float, step_Hz: float
) -> list[float]:
    """Return the wanted frequencies, each moved to the nearest free multiple of ``step_Hz``.

    Free is what keeps ``spacing_Hz`` from every tone and every frequency in ``taken_Hz``.
    Multiples below ``spacing_Hz`` are not used; what finds no place is left out.
    """
    occupied = list(taken_Hz)
    placed: list[float] = []
    apart = NEARLY * spacing_Hz
    for wanted in wanted_Hz:
        nearest = round(wanted / step_Hz)
        for k in range(MAX_SHIFTS):
            shift = (k + 1) // 2
            f = (nearest + (shift if k % 2 else -shift)) * step_Hz
            if f >= max(apart, NEARLY * step_Hz) and all(abs(f - o) >= apart for o in occupied):
                occupied.append(f)
                placed.append(f)
                break
    return placed


def log_grid(low_Hz: float, high_Hz: float, count: int) -> list[float]:
    """Return ``count`` frequencies from low to high, evenly spaced in octaves."""
    if count < 2 or not 0.0 < low_Hz < high_Hz:
        return []
    ratio = (high_Hz / low_Hz) ** (1.0 / (count - 1))
    return [low_Hz * ratio**k for k in range(count)]


def loudness(frequency_Hz: float, louder_from_Hz: float) -> float:
    """Return a tone's amplitude beside the others: 1, growing with frequency to ``LOUDEST``.

    The faster a correction, the less a line answers; equal tones leave the fast ones in noise.
    """
    return min(max(frequency_Hz / louder_from_Hz, 1.0), LOUDEST)


class Waveform:
    """A sum of tones with phases that keep its peak low, faded in and out, scaled to a peak.

    What a record tells grows with the power of the tones, what the line feels is their peak. By
    Schroeder's quadratic phases [Schroeder 1970] the peak of 40 tones that stand evenly in octaves
    is 4 to 4.6 times their rms. Clipping the wave and taking the phases of what is left, again
    and again [van der Ouderaa et al. 1988], brings it to 2: four times the power with the same
    peak.
    ``fill`` does one such round, so that no tick is long; no sample exceeds ``peak``.

    Parameters
    ----------
    samples : of the whole excitation.
    waves : how many are played at once, see ``step_Hz``.
    """

    def __init__(self, samples: int, cycle_s: float, waves: int = 1) -> None:
        self._samples = samples
        self._cycle_s = cycle_s
        self._period = _period(cycle_s, waves)
        self._fade_s = 1.0
        self._at: npt.NDArray[np.int64] = np.zeros(0, dtype=np.int64)
        self._sizes = np.zeros(0)
        self._phases = np.zeros(0)
        self._sought, self._lowest = self._phases, math.inf
        self._search_samples, self._rounds = 1, 0
        self._table: list[float] = []
        self._largest = self._steepest = 0.0

    def plan(self, tones_Hz: Sequence[float], fade_s: float, louder_from_Hz: float) -> None:
        """Choose the tones, multiples of ``step_Hz``; what was filled before is void."""
        ordered = sorted(tones_Hz)
        count = np.arange(len(ordered))
        self._at = np.rint(np.array(ordered) * self._period * self._cycle_s).astype(np.int64)
        self._sizes = np.array([loudness(f, louder_from_Hz) for f in ordered])
        self._sought = -math.pi * count * (count + 1) / max(1, count.size)
        self._phases, self._lowest = self._sought, math.inf
        highest = int(self._at.max(initial=1))
        self._search_samples = 2 ** math.ceil(math.log2(OVERSAMPLED * highest))
        self._fade_s = fade_s
        self._rounds = 0
        self._table = []
        self._largest = self._steepest = 0.0

    def fill(self) -> bool:
        """Look once more for phases of a lower peak; True when the wave is ready."""
        if self._rounds < ROUNDS:
            self._round(CLIP_SECOND_HALF if 2 * self._rounds >= ROUNDS else CLIP_FIRST_HALF)
            self._rounds += 1
        elif not self._table:
            wave = self._wave(self._phases, self._period)
            self._largest = float(np.abs(wave).max())
            self._steepest = float(np.abs(np.diff(wave, append=wave[0])).max()) / self._cycle_s
            self._table = wave.tolist()
        return bool(self._table)

    def _round(self, kept: float) -> None:
        wave = self._wave(self._sought, self._search_samples)
        peak = float(np.abs(wave).max())
        if peak < self._lowest:
            self._phases, self._lowest = self._sought, peak
        clipped = np.clip(wave, -kept * peak, kept * peak)
        self._sought = np.angle(np.fft.rfft(clipped)[self._at])

    def _wave(self, phases: npt.NDArray[np.float64], samples: int) -> npt.NDArray[np.float64]:
        """Return one period of the sum."""
        lines = np.zeros(samples // 2 + 1, dtype=np.complex128)
        lines[self._at] = 0.5 * samples * self._sizes * np.exp(1j * phases)
        return np.asarray(np.fft.irfft(lines, samples))

    def amplitude(self, peak: float) -> float:
        """Return the amplitude of a tone of loudness 1 when no sample may exceed ``peak``."""
        return peak / self._largest if self._largest > 0.0 else 0.0

    def sample(self, k: int, peak: float) -> float:
        """Return sample ``k`` of the excitation; 0 outside of it, and until ``fill`` is done."""
        if not 0 <= k < self._samples or not self._table:
            return 0.0
        edge = min(k, self._samples - k) * self._cycle_s / self._fade_s
        faded = 0.5 - 0.5 * math.cos(math.pi * edge) if edge < 1.0 else 1.0
        return self._table[k % self._period] * faded * self.amplitude(peak)

    def turn(self, k: int, peak: float) -> float:
        """Return sample ``k`` of the wave without its fades."""
        return self._table[k % self._period] * self.amplitude(peak)

    def steepness(self, peak: float) -> float:
        """Return a bound of the rate of change of ``turn``."""
        return self.amplitude(peak) * self._steepest

    @property
    def period(self) -> int:
        """Samples after which the wave repeats."""
        return self._period

    @property
    def at(self) -> npt.NDArray[np.int64]:
        """How often each tone turns in one period."""
        return self._at

    @property
    def phasors(self) -> npt.NDArray[np.complex128]:
        """Every tone of a wave of peak 1: amplitude, and phase at the beginning of a period."""
        return np.asarray(self.amplitude(1.0) * self._sizes * np.exp(1j * self._phases))

    def slew(self, peak: float) -> float:
        """Return a bound of the waveform's rate of change."""
        return self.steepness(peak) + peak * 0.5 * math.pi / self._fade_s

    @property
    def tones(self) -> tuple[tuple[float, float, float], ...]:
        """Angular frequency (rad/s), phase (rad) and loudness of every tone."""
        turn = math.tau / (self._period * self._cycle_s)
        return tuple(
            (turn * int(at), float(phase), float(size))
            for at, phase, size in zip(self._at, self._phases, self._sizes, strict=True)
        )
