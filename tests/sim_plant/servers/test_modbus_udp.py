"""The plant's Modbus on UDP, asked by hand and by the runtime's own client."""

from __future__ import annotations

import asyncio
import contextlib
import socket
import struct
from pathlib import Path

import pytest

from aff_runtime.base.errors import WireError
from aff_runtime.base.signals import StateBits
from aff_runtime.cli.main import main as aff_runtime
from sim_plant.cli.main import main as sim_plant
from sim_plant.servers.serve import PlantService, ServeOptions
from tests.aff_runtime.fieldbus.runtime_at_work import site_on
from tests.sim_plant.servers.fake_line import FakeLine, default_map, write_block
from tests.sim_plant.servers.served import served, wait_until

pytestmark = pytest.mark.wire

READ_2_FROM_0 = bytes.fromhex("0007 0000 0006 01 03 0000 0002")


def asked(port: int, datagram: bytes, wait_s: float = 5.0) -> list[bytes]:
    """Return the datagrams that come back; the first within ``wait_s``."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        client.connect(("127.0.0.1", port))
        client.settimeout(wait_s)
        client.send(datagram)
        back = []
        try:
            while True:
                back.append(client.recv(2048))
                client.settimeout(0.1)
        except TimeoutError:
            return back


def test_a_datagram_is_answered_by_one_with_its_transaction_id() -> None:
    with served(udp=True) as plant:
        (reply,) = asked(plant.port, READ_2_FROM_0)
        assert reply[:9] == bytes.fromhex("0007 0000 0007 01 03 04")
        assert len(reply) == 13


@pytest.mark.parametrize(
    "datagram",
    [
        READ_2_FROM_0[:-1],
        READ_2_FROM_0 + b"\0",
        READ_2_FROM_0 * 2,
        READ_2_FROM_0[:2] + b"\0\1" + READ_2_FROM_0[4:],
        READ_2_FROM_0[:7],
        b"",
    ],
    ids=["cut", "longer", "two", "protocol", "no function", "empty"],
)
@pytest.mark.sweep(every=3)
def test_what_is_no_whole_request_gets_no_answer(datagram: bytes) -> None:
    with served(udp=True) as plant:
        assert asked(plant.port, datagram, 0.2) == []
        assert plant.command("status")["counts"]["refused"] == 1


def test_a_doubled_answer_is_two_datagrams() -> None:
    with served(udp=True) as plant:
        plant.fault("double")
        first, second = asked(plant.port, READ_2_FROM_0)
        assert first == second


@pytest.mark.parametrize("fault", ["mute", "refuse", "restart=", "lose=100"])
def test_a_plc_that_is_not_there_does_not_answer(fault: str) -> None:
    with served(udp=True) as plant:
        plant.fault(fault.rstrip("=") + (":30" if fault.endswith("=") else ""))
        assert asked(plant.port, READ_2_FROM_0, 0.2) == []
        assert plant.command("clear")["ok"]
        for _ in range(50):
            if asked(plant.port, READ_2_FROM_0, 0.2):
                return
        pytest.fail("never again")


def test_half_of_the_datagrams_lost_each_way_leaves_a_quarter_of_the_answers() -> None:
    with served(udp=True) as plant, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        plant.fault("lose=50")
        client.connect(("127.0.0.1", plant.port))
        for _ in range(200):
            client.send(READ_2_FROM_0)
        wait_until(lambda: plant.command("status")["counts"]["lost"] > 120)
        client.settimeout(0.3)
        back = 0
        with contextlib.suppress(TimeoutError):
            while client.recv(2048):
                back += 1
    assert back == pytest.approx(50, abs=5 * (200 * 0.25 * 0.75) ** 0.5)


def command(heartbeat: int, unwind: int, state: int) -> bytes:
    """Return the FC16 frame that writes the runtime's block."""
    words = write_block(heartbeat, unwind=unwind, state=state)
    body = struct.pack(">BBHHB10H", 1, 16, 100, 10, 20, *words)
    return struct.pack(">HHH", heartbeat, 0, len(body)) + body


def test_a_command_that_a_newer_one_has_overtaken_ends_the_correction() -> None:
    with served(udp=True) as plant, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        client.connect(("127.0.0.1", plant.port))
        client.settimeout(5.0)

        def write(heartbeat: int, unwind: int, state: int = StateBits.ACTIVE) -> str:
            scans = plant.service.plant.scans
            client.send(command(heartbeat, unwind, state))
            assert client.recv(100)[7] == 16
            wait_until(lambda: plant.service.plant.scans >= scans + 2)
            return str(plant.command("status")["refusal"])

        for first in range(100, 2000, 20):  # a busy machine may trip the PLC's watchdog
            for beat in range(first, first + 3):
                write(beat, 0, StateBits.READY)
            if [write(beat, 300) for beat in range(first + 3, first + 5)] == ["", ""]:
                break
        assert plant.command("status")["applied_m_s"]["unwind"] == pytest.approx(0.003)
        assert write(first + 2, 500) != ""  # sent before, arrives after
        assert write(first + 5, 300) != ""  # latched until the runtime has stood at rest
        applied = plant.command("status")["applied_m_s"]["unwind"]
        assert abs(applied) <= 0.003
        wait_until(lambda: plant.command("status")["applied_m_s"]["unwind"] == 0.0)


def test_a_port_in_use_is_named() -> None:
    with served(udp=True) as plant:
        options = ServeOptions(port=plant.port, udp=True, realtime=False)

        async def second() -> None:
            await PlantService(FakeLine(), default_map(), options).run(print)

        with pytest.raises(WireError, match=f"cannot listen on 127.0.0.1:{plant.port}/udp"):
            asyncio.run(second())


def test_the_service_looks_at_its_words(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with served(udp=True) as plant:
        site_on("modbus_udp", tmp_path, plant.port)
        assert aff_runtime(["probe-map", str(tmp_path / "site.yaml")]) == 0
    assert "plc_heartbeat moves" in capsys.readouterr().out


def test_udp_is_no_way_of_can(capsys: pytest.CaptureFixture[str]) -> None:
    assert sim_plant(["serve", "line.yaml", "--udp", "--can", "dbc", "--channel", "x"]) != 0
    assert "--udp: it is a way of Modbus" in capsys.readouterr().err
