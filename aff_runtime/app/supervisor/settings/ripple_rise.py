"""Whether ripple is larger under other settings than it was before them; pure."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

from aff_runtime.app.link.settings_answer import RIPPLE_OF

BLOCK_S = 0.25
NOW_S, BEFORE_S = 5.0, 20.0
SETTLE_S = 2.0
"""After a change, before ripple counts: what goes fades out, what stays comes in again."""
ROSE = 1.3


@dataclass(slots=True)
class _Block:
    """Sums of one signal over a quarter of a second."""

    start_s: float
    count: int = 0
    total: float = 0.0
    squares: float = 0.0


class RippleRise:
    """Keeps the last seconds of error signals, and compares them with what was before a change.

    Ripple is the standard deviation over 5 s. It rose when it is above 1.3 times the largest of
    the four that came last before the change, in any signal. Where fewer than 5 s were heard since
    other settings ran, what counted as before them counts again; without that nothing is judged.
    """

    def __init__(self) -> None:
        self._blocks: dict[str, deque[_Block]] = {}
        self._before: dict[str, float] = {}
        self._since_s = math.inf

    def take(self, time_s: float, signals: Mapping[str, float]) -> None:
        """Take one reading of each signal, in its unit; NaN is none."""
        for name, value in signals.items():
            if not math.isfinite(value):
                continue
            blocks = self._blocks.setdefault(name, deque())
            if not blocks or not 0.0 <= time_s - blocks[-1].start_s < BLOCK_S:
                if blocks and time_s < blocks[-1].start_s:
                    blocks.clear()  # another clock
                blocks.append(_Block(start_s=time_s))
                while time_s - blocks[0].start_s > BEFORE_S:
                    blocks.popleft()
            block = blocks[-1]
            block.count += 1
            block.total += value
            block.squares += value * value

    def begin(self) -> None:
        """Take what was heard until now as what ripple was before."""
        for name, blocks in self._blocks.items():
            end_s = blocks[-1].start_s + BLOCK_S if blocks else 0.0
            ripples = [
                self._ripple(name, end_s - (k + 1) * NOW_S, end_s - k * NOW_S)
                for k in range(round(BEFORE_S / NOW_S))
            ]
            known = [ripple for ripple in ripples if math.isfinite(ripple)]
            if known:
                self._before[name] = max(known)
            blocks.clear()
        self._since_s = math.inf

    def end(self) -> None:
        """Forget what was heard while other settings ran: it is no ripple to compare with."""
        for blocks in self._blocks.values():
            blocks.clear()

    def risen(self) -> str:
        """Return in words what rose; empty when nothing did, or it is too early to tell."""
        for name, before in self._before.items():
            blocks = self._blocks[name]
            if not blocks:
                continue
            self._since_s = min(self._since_s, blocks[0].start_s)
            end_s = blocks[-1].start_s
            if end_s - NOW_S < self._since_s + SETTLE_S:
                continue
            now = self._ripple(name, end_s - NOW_S, end_s)
            if now > ROSE * before:
                return f"{RIPPLE_OF} {name} rose from {before:.3g} to {now:.3g}"
        return ""

    def _ripple(self, name: str, start_s: float, end_s: float) -> float:
        """Return the standard deviation of a signal in a time; NaN when most of it is missing."""
        chosen = [b for b in self._blocks[name] if start_s - 1e-9 <= b.start_s < end_s - 1e-9]
        if len(chosen) < 0.8 * (end_s - start_s) / BLOCK_S:
            return math.nan
        count = sum(block.count for block in chosen)
        mean = sum(block.total for block in chosen) / count
        square = sum(block.squares for block in chosen) / count
        return math.sqrt(max(0.0, square - mean * mean))
