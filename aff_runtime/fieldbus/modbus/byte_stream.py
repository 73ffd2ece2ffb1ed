"""A byte stream to the PLC, whatever carries it: what the transport asks of every wire."""

from __future__ import annotations

from enum import IntEnum
from typing import Final, Protocol

CLOSED: Final = -1
SPOILT: Final = -2
"""What came in answer to the request is no reply, and no other will come: it may be asked anew."""
DOUBTED: Final = -5
"""What came is no reply, and may be noise before the reply to the request: until another function
was answered no reply of its function is to be believed."""
UNHEARD: Final = -3
"""No reply for so long that it may be lost, and a late one would be told from the reply to another
function: that one may be asked."""
LATE: Final = -4
"""The reply to the request before the last came, and was thrown away: the other side lives."""


class Connecting(IntEnum):
    """How far a connection attempt is."""

    PENDING = 0
    UP = 1
    FAILED = 2


class ByteStream(Protocol):
    """A byte stream that never blocks longer than it is told and never raises.

    Attributes
    ----------
    why_closed : why the last attempt to connect failed, with what was tried; empty before, and
        while there is a connection.
    lossy : whether frames may be lost, doubled or late on it while both ends are well. It then
        gives whole frames only.
    """

    @property
    def lossy(self) -> bool:
        """Whether a frame that does not come proves nothing."""
        ...

    @property
    def why_closed(self) -> str:
        """The system's own words."""
        ...

    def start_connect(self) -> bool:
        """Begin a connection attempt; False when it failed at once."""
        ...

    def connecting(self) -> Connecting:
        """Return the state of the attempt, without waiting."""
        ...

    def send(self, frame: bytes) -> bool:
        """Hand over the whole frame; False when the connection did not take it."""
        ...

    def receive(self, into: memoryview, wait_ns: int) -> int:
        """Wait at most ``wait_ns`` and read once; bytes read, 0 for none yet, or what ended.

        CLOSED, SPOILT, DOUBTED, UNHEARD, or LATE.
        """
        ...

    def close(self, *, abort: bool) -> None:
        """Close; ``abort`` drops unsent and unacknowledged bytes instead of delivering them."""
        ...
