"""Modbus RTU frames over TCP: golden bytes, faults on a real socket, and the way to zero."""

from __future__ import annotations

import contextlib
import socket
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import pytest
from pymodbus.framer import FramerRTU, FramerType
from pymodbus.server import ModbusTcpServer

from aff_runtime.base.errors import WireError
from aff_runtime.base.signals import Outcome, State
from aff_runtime.fieldbus.modbus.frames import WireFunction
from aff_runtime.fieldbus.modbus.rtu_tcp_wire import RtuTcpWire
from aff_runtime.fieldbus.modbus.transport import ModbusTransport
from tests.aff_runtime.app.fake_plc import Plc
from tests.aff_runtime.fieldbus.modbus.wire_client import (
    READ_COUNT,
    SHORT_NS,
    WORDS,
    KeepingServer,
    ask,
    client,
)
from tests.aff_runtime.fieldbus.modbus_bytes import register_reply
from tests.aff_runtime.fieldbus.runtime_at_work import ZERO_TICKS, Runtime, framed, site_on

pytestmark = pytest.mark.wire

Spoil = Callable[[bytes], Sequence[bytes]]


def with_crc(body: bytes) -> bytes:
    return body + FramerRTU.compute_CRC(body).to_bytes(2, "big")


def request_length(head: bytes) -> int:
    """Length of the serial request that begins so, by the application protocol; 0 too early."""
    if len(head) < 11:
        return 8 if head[1:2] == b"\3" else 0
    return 8 if head[1] == 3 else {16: 9, 23: 13}[head[1]] + head[{16: 6, 23: 10}[head[1]]]


class DeviceServer:
    """A device behind a serial device server; ``spoil`` cuts and changes what it sends."""

    def __init__(self, answer: Callable[[bytes], bytes]) -> None:
        self.answer, self.spoil = answer, whole
        self.requests: list[bytes] = []
        self.connects = 0
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._listener.settimeout(0.05)
        self.port: int = self._listener.getsockname()[1]
        self._on = True
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def __enter__(self) -> DeviceServer:
        return self

    def __exit__(self, *_error: object) -> None:
        self._on = False
        self._thread.join(5.0)
        self._listener.close()

    def _serve(self) -> None:
        while self._on:
            try:
                client, _ = self._listener.accept()
            except TimeoutError:
                continue
            self.connects += 1
            client.settimeout(0.05)
            with client, contextlib.suppress(OSError):
                self._talk(client)

    def _talk(self, client: socket.socket) -> None:
        buffer = b""
        while self._on:
            try:
                more = client.recv(512)
            except TimeoutError:
                continue
            if not more:
                return
            buffer += more
            while (length := request_length(buffer)) and len(buffer) >= length:
                request, buffer = buffer[:length], buffer[length:]
                assert with_crc(request[:-2]) == request
                self.requests.append(request)
                framed_request = bytes(4) + (length - 2).to_bytes(2, "big") + request[:-2]
                for piece in self.spoil(with_crc(self.answer(framed_request)[6:])):
                    client.sendall(piece)
                    time.sleep(0.001)  # a piece of its own for who reads


def whole(reply: bytes) -> Sequence[bytes]:
    return [reply]


def nothing(_reply: bytes) -> Sequence[bytes]:
    return []


def steady(request: bytes) -> bytes:
    return register_reply(request, [5] * READ_COUNT)


def ask_until(transport: ModbusTransport, wanted: Outcome) -> None:
    until = time.monotonic() + 10.0
    while ask(transport)[0] is not wanted:
        assert time.monotonic() < until
        time.sleep(0.001)


@contextlib.contextmanager
def heard(server: DeviceServer) -> Iterator[ModbusTransport]:
    """Give a client that was answered once."""
    transport = client(RtuTcpWire("127.0.0.1", server.port))
    ask_until(transport, Outcome.OK)
    yield transport
    transport.close()


def test_a_request_is_a_serial_frame_without_a_tcp_header() -> None:
    with DeviceServer(steady) as server, heard(server):
        first = server.requests[0]
    # device 1, FC23, read 15 from 0, write 10 to 100; then the CRC of another library
    assert first == with_crc(bytes.fromhex("01 17 0000 000f 0064 000a 14") + b"\0\7" * 10)


@pytest.mark.parametrize(
    "spoil",
    [
        lambda reply: [reply[:1], reply[1:]],
        lambda reply: [reply[:3], reply[3:-1], reply[-1:]],
        lambda reply: [reply[k : k + 1] for k in range(len(reply))],
    ],
    ids=["after a byte", "in three", "byte by byte"],
)
def test_a_reply_in_pieces_is_whole(spoil: Spoil) -> None:
    with DeviceServer(steady) as server, heard(server) as transport:
        server.spoil = spoil
        for _ in range(3):
            assert ask(transport) == (Outcome.OK, [5] * READ_COUNT)
        assert transport.connects == 1


