"""Does the other side live? One judgement for every wire, by the PLC's own heartbeat."""

from __future__ import annotations

from typing import Final

from aff_runtime.base.signals import NO_ECHO, Outcome

_OK = Outcome.OK
_LONGEST_STEP: Final = 256  # of a PLC that started again: scans of 1 ms, seen each 100 ms and more


def echo_age(heartbeat: int, echo: int | None) -> int:
    """Return how many ticks before ``heartbeat`` the echoed one was sent; NO_ECHO for None."""
    return NO_ECHO if echo is None else (heartbeat - echo) & 0xFFFF


class HeartbeatOrder:
    """Which heartbeat may come next; a step back is an old reading until the next one follows it.

    A stopped program behind two buffers shows two old readings by turns: a heartbeat that only
    had to be another one would be live for ever. Forward is less than half the counter's range;
    two steps back in a row that follow each other are a PLC that started again.

    Parameters
    ----------
    mask : all ones of the counter, 0xFF or more.
    """

    def __init__(self, mask: int) -> None:
        self._mask = mask
        self._longest = min(_LONGEST_STEP, mask >> 2)
        self._refused: int | None = None

    def forget(self) -> None:
        """Start afresh, as after a loss."""
        self._refused = None

    def takes(self, heartbeat: int, last: int | None) -> bool:
        """Return whether ``heartbeat`` may come after ``last``; None: after nothing known."""
        mask = self._mask
        if last is None or (heartbeat - last) & mask <= mask >> 1:
            self._refused = None
            return True
        refused, self._refused = self._refused, heartbeat
        return refused is not None and 0 < (heartbeat - refused) & mask <= self._longest


class Liveness:
    """Compares heartbeats and ages them; knows no words and no frames.

    Only a heartbeat that moved proves a live program: a server keeps answering with frozen words
    when its program has stopped. The first good set after a loss gives the heartbeat to compare
    with, and is itself reported as NOT_CONNECTED, so that its values go nowhere.

    Parameters
    ----------
    now_ns : monotonic time from which age counts until a heartbeat has moved.
    lost : whether the wire counts as lost before anything was heard.

    Attributes
    ----------
    heartbeat : the last one that was heard.
    fresh : whether it moved with the last ``judge``.
    """

    def __init__(self, now_ns: int, *, lost: bool) -> None:
        self.heartbeat = 0
        self.fresh = False
        self._known = False
        self._lost = lost
        self._moved_at_ns = now_ns

    @property
    def lost(self) -> bool:
        """Return whether the next good set is the first one after a loss."""
        return self._lost

    def judge(self, outcome: Outcome, heartbeat: int, arrived_ns: int) -> Outcome:
        """Take how one exchange ended; return how it counts.

        Parameters
        ----------
        outcome : of the wire; NOT_CONNECTED is a loss, OK a good set.
        heartbeat : of the set; ignored unless OK.
        arrived_ns : monotonic time at which the set was here, ns.
        """
        self.fresh = False
        if outcome is Outcome.NOT_CONNECTED:
            self._lost = True
        elif outcome is _OK:
            moved = self._known and heartbeat != self.heartbeat
            self.heartbeat, self._known = heartbeat, True
            if self._lost:
                self._lost = False
                return Outcome.NOT_CONNECTED
            self.fresh = moved
            if moved:
                self._moved_at_ns = arrived_ns
        return outcome

    def age_s(self, now_ns: int) -> float:
        """Return the time since the heartbeat last moved, s."""
        return (now_ns - self._moved_at_ns) * 1e-9
