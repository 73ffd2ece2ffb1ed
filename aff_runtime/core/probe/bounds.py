"""What ends a probe in the middle: the tension leaves its bound, or the line its speed."""

from __future__ import annotations

import math
from collections.abc import Sequence

SPEED_SHARE = 0.05
"""Of the line speed: responses of speeds that differ by more are not of one place."""
SPEED_SMOOTHED_S = 0.5
LATE_READINGS = 3
"""Readings one after the other that lie outside: one alone may be noise, or a bad word."""


class Bounds:
    """Learns from a quiet stretch how signals and speed are, then says when they leave it.

    A signal may move by ``most`` beyond the largest distance from its mean that it had while
    nothing was sent: its own ripple goes on under the tones, and counts for no part of them.

    Parameters
    ----------
    names : of the signals. ``most`` : in their unit, and ``shares`` of their mean: the lesser.
    """

    def __init__(
        self, names: Sequence[str], most: Sequence[float], shares: Sequence[float], cycle_s: float
    ) -> None:
        self._names, self._most, self._shares = names, most, shares
        self._keep = math.exp(-cycle_s / SPEED_SMOOTHED_S)
        self.begin()

    def begin(self) -> None:
        """Forget the quiet stretch."""
        self._sums = [0.0] * len(self._names)
        self._lows = [math.inf] * len(self._names)
        self._highs = [-math.inf] * len(self._names)
        self._count = [0] * len(self._names)
        self._outside = [0] * len(self._names)
        self._speed_sum, self._speed_count = 0.0, 0
        self._speed_m_s = math.nan
        self.moved = [0.0] * len(self._names)

    def listen(self, values: Sequence[float], speed_m_s: float) -> str:
        """Take one quiet sample; return why the stretch is of no use, else nothing."""
        for i, value in enumerate(values):
            if math.isfinite(value):
                self._sums[i] += value
                self._count[i] += 1
                self._lows[i] = min(self._lows[i], value)
                self._highs[i] = max(self._highs[i], value)
        why = self._speed_wanders(speed_m_s)
        if math.isfinite(speed_m_s):
            self._speed_sum += speed_m_s
            self._speed_count += 1
        return why

    def look(self, values: Sequence[float], speed_m_s: float) -> str:
        """Take one sample under the tones; return why the probe has to end, else nothing."""
        for i, value in enumerate(values):
            if not math.isfinite(value) or not self._count[i]:
                continue
            beyond = max(value - self._highs[i], self._lows[i] - value, 0.0)
            self._outside[i] = self._outside[i] + 1 if beyond > self.most(i) else 0
            if self._outside[i] == 0:
                self.moved[i] = max(self.moved[i], min(beyond, self.most(i)))
            if self._outside[i] >= LATE_READINGS:
                self.moved[i] = max(self.moved[i], beyond)
                return (
                    f"{self._names[i]} moved {beyond:.3g} beyond what it did before the probe, "
                    f"the bound is {self.most(i):.3g}; was it the probe, lower "
                    "probe.bound_m_s, else wait until the line is steady"
                )
        return self._speed_wanders(speed_m_s)

    def most(self, i: int) -> float:
        """Return the bound of one signal, in its unit."""
        mean = abs(self._sums[i]) / self._count[i] if self._count[i] else math.inf
        return min(self._most[i], self._shares[i] * mean)

    @property
    def speed_m_s(self) -> float:
        """Mean line speed of the quiet stretch; NaN where it is not known."""
        return self._speed_sum / self._speed_count if self._speed_count else math.nan

    def _speed_wanders(self, speed_m_s: float) -> str:
        if not math.isfinite(speed_m_s):
            return ""
        if math.isnan(self._speed_m_s):
            self._speed_m_s = speed_m_s
        self._speed_m_s += (1.0 - self._keep) * (speed_m_s - self._speed_m_s)
        if not self._speed_count:
            return ""
        mean = self.speed_m_s
        if abs(self._speed_m_s - mean) <= SPEED_SHARE * abs(mean):
            return ""
        return (
            f"the line speed went from {mean:.3g} to {self._speed_m_s:.3g} m/s; a probe bears "
            f"{SPEED_SHARE:.0%}: probe again when the speed stands"
        )
