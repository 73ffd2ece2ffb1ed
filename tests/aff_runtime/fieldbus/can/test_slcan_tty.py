from __future__ import annotations

import os
import select
import tty
from collections.abc import Iterator

import pytest

from aff_runtime.base.python_can import can
from aff_runtime.fieldbus.can.frames import Frame
from aff_runtime.fieldbus.can.link import PythonCanLink
from aff_runtime.fieldbus.can.slcan_tty import SlcanTtyBus, parse_line
from tests.doubles.virtual_clock import VirtualClock

pytestmark = pytest.mark.wire


@pytest.fixture
def line() -> Iterator[tuple[int, str]]:
    master, slave = os.openpty()
    tty.setraw(slave)
    os.set_blocking(master, False)
    yield master, os.ttyname(slave)
    os.close(slave)
    os.close(master)


def passed_on(master: int, size: int) -> bytes:
    """Return what the terminal passes on, ``size`` bytes of it: it may come in pieces."""
    found = b""
    for _ in range(200):
        if len(found) >= size or not select.select([master], [], [], 0.05)[0]:
            break
        found += os.read(master, 99)
    return found


def test_opening_says_rate_and_open(line: tuple[int, str]) -> None:
    master, path = line
    bus = SlcanTtyBus(path, 500_000)
    assert passed_on(master, 7) == b"C\rS6\rO\r"
    bus.shutdown()
    assert passed_on(master, 2) == b"C\r"


def test_frames_go_out_in_the_letters_of_the_protocol(line: tuple[int, str]) -> None:
    master, path = line
    bus = SlcanTtyBus(path)
    passed_on(master, 7)
    bus.send(can.Message(arbitration_id=0x20A, is_extended_id=False, data=b"\x01\xab"))
    bus.send(can.Message(arbitration_id=0x1ABCDEF0, is_extended_id=True, data=b""))
    sent = b"t20A201AB\rT1ABCDEF00\r"
    assert passed_on(master, len(sent)) == sent
    bus.shutdown()


def test_a_burst_in_pieces_comes_in_whole(line: tuple[int, str]) -> None:
    master, path = line
    bus = SlcanTtyBus(path)
    os.write(master, b"z\rt1802AA")
    assert bus.recv(0.05) is None
    os.write(master, b"BB\r\x07t18100000\r")
    first = bus.recv(0.5)
    assert first is not None
    assert (first.arbitration_id, bytes(first.data)) == (0x180, b"\xaa\xbb")
    second = bus.recv(0.5)
    assert second is not None
    assert (second.arbitration_id, second.dlc) == (0x181, 0)
    bus.shutdown()


@pytest.mark.parametrize(
    "text",
    [
        b"",
        b"t",
        b"t18",
        b"t1809",
        b"t1802AA",
        b"t1802AABBC",
        b"t8000",
        b"tXYZ0",
        b"x",
        b"t1801G1",
        b"t+181AA",
        b"t 181AA",
        b"t1_81AA",
        b"t1801 A",
        b"t1802 A B",
        b"t1801AAzzzz",
    ],
)
def test_garbage_is_no_frame(text: bytes) -> None:
    assert parse_line(text) is None


def test_bus_off_takes_the_link_down_and_it_comes_back_by_itself(line: tuple[int, str]) -> None:
    master, path = line
    clock = VirtualClock()
    link = PythonCanLink(lambda: SlcanTtyBus(path), clock, backoff_min_s=0.1)
    assert not link.ready()
    assert link.ready()
    os.write(master, b"sb128255\r")
    assert link.receive(500_000_000) is None
    assert link.bus_offs == 1
    assert not link.ready()
    assert not link.send(Frame(1, False, b""))
    clock.advance_ns(100_000_000)
    assert not link.ready()  # this tick opens it
    assert link.ready()
    os.write(master, b"t1800\r")
    assert link.receive(500_000_000) == Frame(0x180, False, b"")
    link.close()


def test_a_lost_line_is_reopened_with_growing_pauses() -> None:
    clock = VirtualClock()
    tries: list[int] = []

    def absent() -> can.BusABC:
        tries.append(clock.now_ns() // 1_000_000)
        raise OSError("no such device")

    link = PythonCanLink(absent, clock, backoff_min_s=0.1, backoff_max_s=0.4)
    for _ in range(2000):
        assert not link.ready()
        clock.advance_ns(1_000_000)
    assert tries == [0, 100, 300, 700, 1100, 1500, 1900]
