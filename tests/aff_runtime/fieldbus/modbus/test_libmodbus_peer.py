"""Against libmodbus, the C library: real bytes over a TCP socket and over a serial line (pty)."""

from __future__ import annotations

import os
import shutil
import subprocess
import threading
import tty
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.ports import WordTransport
from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus.connections import modbus, rtu_wire, tcp_wire
from aff_runtime.fieldbus.modbus.frames import WireFunction
from tests.aff_runtime.fieldbus.euclid_map import euclid_map

SOURCE = Path(__file__).with_name("libmodbus_server.c")
WORDS = [59, 4, 0, 100, 65435, 0, 5000, 48879, 65436, 99]
TICKS = 40


def why_not() -> str:
    if shutil.which("gcc") is None:
        return "gcc is not installed"
    asked = "#include <modbus/modbus.h>\n"
    found = subprocess.run(
        ["gcc", "-E", "-xc", "-"], input=asked, capture_output=True, text=True, check=False
    )
    return "" if found.returncode == 0 else "libmodbus is not installed (Debian: libmodbus-dev)"


pytestmark = [pytest.mark.wire, pytest.mark.skipif(bool(why_not()), reason=why_not())]


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    built = tmp_path_factory.mktemp("libmodbus") / "server"
    subprocess.run(["gcc", "-O1", "-o", built, SOURCE, "-lmodbus"], check=True)
    return built


class Peer:
    """The C program, what it printed, and where it is reached."""

    def __init__(self, command: list[str]) -> None:
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        assert self.process.stdout is not None
        self.port = int(self.process.stdout.readline().split()[1])
        self.written: list[list[int]] = []
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.written.append([int(word) for word in line.split()])

    def close(self) -> None:
        self.process.kill()
        self.process.wait(10)
        self._reader.join(10)
        assert self.process.stdout is not None
        self.process.stdout.close()


@pytest.fixture
def tcp(program: Path) -> Iterator[Peer]:
    peer = Peer([str(program), "tcp"])
    yield peer
    peer.close()


class Line:
    """Two ptys joined back to back: a serial line with a device at each end."""

    def __init__(self) -> None:
        pairs = [os.openpty() for _ in range(2)]
        self.masters = [master for master, _ in pairs]
        self.slaves = [slave for _, slave in pairs]
        for slave in self.slaves:
            tty.setraw(slave)
        self.paths = [os.ttyname(slave) for slave in self.slaves]
        ways = (self.masters, self.masters[::-1])
        self._pumps = [threading.Thread(target=self._pump, args=way) for way in ways]
        for pump in self._pumps:
            pump.start()

    @staticmethod
    def _pump(source: int, sink: int) -> None:
        while True:
            try:
                got = os.read(source, 512)
            except OSError:  # the other end of this pty was closed
                return
            if got.endswith(b"\x04END"):
                return
            os.write(sink, got)

    def close(self) -> None:
        for slave in self.slaves:
            os.write(slave, b"\x04END")
        for pump in self._pumps:
            pump.join(5)
        for descriptor in (*self.masters, *self.slaves):
            os.close(descriptor)


@pytest.fixture
def rtu(program: Path) -> Iterator[tuple[Peer, str]]:
    line = Line()
    peer = Peer([str(program), "rtu", line.paths[1]])
    yield peer, line.paths[0]
    peer.close()
    line.close()


def exchange(transport: WordTransport, ticks: int = TICKS) -> list[tuple[Outcome, list[int]]]:
    clock = MonotonicClock()
    seen = []
    for _ in range(ticks):
        seen.append(transport.transact(WORDS, clock.now_ns() + 500_000_000))
        clock.sleep_until_ns(clock.now_ns() + 1_000_000)
    transport.close()
    return seen


def judge(seen: list[tuple[Outcome, list[int]]], peer: Peer) -> None:
    outcomes = [outcome for outcome, _ in seen]
    good = [words for outcome, words in seen if outcome is Outcome.OK]
    assert set(outcomes) == {Outcome.NOT_CONNECTED, Outcome.OK}
    assert len(good) > TICKS // 2
    assert all(words[1:] == [3 * n for n in range(1, 15)] for words in good)
    steps = [(b[0] - a[0]) & 0xFFFF for a, b in pairwise(good)]
    assert set(steps) in ({1}, {2})  # requests per tick
    assert peer.written
    assert all(words == WORDS for words in peer.written)


FUNCTIONS = [WireFunction.FC23, WireFunction.FC3_FC16]


def over_tcp(peer: Peer, function: WireFunction, **changes: object) -> WordTransport:
    return modbus(
        tcp_wire("127.0.0.1", peer.port),
        device_id=1,
        register_map=euclid_map(**changes),
        clock=MonotonicClock(),
        function=function,
    )


@pytest.mark.parametrize("function", FUNCTIONS)
def test_words_go_both_ways_over_tcp(tcp: Peer, function: WireFunction) -> None:
    judge(exchange(over_tcp(tcp, function)), tcp)


@pytest.mark.parametrize("function", FUNCTIONS)
def test_words_go_both_ways_over_a_serial_line(
    rtu: tuple[Peer, str], function: WireFunction
) -> None:
    peer, path = rtu
    transport = modbus(
        rtu_wire(path, baud=115_200, parity="none", stop_bits=1),
        device_id=1,
        register_map=euclid_map(),
        clock=MonotonicClock(),
        function=function,
    )
    judge(exchange(transport), peer)


@pytest.mark.parametrize("function", FUNCTIONS)
def test_a_register_it_does_not_have_is_an_exception_and_never_a_value(
    tcp: Peer, function: WireFunction
) -> None:
    transport = over_tcp(tcp, function, plc_heartbeat=500, status=501, roll_id=502, channels=())
    seen = exchange(transport, 10)
    assert {outcome for outcome, _ in seen} == {Outcome.NOT_CONNECTED, Outcome.EXCEPTION}
    assert all(words == [] for _, words in seen)


def test_a_server_that_dies_and_comes_back_is_reached_again(program: Path) -> None:
    first = Peer([str(program), "tcp"])
    transport, clock = over_tcp(first, WireFunction.FC23), MonotonicClock()

    def until(wanted: Callable[[Outcome], bool]) -> None:
        for _ in range(3000):
            if wanted(transport.transact(WORDS, clock.now_ns() + 500_000_000)[0]):
                return
            clock.sleep_until_ns(clock.now_ns() + 2_000_000)
        raise AssertionError("never")

    until(lambda outcome: outcome is Outcome.OK)
    first.close()
    until(lambda outcome: outcome is Outcome.NOT_CONNECTED)
    transport.close()
