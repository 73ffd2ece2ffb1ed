"""Every fault of the wire, over a real socket against a server that commits it."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Callable

import pytest

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus.frames import ModbusFrames, WireFunction
from aff_runtime.fieldbus.modbus.tcp_wire import TcpWire
from aff_runtime.fieldbus.modbus.transport import ModbusTransport
from tests.aff_runtime.fieldbus.modbus_bytes import (
    exception_reply,
    function_of,
    register_reply,
    tid_of,
    write_reply,
)
from tests.aff_runtime.fieldbus.scripted_server import ScriptedServer, reset

pytestmark = pytest.mark.wire

GENEROUS_NS = 2_000_000_000  # for replies that must come, on a busy machine
SHORT_NS = 15_000_000  # for replies that must not
READ_COUNT = 20
REPLY_BYTES = 9 + 2 * READ_COUNT
PATIENCE = 2000


def words_of(request: bytes) -> list[int]:
    return [tid_of(request)] * READ_COUNT


def good(client: socket.socket, request: bytes) -> None:
    if function_of(request) == 16:
        client.sendall(write_reply(request))
    else:
        client.sendall(register_reply(request, words_of(request)))


def silent(_client: socket.socket, _request: bytes) -> None:
    return


class Rig:
    def __init__(self, port: int, function: WireFunction = WireFunction.FC23) -> None:
        frames = ModbusFrames(
            device_id=3, read_start=0, read_count=READ_COUNT, write_start=100, write_count=2
        )
        self.clock = MonotonicClock()
        self.wire = TcpWire("127.0.0.1", port)
        self.transport = ModbusTransport(
            frames=frames,
            wire=self.wire,
            clock=self.clock,
            function=function,
            silence_before_reconnect_s=0.02,
            backoff_min_s=0.01,
            backoff_max_s=0.05,
        )

    def tick(self, wait_ns: int = GENEROUS_NS) -> tuple[Outcome, list[int]]:
        return self.transport.transact([1, 2], self.clock.now_ns() + wait_ns)

    def until(self, wanted: Outcome, wait_ns: int = GENEROUS_NS) -> tuple[Outcome, list[int]]:
        for _ in range(PATIENCE):
            result = self.tick(wait_ns)
            if result[0] is wanted:
                return result
            time.sleep(0.001)
        pytest.fail(f"never {wanted.name}")

    def arrived(self) -> bytes | None:
        """What the kernel holds for us: bytes, b"" for the end, None for nothing."""
        raw = self.wire._socket
        assert raw is not None
        try:
            return raw.recv(4096, socket.MSG_PEEK)
        except BlockingIOError:
            return None


@pytest.fixture
def server():
    with ScriptedServer(good) as running:
        yield running


@pytest.fixture
def rig(server: ScriptedServer):
    made = Rig(server.port)
    made.until(Outcome.OK)
    yield made
    made.transport.close()


def answers_itself(rig: Rig, server: ScriptedServer) -> bool:
    """One more tick is answered with the words of its own request."""
    outcome, words = rig.tick()
    return outcome is Outcome.OK and words == words_of(server.requests[-1])


def recovers(rig: Rig, server: ScriptedServer) -> bool:
    server.respond = good
    _, words = rig.until(Outcome.OK)
    return words == words_of(server.requests[-1]) and answers_itself(rig, server)


def wait_for(condition: Callable[[], bool]) -> None:
    for _ in range(PATIENCE):
        if condition():
            return
        time.sleep(0.001)
    pytest.fail("never happened")


def test_a_silent_server_gets_one_request_then_a_reset_then_a_new_connection(
    rig: Rig, server: ScriptedServer
) -> None:
    server.respond = silent
    before = len(server.requests)
    assert rig.tick(SHORT_NS)[0] is Outcome.TIMEOUT
    rig.until(Outcome.NOT_CONNECTED, SHORT_NS)
    wait_for(lambda: server.resets == 1)
    assert len(server.requests) == before + 1
    assert recovers(rig, server)
    assert rig.transport.connects == 2


def test_a_reset_is_seen_at_once(rig: Rig, server: ScriptedServer) -> None:
    server.respond = lambda client, _request: reset(client)
    assert rig.tick()[0] is Outcome.NOT_CONNECTED
    assert recovers(rig, server)


def test_a_close_is_seen_at_once(rig: Rig, server: ScriptedServer) -> None:
    server.respond = lambda client, _request: client.shutdown(socket.SHUT_RDWR)
    assert rig.tick()[0] is Outcome.NOT_CONNECTED
    assert recovers(rig, server)


def test_a_close_between_ticks_sends_nothing(rig: Rig, server: ScriptedServer) -> None:
    def answer_and_close(client: socket.socket, request: bytes) -> None:
        good(client, request)
        client.shutdown(socket.SHUT_RDWR)

    server.respond = answer_and_close
    assert rig.tick()[0] is Outcome.OK
    seen = len(server.requests)
    wait_for(lambda: rig.arrived() == b"")
    assert rig.tick()[0] is Outcome.NOT_CONNECTED
    assert len(server.requests) == seen
    assert recovers(rig, server)


def test_a_half_open_connection_is_given_up() -> None:
    # the kernel completes the handshake and takes our bytes; nobody will ever read them
    with socket.create_server(("127.0.0.1", 0)) as listener:
        rig = Rig(listener.getsockname()[1])
        assert rig.tick()[0] is Outcome.NOT_CONNECTED
        rig.until(Outcome.TIMEOUT, SHORT_NS)
        rig.until(Outcome.NOT_CONNECTED, SHORT_NS)
        rig.until(Outcome.TIMEOUT, SHORT_NS)
        assert rig.transport.connects == 2
        rig.transport.close()


def test_a_late_reply_is_never_a_later_answer(rig: Rig, server: ScriptedServer) -> None:
    release, sent = threading.Event(), threading.Event()

    def late(client: socket.socket, request: bytes) -> None:
        release.wait(5.0)
        good(client, request)
        server.respond = good
        sent.set()

    server.respond = late
    assert [rig.tick(SHORT_NS)[0] for _ in range(2)] == [Outcome.TIMEOUT] * 2
    release.set()
    assert sent.wait(5.0)
    wait_for(lambda: len(rig.arrived() or b"") == REPLY_BYTES)
    assert answers_itself(rig, server)
    assert rig.transport.connects == 1


def test_a_duplicated_reply_changes_nothing(rig: Rig, server: ScriptedServer) -> None:
    def twice(client: socket.socket, request: bytes) -> None:
        good(client, request)
        good(client, request)

    server.respond = twice
    assert all(answers_itself(rig, server) for _ in range(10))
    assert rig.transport.connects == 1


def test_half_a_reply_is_completed_later_and_discarded(rig: Rig, server: ScriptedServer) -> None:
    release, sent = threading.Event(), threading.Event()

    def halves(client: socket.socket, request: bytes) -> None:
        reply = register_reply(request, words_of(request))
        client.sendall(reply[:17])
        release.wait(5.0)
        client.sendall(reply[17:])
        server.respond = good
        sent.set()

    server.respond = halves
    assert rig.tick(SHORT_NS)[0] is Outcome.TIMEOUT
    release.set()
    assert sent.wait(5.0)
    wait_for(lambda: len(rig.arrived() or b"") == REPLY_BYTES - 17)
    assert answers_itself(rig, server)
    assert rig.transport.connects == 1


def test_half_a_reply_that_stays_half_ends_with_its_connection(
    rig: Rig, server: ScriptedServer
) -> None:
    server.respond = lambda client, request: client.sendall(
        register_reply(request, words_of(request))[:17]
    )
    assert rig.tick(SHORT_NS)[0] is Outcome.TIMEOUT
    rig.until(Outcome.NOT_CONNECTED, SHORT_NS)
    assert recovers(rig, server)


LIES: dict[str, Callable[[bytes], bytes]] = {
    "too few registers": lambda q: register_reply(q, words_of(q)[:2]),
    "too many registers": lambda q: register_reply(q, [*words_of(q), 0]),
    "wrong byte count": lambda q: register_reply(q, words_of(q), byte_count=4),
    "wrong tid": lambda q: register_reply(q, words_of(q), tid=tid_of(q) ^ 0x5555),
    "next tid": lambda q: register_reply(q, words_of(q), tid=tid_of(q) + 1),
    "wrong protocol id": lambda q: register_reply(q, words_of(q), protocol=1),
    "wrong device id": lambda q: register_reply(q, words_of(q), device_id=4),
    "length beyond any frame": lambda q: q[:4] + b"\xff\xff" + bytes(100),
    "another function": lambda q: register_reply(q[:7] + b"\x03" + q[8:], words_of(q)),
    "not Modbus": lambda q: b"HTTP/1.1 400 Bad Request\r\n\r\n",
}


@pytest.mark.parametrize("lie", LIES)
def test_a_breach_of_protocol_gives_no_words_and_a_new_connection(
    rig: Rig, server: ScriptedServer, lie: str
) -> None:
    server.respond = lambda client, request: client.sendall(LIES[lie](request))
    assert rig.tick() == (Outcome.BAD_REPLY, [])
    assert recovers(rig, server)
    assert rig.transport.connects == 2


def test_a_busy_device_is_an_exception_and_no_reason_to_reconnect(
    rig: Rig, server: ScriptedServer
) -> None:
    server.respond = lambda client, request: client.sendall(exception_reply(request, 6))
    assert [rig.tick() for _ in range(5)] == [(Outcome.EXCEPTION, [])] * 5
    assert rig.transport.last_exception_code == 6
    assert recovers(rig, server)
    assert rig.transport.connects == 1


def test_a_reply_in_two_segments_with_nagle_on_is_in_time(server: ScriptedServer) -> None:
    # without TCP_QUICKACK the second segment waits for our delayed acknowledgement, 40 ms
    def segments(client: socket.socket, request: bytes) -> None:
        client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 0)
        reply = register_reply(request, words_of(request))
        client.sendall(reply[:9])
        client.sendall(reply[9:])

    server.respond = segments
    rig = Rig(server.port)
    rig.until(Outcome.OK)
    outcomes = []
    for _ in range(40):
        outcomes.append(rig.tick(30_000_000)[0])
        time.sleep(0.002)
    rig.transport.close()
    assert outcomes.count(Outcome.OK) >= 30


@pytest.mark.parametrize("function", list(WireFunction))
def test_a_restarted_server_is_found_again(function: WireFunction) -> None:
    first = ScriptedServer(good)
    rig = Rig(first.port, function)
    rig.until(Outcome.OK)
    first.stop()
    assert rig.tick()[0] is Outcome.NOT_CONNECTED
    assert {rig.tick()[0] for _ in range(200)} == {Outcome.NOT_CONNECTED}
    with ScriptedServer(good, port=first.port) as second:
        _, words = rig.until(Outcome.OK)
        assert words == words_of(second.requests[-1])
        rig.transport.close()


def test_no_server_at_all_is_not_connected_for_as_long_as_it_takes() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
    rig = Rig(port)
    assert {rig.tick()[0] for _ in range(100)} == {Outcome.NOT_CONNECTED}
    rig.transport.close()
