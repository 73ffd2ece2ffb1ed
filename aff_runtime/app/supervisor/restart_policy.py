"""When a dead control process may come back: idle, after a pause, and not for ever."""

from __future__ import annotations

BACK_OFF_S = (0.5, 1.0)  # pause after the first and second death of a window
WINDOW_S = 60.0
FATAL_DEATHS = 3


class RestartPolicy:
    """Counts deaths; time is an argument.

    Three deaths within 60 s end the attempts: whatever kills the process is not going to heal.
    """

    def __init__(self) -> None:
        self._deaths_s: list[float] = []

    def died(self, now_s: float) -> float | None:
        """Record a death at ``now_s``; return the pause before the next start, None: give up."""
        self._deaths_s = [t for t in self._deaths_s if now_s - t < WINDOW_S] + [now_s]
        if len(self._deaths_s) >= FATAL_DEATHS:
            return None
        return BACK_OFF_S[len(self._deaths_s) - 1]