@pytest.mark.parametrize(
    "spoil",
    [
        lambda reply: [reply[:-1] + bytes([reply[-1] ^ 1])],
        lambda reply: [reply[:4] + bytes([reply[4] ^ 1]) + reply[5:]],
        lambda reply: [reply[:-2]],
        lambda reply: [b"\x01\x63" + reply[2:]],
        lambda reply: [with_crc(b"\x02" + reply[1:-2])],
        lambda _reply: [b"\xff" * 600],
        nothing,
    ],
    ids=["crc", "a word", "cut", "function", "device", "noise", "nothing"],
)
def test_what_is_not_the_reply_is_none_and_the_next_one_counts(spoil: Spoil) -> None:
    with DeviceServer(steady) as server, heard(server) as transport:
        server.spoil = spoil
        outcomes = {ask(transport, SHORT_NS)[0] for _ in range(8)}
        assert Outcome.OK not in outcomes
        server.spoil = whole
        ask_until(transport, Outcome.OK)


def test_what_comes_unasked_before_a_request_is_thrown_away() -> None:
    with DeviceServer(steady) as server, heard(server) as transport:
        stale = with_crc(register_reply(bytes(6) + b"\1\x17", [9] * READ_COUNT)[6:])
        server.spoil = lambda reply: [reply, stale]
        for _ in range(5):
            assert ask(transport) == (Outcome.OK, [5] * READ_COUNT)
            time.sleep(0.01)  # what is unasked has come


def test_a_port_on_which_nobody_listens_is_named() -> None:
    with DeviceServer(steady) as server:
        port = server.port
    transport = client(RtuTcpWire("127.0.0.1", port))
    assert {ask(transport, SHORT_NS)[0] for _ in range(3)} == {Outcome.NOT_CONNECTED}
    assert transport.trouble == f"127.0.0.1:{port}: Connection refused"
    transport.close()


def test_a_name_that_means_nothing_is_refused_at_start() -> None:
    with pytest.raises(WireError, match="cannot be resolved"):
        RtuTcpWire("no such host", 4001)


def test_a_closed_wire_takes_and_gives_nothing() -> None:
    wire = RtuTcpWire("127.0.0.1", 9)
    assert not wire.send(bytes(12))
    assert wire.receive(memoryview(bytearray(4)), 0) == -1


def test_a_server_that_never_stops_talking_is_left() -> None:
    with DeviceServer(steady) as server, heard(server) as transport:
        server.spoil = lambda reply: [reply, b"\0" * 16_000]
        assert ask(transport)[0] is Outcome.OK
        time.sleep(0.05)
        assert ask(transport)[0] is not Outcome.OK
        server.spoil = whole
        ask_until(transport, Outcome.OK)
        assert transport.connects == 2


# --- another program ----------------------------------------------------------------------------


@pytest.mark.parametrize("function", [WireFunction.FC23, WireFunction.FC3_FC16])
def test_a_strange_server_understands_us_and_we_it(function: WireFunction) -> None:
    make = partial(ModbusTcpServer, framer=FramerType.RTU, address=("127.0.0.1", 0))
    with KeepingServer(make) as peer:
        transport = client(RtuTcpWire("127.0.0.1", peer.port), function)
        ask_until(transport, Outcome.OK)
        seen = [ask(transport) for _ in range(3)]
        transport.close()
    assert seen == [(Outcome.OK, list(range(READ_COUNT)))] * 3
    assert peer.writes == [WORDS] * len(peer.writes)
    assert len(peer.writes) >= 4


# --- the runtime on it --------------------------------------------------------------------------


@contextlib.contextmanager
def at_work(folder: Path) -> Iterator[tuple[Runtime, DeviceServer]]:
    plc = Plc()
    with DeviceServer(lambda request: framed(plc, request)) as server:
        runtime = Runtime(site_on("modbus_rtu_tcp", folder, server.port), plc)
        yield runtime, server
        runtime.gateway.close()


@pytest.mark.parametrize(
    "spoil",
    [nothing, lambda reply: [reply[:-1]], lambda reply: [b"\x01\x63" + reply[2:]]],
    ids=["nothing", "cut", "no function"],
)
def test_without_answers_it_goes_to_zero_and_stays_there(tmp_path: Path, spoil: Spoil) -> None:
    with at_work(tmp_path) as (runtime, server):
        assert runtime.is_working
        server.spoil = spoil
        runtime.run(ZERO_TICKS)
        assert runtime.is_zero
        server.spoil = whole
        runtime.run(150)
        assert (runtime.plc.words[3], runtime.plc.words[8]) == (0, 0)
        assert runtime.guard.state is State.FAULT
