"""A CAN bus in memory: what was sent, and frames to hear, tick by tick."""

from __future__ import annotations

from collections import deque

from aff_runtime.fieldbus.can.frames import Frame
from tests.doubles.virtual_clock import VirtualClock


class FakeLink:
    """``FrameLink`` that a test feeds; waiting moves the clock to the end of the wait."""

    def __init__(self, clock: VirtualClock) -> None:
        self.clock = clock
        self.up = True
        self.sent: list[Frame] = []
        self.heard: deque[Frame] = deque()
        self.takes = True
        self.bus_offs = 0
        self.arrived_ns = -1
        self.troubles: tuple[str, ...] = ()

    @property
    def carries(self) -> bool:
        return self.up

    def ready(self) -> bool:
        return self.up

    def send(self, frame: Frame) -> bool:
        self.sent.append(frame)
        return self.takes

    def sync(self) -> bool:
        return self.takes

    def receive(self, wait_ns: int) -> Frame | None:
        if self.heard:
            return self.heard.popleft()
        self.clock.advance_ns(wait_ns)
        return None

    def close(self) -> None:
        self.up = False
