"""Somebody else on the bus who sends as this gateway does: heard of until a second after."""

from __future__ import annotations

from typing import Final

from aff_runtime.base.ports import Clock

_ALONE_AFTER_NS: Final = 1_000_000_000  # without another one in our place


class Intruder:
    """Remembers what was last heard of somebody else in our place."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._alone_at_ns = clock.now_ns()
        self._text = ""

    @property
    def trouble(self) -> str:
        """What the other does and what to do; empty while we are alone."""
        return self._text if self._clock.now_ns() < self._alone_at_ns else ""

    def heard(self, what: str) -> None:
        """Note a frame of ours that somebody else sent."""
        self._text = f"somebody else sends {what}; take it off the bus"
        self._alone_at_ns = self._clock.now_ns() + _ALONE_AFTER_NS
