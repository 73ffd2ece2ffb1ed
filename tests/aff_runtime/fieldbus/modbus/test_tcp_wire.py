from __future__ import annotations

import errno
import select
import socket
from types import SimpleNamespace

import pytest

from aff_runtime.base.errors import WireError
from aff_runtime.fieldbus.modbus import tcp_wire
from aff_runtime.fieldbus.modbus.byte_stream import CLOSED, Connecting
from aff_runtime.fieldbus.modbus.tcp_wire import TcpWire


def test_a_name_that_means_nothing_is_refused_at_start() -> None:
    with pytest.raises(WireError, match="cannot be resolved"):
        TcpWire("no such host", 502)


def test_an_unconnected_wire_is_closed_and_refuses() -> None:
    wire = TcpWire("127.0.0.1", 9)
    assert wire.connecting() is Connecting.FAILED
    assert not wire.send(b"x")
    assert wire.receive(memoryview(bytearray(4)), 10**9) == CLOSED
    wire.close(abort=False)


def test_an_address_without_a_route_fails_at_once() -> None:
    # TCP to the broadcast address is refused by the kernel itself
    wire = TcpWire("255.255.255.255", 9)
    assert wire.why_closed == ""
    assert wire.start_connect() is False
    assert wire.why_closed.startswith("255.255.255.255:9: ")


def test_no_free_descriptor_is_a_failed_attempt(monkeypatch: pytest.MonkeyPatch) -> None:
    def exhausted(*_arguments: object) -> socket.socket:
        raise OSError(errno.EMFILE, "Too many open files")

    wire = TcpWire("127.0.0.1", 9)
    monkeypatch.setattr(socket, "socket", exhausted)
    assert wire.start_connect() is False
    assert wire.why_closed == "127.0.0.1:9: Too many open files"


@pytest.mark.wire
def test_a_broken_descriptor_is_a_closed_connection() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        wire = TcpWire("127.0.0.1", server.getsockname()[1])
        assert wire.start_connect()
        raw = wire._socket
        assert raw is not None
        raw.close()
        assert not wire.send(b"x")
        assert wire.receive(memoryview(bytearray(4)), 0) == CLOSED
        wire.close(abort=True)


@pytest.mark.wire
def test_waits_are_never_rounded_up(monkeypatch: pytest.MonkeyPatch) -> None:
    waits: list[tuple[str, float]] = []

    def record_select(*arguments: object) -> tuple[list[int], list[int], list[int]]:
        waits.append(("s", arguments[3]))  # type: ignore[arg-type]
        return [], [], []

    with socket.create_server(("127.0.0.1", 0)) as server:
        wire = TcpWire("127.0.0.1", server.getsockname()[1])
        assert wire.start_connect()
        monkeypatch.setattr(
            wire, "_poll", SimpleNamespace(poll=lambda ms: waits.append(("ms", ms)))
        )
        monkeypatch.setattr(tcp_wire, "select", SimpleNamespace(select=record_select))
        into = memoryview(bytearray(4))
        for wait_ns in (2_999_999, 1_000_000, 999_000, 1_000):
            assert wire.receive(into, wait_ns) == 0
        assert wire.receive(into, 0) == 0
        wire.close(abort=True)
    assert [unit for unit, _ in waits] == ["ms", "ms", "s", "s"]
    assert [wait for _, wait in waits] == pytest.approx([2, 1, 0.000999, 1e-6], rel=1e-12)


@pytest.mark.wire
def test_the_socket_sends_small_frames_at_once() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        wire = TcpWire("127.0.0.1", server.getsockname()[1])
        assert wire.start_connect()
        raw = wire._socket
        assert raw is not None
        assert raw.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY) == 1
        assert raw.getblocking() is False
        wire.close(abort=True)


@pytest.mark.wire
@pytest.mark.parametrize("abort", [True, False])
def test_only_an_abort_resets_the_peer(abort: bool) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        wire = TcpWire("127.0.0.1", server.getsockname()[1])
        assert wire.start_connect()
        peer, _ = server.accept()
        with peer:
            assert wire.connecting() is Connecting.UP
            wire.close(abort=abort)
            peer.settimeout(5.0)
            if abort:
                with pytest.raises(ConnectionResetError):
                    peer.recv(1)
            else:
                assert peer.recv(1) == b""


@pytest.mark.wire
def test_a_refused_port_fails_the_attempt() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    wire = TcpWire("127.0.0.1", port)
    if wire.start_connect():
        raw = wire._socket
        assert raw is not None
        select.select((), (raw,), (), 5.0)
        assert wire.connecting() is Connecting.FAILED
    wire.close(abort=True)


@pytest.mark.wire
def test_a_port_joined_to_itself_is_no_connection() -> None:
    with socket.socket() as held:
        held.bind(("127.0.0.1", 0))
        port = held.getsockname()[1]
    wire = TcpWire("127.0.0.1", port)
    with socket.socket() as own:
        own.bind(("127.0.0.1", port))
        own.connect(("127.0.0.1", port))
        wire._socket = own
        assert wire.connecting() is Connecting.FAILED
        wire._socket = None
