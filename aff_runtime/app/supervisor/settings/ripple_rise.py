"""Whether ripple is larger under other settings than it was before them; no clock, no ring."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

from aff_runtime.app.link.settings_answer import RIPPLE_OF

BIN_S = 0.25
NOW_S, BEFORE_S = 5.0, 20.0
"""Length of one ripple, and how long before a change the ripples to compare with are taken."""
SETTLE_S = 2.0
"""After a change, before ripple counts: what goes fades out, what stays comes in again."""
ROSE = 1.3
"""Ripple over the largest one before, above which it rose."""
ENOUGH = 0.8
"""Share of the bins that a ripple needs."""


@dataclass(slots=True)
class _Bin:
    """Sums of one signal over ``BIN_S``."""

    start_s: float
    count: int = 0
    total: float = 0.0
    squares: float = 0.0


class RippleRise:
    """Keeps the last seconds of error signals, and compares them with what was before a change.

    Ripple is the standard deviation over 5 s. It rose when it is above 1.3 times the largest of
    the four that came last before the change, in any signal. Where fewer than 5 s were recorded
    since the last try, the ripple before that try counts again; without one nothing is judged.
    """

    def __init__(self) -> None:
        self._bins: dict[str, deque[_Bin]] = {}
        self._before: dict[str, float] = {}
        self._since_s = math.inf

    def take(self, time_s: float, signals: Mapping[str, float]) -> None:
        """Take one reading of each signal, in its unit; NaN is none."""
        for name, value in signals.items():
            if not math.isfinite(value):
                continue
            bins = self._bins.setdefault(name, deque())
            if not bins or not 0.0 <= time_s - bins[-1].start_s < BIN_S:
                if bins and time_s < bins[-1].start_s:
                    bins.clear()  # another clock
                bins.append(_Bin(start_s=time_s))
                while time_s - bins[0].start_s > BEFORE_S:
                    bins.popleft()
            newest = bins[-1]
            newest.count += 1
            newest.total += value
            newest.squares += value * value

    def begin(self) -> None:
        """Take the ripple recorded until now as that before a change."""
        for name, bins in self._bins.items():
            end_s = bins[-1].start_s + BIN_S if bins else 0.0
            ripples = [
                self._ripple(name, end_s - (k + 1) * NOW_S, end_s - k * NOW_S)
                for k in range(round(BEFORE_S / NOW_S))
            ]
            known = [ripple for ripple in ripples if math.isfinite(ripple)]
            if known:
                self._before[name] = max(known)
            bins.clear()
        self._since_s = math.inf

    def end(self) -> None:
        """Forget the readings under other settings: they are no ripple to compare with."""
        for bins in self._bins.values():
            bins.clear()

    def risen(self) -> str:
        """Return in words what rose; empty when nothing did, or it is too early to tell."""
        for name, before in self._before.items():
            bins = self._bins[name]
            if not bins:
                continue
            self._since_s = min(self._since_s, bins[0].start_s)
            end_s = bins[-1].start_s
            if end_s - NOW_S < self._since_s + SETTLE_S:
                continue
            now = self._ripple(name, end_s - NOW_S, end_s)
            if now > ROSE * before:
                return f"{RIPPLE_OF} {name} rose from {before:.3g} to {now:.3g}"
        return ""

    def _ripple(self, name: str, start_s: float, end_s: float) -> float:
        """Return a signal's standard deviation from start to end; NaN of less than ``ENOUGH``."""
        chosen = [b for b in self._bins[name] if start_s - 1e-9 <= b.start_s < end_s - 1e-9]
        if len(chosen) < ENOUGH * (end_s - start_s) / BIN_S:
            return math.nan
        count = sum(one.count for one in chosen)
        mean = sum(one.total for one in chosen) / count
        square = sum(one.squares for one in chosen) / count
        return math.sqrt(max(0.0, square - mean * mean))
