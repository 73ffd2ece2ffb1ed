"""A client on a real socket that asks for the shipped map, and a strange server for it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pymodbus.simulator import SimDevice

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus.byte_stream import ByteStream
from aff_runtime.fieldbus.modbus.connections import modbus
from aff_runtime.fieldbus.modbus.frames import WireFunction
from aff_runtime.fieldbus.modbus.transport import ModbusTransport
from tests.aff_runtime.fieldbus.euclid_map import euclid_map
from tests.aff_runtime.fieldbus.modbus.strange_server import StrangeServer

READ_COUNT = 15  # words of the map's read block
WORDS = [7] * 10
GENEROUS_NS = 2_000_000_000  # for replies that must come, on a busy machine
SHORT_NS = 15_000_000  # for replies that must not


def client(wire: ByteStream, function: WireFunction = WireFunction.FC23) -> ModbusTransport:
    """Return a client of device 1 on a wire."""
    return modbus(
        wire, device_id=1, register_map=euclid_map(), clock=MonotonicClock(), function=function
    )


def ask(transport: ModbusTransport, wait_ns: int = GENEROUS_NS) -> tuple[Outcome, list[int]]:
    """Write ``WORDS``; return what came of it, and the words that were read."""
    return transport.transact(WORDS, MonotonicClock().now_ns() + wait_ns)


class KeepingServer(StrangeServer):
    """A server whose registers hold their own numbers; ``writes`` keeps what was written."""

    def __init__(self, make: Callable[[SimDevice], Any]) -> None:
        super().__init__(make, list(range(200)))
        self.writes: list[list[int]] = []

    async def act(self, *said: Any) -> None:
        """Keep what is written."""
        if isinstance(said[-1], list):
            self.writes.append([int(word) for word in said[-1]])
