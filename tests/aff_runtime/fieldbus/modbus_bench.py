"""The runtime at work on a Modbus wire in virtual time, and a PLC whose replies go wrong.

The wires are whole, from the site file to the bytes; only the line, or the socket, is a script.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest

from aff_runtime.config.loader import load_site
from aff_runtime.config.models import Site
from aff_runtime.fieldbus.modbus import connections, rtu_tcp_wire, rtu_wire
from aff_runtime.fieldbus.modbus.byte_stream import CLOSED, Connecting
from aff_runtime.fieldbus.modbus.rtu_frames import rtu_of
from tests.aff_runtime.app import fake_plc
from tests.aff_runtime.app.fake_plc import Plc
from tests.aff_runtime.fieldbus.fake_wire import Arrivals, FakeWire
from tests.aff_runtime.fieldbus.runtime_at_work import SITE, Runtime, framed
from tests.doubles.virtual_clock import VirtualClock

MS = 1_000_000
WIRES = {
    "modbus_tcp": "{ host: 127.0.0.1, port: 5020, deadline_ms: DEADLINE }",
    "modbus_rtu": "{ device: /dev/line, baud: 1000000, deadline_ms: DEADLINE }",
    "modbus_rtu_tcp": "{ host: 127.0.0.1, port: 4001, deadline_ms: DEADLINE }",
}
REPLY_MS = 2
Spoil = Callable[[bytes], bytes]


class Line(FakeWire):
    """A serial line, or a socket that carries one: FakeWire, and what pyserial asks for."""

    timeout = 0.0

    def read(self, size: int) -> bytes:
        view = memoryview(bytearray(512))
        count = self.receive(view, round(self.timeout * 1e9))
        del size  # a line gives what is there
        return bytes(view[:count]) if count != CLOSED else b""

    def write(self, frame: bytes) -> int:
        self.send(frame)
        return len(frame)

    def reset_input_buffer(self) -> None:
        self._arrivals = [one for one in self._arrivals if one[0] > self.clock.now_ns()]

    def close(self, *, abort: bool = True) -> None:
        super().close(abort=abort)


class Bench:
    """The runtime armed and at work.

    Attributes
    ----------
    spoil, lost, pause_ms : act on the next request alone: what its reply becomes; no reply; a
        reply that comes so long after its request.
    drops_while_busy : whether a request that comes during such a pause is not taken; else its
        reply follows the one before.
    cut : no reply until the connection is another one.
    """

    def __init__(
        self, wire: str, cycle_ms: int, fault_ms: int, folder: Path, patch: pytest.MonkeyPatch
    ) -> None:
        self.clock = VirtualClock(10**9)
        its_time = SimpleNamespace(monotonic=lambda: self.clock.now_ns() * 1e-9)
        patch.setattr(fake_plc, "time", its_time)
        self.plc = Plc()
        self.spoil: Spoil | None = None
        self.lost = self.drops_while_busy = False
        self.pause_ms = 0
        self._busy_until_ns = 0
        self._cut_at = -1
        self._serial = wire != "modbus_tcp"
        self.line = Line(self.clock, self._answer)
        if wire == "modbus_rtu":
            patch.setattr(rtu_wire.serial, "Serial", lambda *_, **__: self.line)
        else:
            room = rtu_tcp_wire if self._serial else connections
            patch.setattr(room, "TcpWire", lambda *_: self.line)
        self.line.state = Connecting.UP
        self.cycle_ms = cycle_ms
        self.runtime = Runtime(site_at(wire, cycle_ms, fault_ms, folder), self.plc, self.clock)

    def cut(self) -> None:
        self._cut_at = self.drops

    def _answer(self, request: bytes) -> Arrivals:
        now_ns = self.clock.now_ns()
        busy = now_ns < self._busy_until_ns
        if self.lost or self._cut_at == self.drops or (busy and self.drops_while_busy):
            self.lost = False
            return []
        reply = self._reply(request)
        spoil, self.spoil = self.spoil, None
        wait_ns = (self.pause_ms or REPLY_MS) * MS
        if busy:  # one after the other
            wait_ns = max(wait_ns, self._busy_until_ns - now_ns + REPLY_MS * MS)
        self.pause_ms, self._busy_until_ns = 0, now_ns + wait_ns
        return [(wait_ns, spoil(reply) if spoil is not None else reply)]

    def _reply(self, request: bytes) -> bytes:
        if not self._serial:
            return framed(self.plc, request)
        mbap = bytes(4) + (len(request) - 2).to_bytes(2, "big") + request[:-2]
        return rtu_of(framed(self.plc, mbap))

    @property
    def drops(self) -> int:
        return self.line.aborted.count(True)


def site_at(wire: str, cycle_ms: int, fault_ms: int, folder: Path) -> Site:
    section = WIRES[wire].replace("DEADLINE", str(min(8, cycle_ms - 2)))
    text = re.sub(r"(?m)^  modbus_tcp:.*(\n    .*)*", f"  {wire}: {section}", SITE.read_text())
    for key, was, now in (
        ("cycle_ms", "5", cycle_ms),
        ("fault_after_ms", "80", fault_ms),
        ("fade_ms", "150", min(150, 300 - fault_ms)),
        ("hold_after_ms", "15", 2 * cycle_ms),
    ):
        text = re.sub(rf"(?m)^(\s*){key}: {was}$", rf"\g<1>{key}: {now}", text)
    path = folder / "site.yaml"
    path.write_text(text)
    return load_site(path)
