"""The PLC's own request to arm: its reset key, while the line is in remote."""

from __future__ import annotations

from aff_runtime.base.signals import Outcome, Snapshot, Status

_OK = Outcome.OK
_REMOTE, _RESET_EDGE = int(Status.REMOTE), int(Status.RESET_EDGE)


class PlcReset:
    """Finds the moment in which RESET_EDGE rises while REMOTE is set.

    An edge is a 0 and then a 1 with trusted data all the while: a bit that is already high when
    the connection comes up, or that rose in a gap, is no operator's request. Never raises.

    Attributes
    ----------
    remote : the PLC alone may arm; by the last good reading.
    """

    def __init__(self) -> None:
        self.remote = False
        self._was_low = False

    def step(self, snapshot: Snapshot, trusted: bool) -> bool:
        """Return True in the tick of an edge; ``trusted`` False forgets what was seen."""
        if snapshot.outcome is _OK:
            self.remote = bool(snapshot.status & _REMOTE)
        if not trusted:
            self._was_low = False
            return False
        if snapshot.outcome is not _OK or not snapshot.fresh:
            return False
        high = bool(snapshot.status & _RESET_EDGE)
        rises = high and self._was_low and self.remote
        self._was_low = not high
        return rises
