"""One CAN frame, and what the gateway needs of a bus: send, receive, know whether it lives."""

from __future__ import annotations

from typing import NamedTuple, Protocol


class Frame(NamedTuple):
    """A classic data frame: identifier, 29 bits or 11, and up to eight bytes."""

    can_id: int
    extended: bool
    data: bytes


class FrameLink(Protocol):
    """A CAN bus that never raises and never waits longer than it is told."""

    @property
    def bus_offs(self) -> int:
        """How often the controller went bus-off since construction."""
        ...

    @property
    def carries(self) -> bool:
        """Whether frames can be sent, even if what comes back is not to be believed."""
        ...

    @property
    def arrived_ns(self) -> int:
        """Monotonic time at which the last frame received was here; -1 when it is not known."""
        ...

    @property
    def troubles(self) -> tuple[str, ...]:
        """What keeps the bus from working, one sentence each."""
        ...

    def ready(self) -> bool:
        """Move a pending (re)connection one step; True when frames can be exchanged."""
        ...

    def send(self, frame: Frame) -> bool:
        """Queue one frame; False when the bus does not take it."""
        ...

    def sync(self) -> bool:
        """Say that the tick's frames are out: a bus with a SYNC sends it; False as of ``send``."""
        ...

    def receive(self, wait_ns: int) -> Frame | None:
        """Return the next data frame, waiting at most ``wait_ns``; None when there is none.

        A bus found dead makes the next ``ready`` False.
        """
        ...

    def close(self) -> None:
        """Release the bus."""
        ...
