"""A site file that setup wrote from DBC or EDS files, at work on the simulated PLC's real bus."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from aff_runtime.app.wiring.site_to_guard import guard_params
from aff_runtime.app.wiring.wires import gateway_of
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.signals import State
from aff_runtime.cli.main import main
from aff_runtime.config.can_wire import wire_files
from aff_runtime.config.loader import load_site
from aff_runtime.loop.cycle import Cycle, CycleSettings
from aff_runtime.loop.messages import Arm
from aff_runtime.safety.guard import Guard
from sim_plant.servers.serve import PlantService, ServeOptions
from tests.aff_runtime.app.setup.bus_answers import CONFIG, begun
from tests.aff_runtime.fieldbus.runtime_at_work import Steady
from tests.aff_runtime.loop.rig import Memory
from tests.sim_plant.servers.fake_line import FakeLine, default_map

pytestmark = pytest.mark.wire
PATIENCE_S = 60.0
WISH = 1000  # counts of 0.00001 m/s: the 0.01 m/s that the law asks for


@pytest.fixture(params=["dbc", pytest.param("canopen", marks=pytest.mark.long)])
def plant(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[tuple[str, PlantService]]:
    """The simulated PLC on a unix bus, in real time."""
    ready = threading.Event()
    options = ServeOptions(
        can=request.param,
        can_interface="frame_socket",
        can_channel=str(tmp_path / "can"),
        can_map=CONFIG / "plc" / f"can_{request.param}.yaml",
        realtime=False,
    )
    running: list[tuple[PlantService, asyncio.AbstractEventLoop]] = []

    async def serve() -> None:
        service = PlantService(FakeLine(0.01), default_map(), options)
        running.append((service, asyncio.get_running_loop()))
        await service.run(lambda _: ready.set())

    thread = threading.Thread(target=asyncio.run, args=(serve(),))
    thread.start()
    assert ready.wait(PATIENCE_S)
    service, loop = running[0]
    yield request.param, service
    loop.call_soon_threadsafe(service.stop)
    thread.join(PATIENCE_S)
    assert not thread.is_alive()


def written(protocol: str, folder: Path) -> Path:
    """Have setup write the site file, listening to the bus; patient for a busy machine."""
    bus = {"interface": "frame_socket", "channel": str(folder / "can")}
    assert main(begun(folder, protocol, listen="yes", scan_ms="20", **bus)) == 0
    path = folder / "site.yaml"
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("fault_after_ms: 80", "fault_after_ms: 140"), encoding="utf-8")
    return path


def test_the_plant_takes_the_corrections_of_the_written_site(
    plant: tuple[str, PlantService], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    protocol, service = plant
    path = written(protocol, tmp_path)
    said = capsys.readouterr()
    if protocol == "dbc":  # CANopen nodes are silent until the service starts them
        assert "PLC_STATUS.PlcHeartbeat: 16 bits unsigned, no unit, 0 to 65535, now" in said.out
        assert "PLC_TENSION.UnwindTension: 24 bits signed, factor 0.001, unit N" in said.out
    else:
        assert "no frame of the files came" in said.err
    site = load_site(path)
    clock = MonotonicClock()
    params, channels = guard_params(site), tuple(site.gateway.read.channels)
    soft = tuple(replace(one, soft_start_s=0.1) for one in params.actuators)
    guard = Guard(replace(params, actuators=soft))
    outside = Memory(guard)
    settings = CycleSettings(
        period_ns=round(site.cycle_s * 1e9),
        io_budget_ns=round(site.gateway.deadline_ms * 1e6),
        fade_s=params.fade_s,
        channel_count=len(channels),
        output_count=2,
        law_columns=0,
    )
    gateway = gateway_of(site, wire_files(site, tmp_path), clock)
    cycle = Cycle(
        settings=settings, clock=clock, gateway=gateway, guard=guard, law=Steady(), outside=outside
    )
    plc = service.plant.plc.map
    at = [one.item.address - plc.write_start for one in plc.corrections]
    give_up = time.monotonic() + PATIENCE_S
    try:
        while time.monotonic() < give_up:
            outside.inbox.append(Arm())
            for _ in range(25):
                cycle.tick()
            words = service.plant.registers.write_words
            if guard.state is State.ACTIVE and [words[one] for one in at] == [WISH, WISH]:
                return
        pytest.fail(f"not at work: {guard.state} {outside.reasons}")
    finally:
        gateway.close()
