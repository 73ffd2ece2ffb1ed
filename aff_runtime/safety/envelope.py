"""The gate between a law and the line: opens gently, closes to zero in a fixed time."""

from __future__ import annotations

from math import acos, cos, pi


class Envelope:
    """Raised-cosine share of the output, 0..1; reverses from any point without a step.

    Opening: e = (1 - cos(pi x)) / 2 over ``soft_start_s``. Closing from e0:
    e = e0 (1 + cos(pi y)) / 2, exactly zero after ``fade_s``. Never raises.
    """

    def __init__(self, *, soft_start_s: float, fade_s: float) -> None:
        self.soft_start_s = soft_start_s
        self.fade_s = fade_s
        self.level = 0.0
        self._opening = 0.0
        self._closing = 0.0
        self._closing_from = 0.0
        self._is_closing = True

    def step(self, wanted: bool, dt_s: float) -> float:
        """Move by ``dt_s`` towards open or closed and return the level."""
        if wanted:
            self._open(dt_s)
        else:
            self._close(dt_s)
        return self.level

    def shut(self) -> None:
        """Close at once: a zero has gone out already."""
        self.level = self._closing_from = 0.0
        self._closing = 1.0
        self._is_closing = True

    def _open(self, dt_s: float) -> None:
        if self._is_closing:
            self._is_closing = False
            self._opening = acos(max(-1.0, min(1.0, 1.0 - 2.0 * self.level))) / pi
        self._opening = min(1.0, self._opening + _share(dt_s, self.soft_start_s))
        self.level = 0.5 * (1.0 - cos(pi * self._opening))

    def _close(self, dt_s: float) -> None:
        if not self._is_closing:
            self._is_closing = True
            self._closing = 0.0
            self._closing_from = self.level
        self._closing = min(1.0, self._closing + _share(dt_s, self.fade_s))
        if self._closing >= 1.0 - 1e-9:
            self.level = 0.0
        else:
            self.level = self._closing_from * 0.5 * (1.0 + cos(pi * self._closing))


def _share(dt_s: float, whole_s: float) -> float:
    return dt_s / whole_s if whole_s > dt_s else 1.0
