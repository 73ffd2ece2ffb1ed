"""Probe tones: where they stand, their phases, and the table of samples that plays them."""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterable, Sequence

MAX_SHIFTS = 400
LOUDEST = 3.0


def spread(
    wanted_Hz: Iterable[float], taken_Hz: Sequence[float], spacing_Hz: float
) -> list[float]:
    """Return the wanted frequencies, each shifted least so that all keep ``spacing_Hz``.

    The distance holds between tones and from every frequency in ``taken_Hz``. Frequencies below
    ``spacing_Hz`` and those that find no place are left out.
    """
    occupied = list(taken_Hz)
    placed: list[float] = []
    for wanted in wanted_Hz:
        for k in range(MAX_SHIFTS):
            shift = 0.25 * spacing_Hz * ((k + 1) // 2)
            f = wanted + (shift if k % 2 else -shift)
            if f >= spacing_Hz and all(abs(f - other) >= spacing_Hz for other in occupied):
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
    """Return a tone's amplitude beside the others: 1, growing with frequency from there to 3.

    The faster a correction, the less a line answers; equal tones leave the fast ones in noise.
    """
    return min(max(frequency_Hz / louder_from_Hz, 1.0), LOUDEST)


class Waveform:
    """A sum of tones with Schroeder phases, faded in and out, scaled to a peak.

    The table is filled piece by piece (``fill``), so that no tick is long; the greatest sample
    then sets the amplitude, so that no sample exceeds ``peak`` and most of it is used.
    """

    def __init__(self, samples: int, cycle_s: float) -> None:
        self._table = array("d", bytes(8 * samples))
        self._cycle_s = cycle_s
        self._filled = 0
        self._largest = 0.0
        self._fade_s = 1.0
        self._tones: tuple[tuple[float, float, float], ...] = ()

    def plan(self, tones_Hz: Sequence[float], fade_s: float, louder_from_Hz: float) -> None:
        """Choose the tones; what was filled before is void."""
        count = max(1, len(tones_Hz))
        ordered = sorted(tones_Hz)
        self._tones = tuple(
            (math.tau * f, -math.pi * k * (k + 1) / count, loudness(f, louder_from_Hz))
            for k, f in enumerate(ordered)
        )
        self._fade_s = fade_s
        self._filled = 0
        self._largest = 0.0

    def fill(self, samples: int) -> bool:
        """Work out some more samples; True when the table is complete."""
        total = len(self._table)
        end_s = total * self._cycle_s
        for k in range(self._filled, min(total, self._filled + samples)):
            t_s = k * self._cycle_s
            value = 0.0
            for omega, phase, size in self._tones:
                value += size * math.cos(omega * t_s + phase)
            edge = min(t_s, end_s - t_s) / self._fade_s
            value *= 0.5 - 0.5 * math.cos(math.pi * min(1.0, edge))
            self._table[k] = value
            self._largest = max(self._largest, abs(value))
            self._filled = k + 1
        return self._filled >= total

    def amplitude(self, peak: float) -> float:
        """Return the amplitude of a tone of loudness 1 when no sample may exceed ``peak``."""
        return peak / self._largest if self._largest > 0.0 else 0.0

    def sample(self, k: int, peak: float) -> float:
        """Return sample ``k``, 0 outside the table."""
        return self._table[k] * self.amplitude(peak) if 0 <= k < len(self._table) else 0.0

    def slew(self, peak: float) -> float:
        """Return a bound of the waveform's rate of change."""
        tones = self.amplitude(peak) * sum(size * omega for omega, _, size in self._tones)
        return tones + peak * 0.5 * math.pi / self._fade_s

    @property
    def tones(self) -> tuple[tuple[float, float, float], ...]:
        """Angular frequency (rad/s), phase (rad) and loudness of every tone."""
        return self._tones
