"""Modbus/TCP Security with certificates made for the test."""

from __future__ import annotations

import shutil
import socket
import ssl
import subprocess
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus.connections import modbus
from aff_runtime.fieldbus.modbus.tls_wire import TlsWire, client_context
from sim_plant.servers.modbus_device import ModbusDevice
from sim_plant.servers.registers import Registers
from tests.aff_runtime.fieldbus.euclid_map import euclid_map
from tests.sim_plant.servers.fake_line import default_map

pytestmark = [
    pytest.mark.wire,
    pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl makes the certificates"),
]


def make_certificate(folder: Path, name: str) -> None:
    subprocess.run(
        [
            "openssl",
            "req",
            "-x509",
            "-newkey",
            "ec",
            "-pkeyopt",
            "ec_paramgen_curve:prime256v1",
            "-nodes",
            "-days",
            "60",
            "-subj",
            f"/CN={name}",
            "-addext",
            f"subjectAltName=DNS:{name}",
            "-keyout",
            folder / f"{name}.key",
            "-out",
            folder / f"{name}.pem",
        ],
        check=True,
        capture_output=True,
    )


class TlsServer:
    """One client at a time; frames as on plain Modbus TCP."""

    def __init__(self, folder: Path) -> None:
        self.context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        self.context.load_cert_chain(folder / "plc.pem", folder / "plc.key")
        self.context.load_verify_locations(folder / "aff.pem")
        self.context.verify_mode = ssl.CERT_REQUIRED
        self.registers = Registers(default_map())
        self.device = ModbusDevice(self.registers)
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.listener.settimeout(0.1)
        self.port = self.listener.getsockname()[1]
        self.on = True
        self.thread = threading.Thread(target=self.serve)
        self.thread.start()

    def serve(self) -> None:
        while self.on:
            try:
                raw, _ = self.listener.accept()
                raw.settimeout(0.5)
                with self.context.wrap_socket(raw, server_side=True) as client:
                    while self.on and (frame := client.recv(300)):
                        pdu = self.device.answer(frame[7:])
                        head = frame[:4] + (len(pdu) + 1).to_bytes(2, "big") + frame[6:7]
                        client.sendall(head + pdu)
            except OSError:
                continue

    def close(self) -> None:
        self.on = False
        self.thread.join(5)
        self.listener.close()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("plc", "aff", "stranger"):
        make_certificate(tmp_path, name)
    return tmp_path


@pytest.fixture
def server(folder: Path) -> Iterator[TlsServer]:
    running = TlsServer(folder)
    yield running
    running.close()


def outcomes(
    server: TlsServer, context: ssl.SSLContext, name: str = "plc", said: list[str] | None = None
) -> list[Outcome]:
    clock = MonotonicClock()
    transport = modbus(
        TlsWire("127.0.0.1", server.port, context, name),
        device_id=1,
        register_map=euclid_map(),
        clock=clock,
    )
    seen = []
    for _ in range(60):
        seen.append(transport.transact([9] * 10, clock.now_ns() + 300_000_000)[0])
        clock.sleep_until_ns(clock.now_ns() + 5_000_000)
        if said is not None:
            said.append(transport.trouble)
        if seen[-1] is Outcome.OK:
            break
    transport.close()
    return seen


def test_words_go_through_tls(folder: Path, server: TlsServer) -> None:
    context = client_context(folder / "plc.pem", folder / "aff.pem", folder / "aff.key")
    assert outcomes(server, context)[-1] is Outcome.OK
    assert server.registers.write_words == [9] * 10


def test_a_server_with_another_name_or_certificate_gets_nothing(
    folder: Path, server: TlsServer
) -> None:
    ours = (folder / "aff.pem", folder / "aff.key")
    wrong_name = client_context(folder / "plc.pem", *ours)
    said: list[str] = []
    assert set(outcomes(server, wrong_name, "other", said)) == {Outcome.NOT_CONNECTED}
    assert "TLS with other: " in said[-1]
    assert "Hostname mismatch" in said[-1]
    wrong_ca = client_context(folder / "stranger.pem", *ours)
    assert set(outcomes(server, wrong_ca)) == {Outcome.NOT_CONNECTED}
    assert server.registers.writes == 0


def test_without_our_certificate_the_plc_takes_nothing(folder: Path, server: TlsServer) -> None:
    context = client_context(folder / "plc.pem", None, None)
    assert Outcome.OK not in outcomes(server, context)
    assert server.registers.writes == 0


def test_a_missing_file_is_named(folder: Path) -> None:
    with pytest.raises(ConfigError, match=r"/nothing\.pem is not there"):
        client_context(folder / "nothing.pem", None, None)


def test_a_file_that_is_no_certificate_is_named_with_the_reason(folder: Path) -> None:
    rubbish = folder / "rubbish.pem"
    rubbish.write_text("no certificate")
    with pytest.raises(ConfigError, match=r"rubbish\.pem: no PEM files that fit \(.*certificate"):
        client_context(rubbish, None, None)
