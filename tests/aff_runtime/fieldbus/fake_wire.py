"""A wire in virtual time: bytes arrive when the test says, and waiting moves the clock."""

from __future__ import annotations

from collections.abc import Callable

from aff_runtime.fieldbus.modbus.byte_stream import CLOSED, Connecting
from tests.doubles.virtual_clock import VirtualClock

# what a request provokes: (delay in ns, bytes), bytes None for the end of the connection
Arrivals = list[tuple[int, bytes | None]]


class FakeWire:
    def __init__(self, clock: VirtualClock, answer: Callable[[bytes], Arrivals]) -> None:
        self.clock = clock
        self.answer = answer
        self.requests: list[bytes] = []
        self.aborted: list[bool] = []
        self.attempts_ns: list[int] = []
        self.refuses = False
        self.state = Connecting.UP
        self.takes_bytes = True
        self.why_closed = ""
        self.lossy = False
        self._arrivals: list[tuple[int, bytes | None]] = []

    def start_connect(self) -> bool:
        self.attempts_ns.append(self.clock.now_ns())
        self._arrivals.clear()
        return not self.refuses

    def connecting(self) -> Connecting:
        return self.state

    def send(self, frame: bytes) -> bool:
        if not self.takes_bytes:
            return False
        self.requests.append(frame)
        now_ns = self.clock.now_ns()
        for delay_ns, data in self.answer(frame):
            self._arrivals.append((now_ns + delay_ns, data))
        self._arrivals.sort(key=lambda arrival: arrival[0])
        return True

    def receive(self, into: memoryview, wait_ns: int) -> int:
        now_ns = self.clock.now_ns()
        if not self._arrivals or self._arrivals[0][0] > now_ns + max(wait_ns, 0):
            self.clock.advance_ns(max(wait_ns, 0))
            return 0
        at_ns, data = self._arrivals.pop(0)
        self.clock.sleep_until_ns(at_ns)
        if data is None:
            return CLOSED
        into[: len(data)] = data
        return len(data)

    def close(self, *, abort: bool) -> None:
        self.aborted.append(abort)
        self._arrivals.clear()
