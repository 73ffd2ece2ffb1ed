"""One spoilt byte of a serial reply costs its tick alone, at every cycle; in virtual time.

Both wires that carry serial frames are whole, from the site file to the bytes; only the line, or
the socket, is a script.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

from aff_runtime.base.signals import State
from aff_runtime.config.loader import load_site
from aff_runtime.config.models import Site
from aff_runtime.fieldbus.modbus import rtu_tcp_wire, rtu_wire
from aff_runtime.fieldbus.modbus.rtu_frames import rtu_of
from aff_runtime.fieldbus.modbus.tcp_wire import CLOSED, Connecting
from aff_runtime.fieldbus.modbus.transport import silence_before_reconnect
from tests.aff_runtime.app import fake_plc
from tests.aff_runtime.app.fake_plc import Plc
from tests.aff_runtime.fieldbus.fake_wire import Arrivals, FakeWire
from tests.aff_runtime.fieldbus.runtime_at_work import SITE, Runtime, framed
from tests.doubles.virtual_clock import VirtualClock

MS = 1_000_000
TIMES = {10: 80, 12: 80, 20: 80, 60: 180}  # cycle_ms: fault_after_ms, the default where it may be
WIRES = {
    "modbus_rtu": "{ device: /dev/line, baud: 1000000, deadline_ms: 8 }",
    "modbus_rtu_tcp": "{ host: 127.0.0.1, port: 4001, deadline_ms: 8 }",
}
REPLY_BYTES = 3 + 2 * 18 + 2  # of the site's read block
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
    """The runtime armed and at work; ``spoil`` and ``lost`` act on the next request alone."""

    def __init__(self, wire: str, cycle_ms: int, folder: Path, patch: pytest.MonkeyPatch) -> None:
        self.clock = VirtualClock(10**9)
        its_time = SimpleNamespace(monotonic=lambda: self.clock.now_ns() * 1e-9)
        patch.setattr(fake_plc, "time", its_time)
        self.plc = Plc()
        self.spoil: Spoil | None = None
        self.lost = False
        self.lines = [Line(self.clock, self._answer)]
        if wire == "modbus_rtu":
            patch.setattr(rtu_wire.serial, "Serial", lambda *_, **__: self.lines[0])
        else:
            patch.setattr(rtu_tcp_wire, "TcpWire", lambda *_: self.lines[0])
        self.lines[0].state = Connecting.UP
        self.runtime = Runtime(site_at(wire, cycle_ms, folder), self.plc, self.clock)

    def _answer(self, request: bytes) -> Arrivals:
        if self.lost:
            self.lost = False
            return []
        mbap = bytes(4) + (len(request) - 2).to_bytes(2, "big") + request[:-2]
        reply = rtu_of(framed(self.plc, mbap))
        spoil, self.spoil = self.spoil, None
        return [(3 * MS, spoil(reply) if spoil is not None else reply)]

    @property
    def drops(self) -> int:
        return self.lines[0].aborted.count(True)


def site_at(wire: str, cycle_ms: int, folder: Path) -> Site:
    fault_ms = TIMES[cycle_ms]
    text = re.sub(r"(?m)^  modbus_tcp:.*(\n    .*)*", f"  {wire}: {WIRES[wire]}", SITE.read_text())
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


@pytest.fixture(params=[(wire, cycle) for wire in WIRES for cycle in TIMES], ids=str)
def bench(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Bench]:
    wire, cycle_ms = request.param
    running = Bench(wire, cycle_ms, tmp_path, monkeypatch)
    yield running
    running.runtime.gateway.close()


def flipped(place: int, mask: int) -> Spoil:
    return lambda reply: reply[:place] + bytes([reply[place] ^ mask]) + reply[place + 1 :]


def without(place: int) -> Spoil:
    return lambda reply: reply[:place] + reply[place + 1 :]


def doubled(place: int) -> Spoil:
    return lambda reply: reply[: place + 1] + reply[place:]


def test_one_spoilt_byte_anywhere_in_a_reply_never_reaches_the_fault(bench: Bench) -> None:
    runtime = bench.runtime
    runtime.run(2)
    for place in range(REPLY_BYTES):
        for spoil in (flipped(place, 0x01), flipped(place, 0x80), without(place), doubled(place)):
            bench.spoil = spoil
            heard = bench.plc.heartbeat
            runtime.run(5)
            assert bench.plc.heartbeat == heard + 5, "asked in every tick"
            assert runtime.guard.state is State.ACTIVE, f"byte {place}: {runtime.outside.reasons}"
    assert runtime.is_working
    assert bench.drops == 0
    assert runtime.gateway.troubles == ()


def test_a_line_that_spoils_every_reply_goes_to_zero_and_says_why(bench: Bench) -> None:
    for _ in range(30):
        bench.spoil = flipped(5, 0x10)
        bench.runtime.run(1)
    assert bench.runtime.guard.state is State.FAULT
    assert bench.runtime.is_zero
    assert "wrong CRC or length" in bench.runtime.gateway.troubles[0]


def test_a_lost_reply_is_not_dropped_in_its_own_tick_and_replaced_before_the_fault(
    bench: Bench,
) -> None:
    bench.runtime.run(250)  # 2 s and more: a connection that served is replaced at once
    site_ms = bench.runtime.cycle._settings.period_ns // MS
    bench.lost, before = True, bench.drops
    bench.runtime.run(1)
    assert bench.drops == before
    bench.runtime.run(12)
    assert bench.drops == before + 1
    # five cycles pass from the last reading before to the second one of the new connection
    in_time = 5 * site_ms < TIMES[site_ms]
    assert bench.runtime.guard.state is (State.ACTIVE if in_time else State.FAULT)


@pytest.mark.parametrize("fault_ms", [15, 30, 80, 180, 290])
@pytest.mark.parametrize("cycle_ms", [1, 2, 5, 10, 12, 16, 20, 60])
def test_the_silence_leaves_time_for_a_new_connection_or_for_every_useful_wait(
    cycle_ms: int, fault_ms: int
) -> None:
    silence_ms = 1e3 * silence_before_reconnect(cycle_ms * 1e-3, fault_ms * 1e-3)
    dropped = next(j for j in range(1, 1000) if j * cycle_ms >= silence_ms)  # ticks after asking
    fresh_ms = (dropped + 4) * cycle_ms  # since the heartbeat last moved
    if 5 * cycle_ms < fault_ms:
        assert fresh_ms < fault_ms
    else:  # too late anyway: a reply that comes before tick j is fresh at j, (j + 1) cycles old
        assert dropped == 1 or dropped * cycle_ms < fault_ms
        assert (dropped + 1) * cycle_ms >= fault_ms


def test_the_shipped_times_keep_their_silence() -> None:
    assert silence_before_reconnect(0.005, 0.080) == pytest.approx(0.050)
