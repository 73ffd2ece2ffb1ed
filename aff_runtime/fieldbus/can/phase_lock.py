"""When to tick on a wire whose other side sets the pace: shortly after its scan is here."""

from __future__ import annotations

from typing import Final

_SHARE: Final = (
    16  # of the error that one tick takes back: arrival jitter is averaged over so many
)


class PhaseLock:
    """Keeps the tick a margin behind the arrival of the other side's scans.

    A tick that does not wait finds the newest scan complete, and as young as the margin allows,
    if it starts just after the arrival; unlocked it drifts through every phase, and where the two
    meet there is now no scan in a tick, now two. Scans and ticks of different rates cannot be
    locked: the error then wanders over the whole period and its small shares cancel.

    Parameters
    ----------
    period_ns : of the ticks.
    margin_ns : wanted time from the arrival of a scan to the start of the tick, more than what
        the arrivals jitter. Default: a fifth of the period.
    """

    def __init__(self, period_ns: int, margin_ns: int | None = None) -> None:
        self._period_ns = period_ns
        self._margin_ns = period_ns // 5 if margin_ns is None else margin_ns

    def shift_ns(self, lead_ns: int) -> int:
        """Return how much later (negative: earlier) the next ticks should start, ns.

        Parameters
        ----------
        lead_ns : time from the arrival of the newest scan to the start of this tick.
        """
        half_ns = self._period_ns // 2
        error_ns = (lead_ns - self._margin_ns + half_ns) % self._period_ns - half_ns
        return -round(error_ns / _SHARE)
