"""Modbus over UDP on real datagrams: loss, delay, doubles, strangers, and the way to zero."""

from __future__ import annotations

import contextlib
import socket
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import pytest
from pymodbus.server import ModbusUdpServer

from aff_runtime.base.errors import WireError
from aff_runtime.base.signals import Outcome, State
from aff_runtime.fieldbus.modbus.frames import WireFunction
from aff_runtime.fieldbus.modbus.transport import ModbusTransport
from aff_runtime.fieldbus.modbus.udp_wire import UdpWire
from tests.aff_runtime.app.fake_plc import Plc
from tests.aff_runtime.fieldbus.modbus.wire_client import (
    READ_COUNT,
    SHORT_NS,
    WORDS,
    KeepingServer,
    ask,
    client,
)
from tests.aff_runtime.fieldbus.modbus_bytes import function_of, register_reply, tid_of
from tests.aff_runtime.fieldbus.runtime_at_work import ZERO_TICKS, Runtime, framed, site_on

pytestmark = pytest.mark.wire

Spoil = Callable[[bytes, bytes], Sequence[bytes]]


def intact(_request: bytes, reply: bytes) -> Sequence[bytes]:
    return [reply]


def lost(_request: bytes, _reply: bytes) -> Sequence[bytes]:
    return []


class Server:
    """A Modbus server on UDP in a thread; ``spoil`` makes the datagrams of an answer.

    ``requests`` holds every datagram that came, with the address it came from.
    """

    def __init__(self, answer: Callable[[bytes], bytes], spoil: Spoil = intact) -> None:
        self.answer, self.spoil = answer, spoil
        self.requests: list[tuple[bytes, tuple[str, int]]] = []
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.settimeout(0.05)
        self.port: int = self.socket.getsockname()[1]
        self._on = True
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def __enter__(self) -> Server:
        return self

    def __exit__(self, *_error: object) -> None:
        self._on = False
        self._thread.join(5.0)
        self.socket.close()

    def _serve(self) -> None:
        while self._on:
            try:
                request, sender = self.socket.recvfrom(2048)
            except TimeoutError:
                continue
            self.requests.append((request, sender))
            for datagram in self.spoil(request, self.answer(request)):
                self.socket.sendto(datagram, sender)


def naming(request: bytes) -> bytes:
    """A reply whose words name the request they answer."""
    return register_reply(request, [tid_of(request)] * READ_COUNT)


@contextlib.contextmanager
def heard(server: Server) -> Iterator[ModbusTransport]:
    """Give a client that was answered once."""
    transport = client(UdpWire("127.0.0.1", server.port))
    assert [ask(transport)[0] for _ in range(2)] == [Outcome.NOT_CONNECTED, Outcome.OK]
    yield transport
    transport.close()


def test_a_request_is_one_frame_in_one_datagram() -> None:
    with Server(naming) as server, heard(server):
        ((request, _),) = server.requests
    # MBAP: id 1, protocol 0, 31 bytes; device 1, FC23, read 15 from 0, write 10 to 100
    assert request == bytes.fromhex("0001 0000 001f 01 17 0000 000f 0064 000a 14") + b"\0\7" * 10


def test_a_lost_datagram_costs_its_tick_alone() -> None:
    with Server(naming) as server, heard(server) as transport:
        server.spoil = lost
        assert ask(transport, SHORT_NS)[0] is Outcome.TIMEOUT
        server.spoil = intact
        asked = len(server.requests)
        assert ask(transport) == (Outcome.OK, [tid_of(server.requests[asked][0])] * READ_COUNT)
        assert transport.connects == 1


