"""A Modbus transport on a fake wire, in virtual time."""

from __future__ import annotations

from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus.frames import ModbusFrames, WireFunction
from aff_runtime.fieldbus.modbus.transport import ModbusTransport
from tests.aff_runtime.fieldbus.fake_wire import Arrivals, FakeWire
from tests.aff_runtime.fieldbus.modbus_bytes import (
    function_of,
    register_reply,
    tid_of,
    write_reply,
)
from tests.doubles.virtual_clock import VirtualClock

MS = 1_000_000
DEADLINE_NS = 3 * MS
PERIOD_NS = 5 * MS
WORDS = [11, 12]
READ_COUNT = 3


def good(request: bytes) -> bytes:
    """A reply whose words name the request they answer."""
    if function_of(request) == 16:
        return write_reply(request)
    return register_reply(request, [tid_of(request)] * READ_COUNT)


class Rig:
    """A transport on a fake wire, ticked every 5 ms with 3 ms for the wire."""

    def __init__(
        self, function: WireFunction = WireFunction.FC23, silence_s: float = 0.05
    ) -> None:
        self.clock = VirtualClock(start_ns=10**9)
        self.wire = FakeWire(self.clock, lambda request: [(MS, good(request))])
        frames = ModbusFrames(
            device_id=1, read_start=0, read_count=READ_COUNT, write_start=100, write_count=2
        )
        self.transport = ModbusTransport(
            frames=frames,
            wire=self.wire,
            clock=self.clock,
            function=function,
            silence_before_reconnect_s=silence_s,
        )
        self.waited_ns = 0

    def tick(self, words: list[int] | None = None) -> tuple[Outcome, list[int]]:
        start_ns = self.clock.now_ns()
        result = self.transport.transact(words or WORDS, start_ns + DEADLINE_NS)
        self.waited_ns = self.clock.now_ns() - start_ns
        self.clock.sleep_until_ns(start_ns + PERIOD_NS)
        return result

    def outcomes(self, ticks: int) -> list[Outcome]:
        return [self.tick()[0] for _ in range(ticks)]

    def connected(self) -> Rig:
        assert self.outcomes(2) == [Outcome.NOT_CONNECTED, Outcome.OK]
        return self


def silence(_request: bytes) -> Arrivals:
    return []