def test_a_late_datagram_is_never_the_answer_to_a_later_question() -> None:
    late: list[bytes] = []

    def one_behind(_request: bytes, reply: bytes) -> Sequence[bytes]:
        late.append(reply)
        return late[-2:-1]

    with Server(naming) as server, heard(server) as transport:
        server.spoil = one_behind
        assert {ask(transport, SHORT_NS // 5)[0] for _ in range(3)} == {Outcome.TIMEOUT}
        server.spoil = lambda request, reply: [*late[-3:], *intact(request, reply)]
        for _ in range(3):
            assert ask(transport) == (Outcome.OK, [tid_of(server.requests[-1][0])] * READ_COUNT)


def test_doubled_datagrams_are_taken_once_each() -> None:
    with Server(naming, lambda _request, reply: [reply] * 3) as server, heard(server) as transport:
        for _ in range(20):
            assert ask(transport) == (Outcome.OK, [tid_of(server.requests[-1][0])] * READ_COUNT)
        assert len(server.requests) == 21
        assert transport.connects == 1


BROKEN: dict[str, Spoil] = {
    "id": lambda _, reply: [(tid_of(reply) + 1000).to_bytes(2, "big") + reply[2:]],
    "id 0": lambda _, reply: [b"\0\0" + reply[2:]],
    "protocol": lambda _, reply: [reply[:2] + b"\0\1" + reply[4:]],
    "cut": lambda _, reply: [reply[:-1]],
    "halves": lambda _, reply: [reply[:20], reply[20:]],
    "longer": lambda _, reply: [reply + b"\0"],
    "two in one": lambda _, reply: [reply * 2],
    "too long": lambda _, reply: [reply[:4] + b"\x04\x00" + bytes(1024)],
    "empty": lambda _, reply: [b""],
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_datagram_that_is_not_the_reply_is_nothing(name: str) -> None:
    with Server(naming) as server, heard(server) as transport:
        server.spoil = BROKEN[name]
        assert ask(transport, SHORT_NS) == (Outcome.TIMEOUT, [])
        server.spoil = lambda request, reply: [*BROKEN[name](request, reply), reply]
        assert ask(transport)[0] is Outcome.OK
        assert transport.connects == 1


def test_a_datagram_from_another_port_is_nothing() -> None:
    with (
        Server(naming) as server,
        heard(server) as transport,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger,
    ):

        def forged(request: bytes, reply: bytes) -> Sequence[bytes]:
            stranger.sendto(register_reply(request, [9] * READ_COUNT), server.requests[-1][1])
            return [reply]

        server.spoil = forged
        for _ in range(5):
            assert ask(transport) == (Outcome.OK, [tid_of(server.requests[-1][0])] * READ_COUNT)
        server.spoil = lambda request, reply: forged(request, reply)[:0]
        assert ask(transport, SHORT_NS) == (Outcome.TIMEOUT, [])


def test_after_a_silence_a_new_socket_only_reads_until_it_is_answered() -> None:
    with Server(naming) as server, heard(server) as transport:
        server.spoil = lost
        while ask(transport, SHORT_NS)[0] is not Outcome.NOT_CONNECTED:
            pass
        assert transport.trouble == "no reply within 0.05 s"
        before = len(server.requests)
        server.spoil = intact
        while ask(transport)[0] is not Outcome.OK:
            time.sleep(0.001)
        (again,) = server.requests[before:]
        assert function_of(again[0]) == 3
        assert again[1] != server.requests[0][1]
        assert ask(transport)[0] is Outcome.OK
        assert function_of(server.requests[-1][0]) == 23


def test_a_port_on_which_nobody_listens_is_named() -> None:
    with Server(naming) as server:
        port = server.port
    transport = client(UdpWire("127.0.0.1", port))
    outcomes = [ask(transport, SHORT_NS)[0] for _ in range(3)]
    assert set(outcomes) == {Outcome.NOT_CONNECTED}
    assert transport.trouble == f"127.0.0.1:{port}/udp: Connection refused"
    transport.close()


def test_a_name_that_means_nothing_is_refused_at_start() -> None:
    with pytest.raises(WireError, match="cannot be resolved"):
        UdpWire("no such host", 502)


def test_a_closed_wire_takes_and_gives_nothing() -> None:
    wire = UdpWire("127.0.0.1", 9)
    assert not wire.send(b"x")
    assert wire.receive(memoryview(bytearray(4)), 0) == -1


# --- another program ----------------------------------------------------------------------------


@pytest.mark.parametrize("function", [WireFunction.FC23, WireFunction.FC3_FC16])
def test_a_strange_server_understands_us_and_we_it(function: WireFunction) -> None:
    with KeepingServer(partial(ModbusUdpServer, address=("127.0.0.1", 0))) as peer:
        transport = client(UdpWire("127.0.0.1", peer.port), function)
        seen = [ask(transport) for _ in range(4)]
        transport.close()
    assert seen[1:] == [(Outcome.OK, list(range(READ_COUNT)))] * 3
    assert peer.writes == [WORDS] * 3


# --- the runtime on it --------------------------------------------------------------------------


@contextlib.contextmanager
def at_work(folder: Path) -> Iterator[tuple[Runtime, Server]]:
    plc = Plc()
    with Server(lambda request: framed(plc, request)) as server:
        runtime = Runtime(site_on("modbus_udp", folder, server.port), plc)
        yield runtime, server
        runtime.gateway.close()


def every_other(spoil: Spoil) -> Spoil:
    return lambda request, reply: (spoil if tid_of(request) % 2 else intact)(request, reply)


@pytest.mark.parametrize(
    "spoil",
    [every_other(lost), every_other(BROKEN["id"]), lambda _, reply: [reply, reply]],
    ids=["half of them lost", "half of them foreign", "all doubled"],
)
def test_a_correction_survives_a_bad_network(tmp_path: Path, spoil: Spoil) -> None:
    with at_work(tmp_path) as (runtime, server):
        server.spoil = spoil
        runtime.run(50)
        assert runtime.is_working


@pytest.mark.parametrize("spoil", [lost, BROKEN["id"], BROKEN["cut"]], ids=["lost", "id", "cut"])
def test_without_answers_it_goes_to_zero_and_stays_there(tmp_path: Path, spoil: Spoil) -> None:
    with at_work(tmp_path) as (runtime, server):
        server.spoil = spoil
        asked = len(server.requests)
        runtime.run(ZERO_TICKS)
        assert runtime.is_zero
        runtime.run(150)
        written = [r for r, _ in server.requests[asked:] if function_of(r) == 23]
        assert len(written) <= 5  # 50 ms without an answer; from then on it only reads
        server.spoil = intact
        runtime.run(150)
        assert runtime.gateway.troubles == ()
        assert (runtime.plc.words[3], runtime.plc.words[8]) == (0, 0)
        assert runtime.guard.state is State.FAULT
