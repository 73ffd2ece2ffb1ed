"""Unusual plants from their words to a quiet web: setup, probe and law on the real line.

Setup's part is quick and tried for each in ``tests/aff_runtime/app/setup``; here the site file
that it wrote probes and corrects. Frames of Modbus on a virtual wire, minutes of simulated line.
"""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.app.wiring.site_to_law import probe_params, site_params
from aff_runtime.base.signals import State
from aff_runtime.config.identified_drive import with_identified
from aff_runtime.config.loader import load_site
from aff_runtime.config.models import Site
from aff_runtime.core.probe.probe import Probe, Stage
from aff_runtime.core.response import Provenance
from aff_runtime.loop.messages import Arm, Swap
from aff_runtime.loop.ports import Advice
from sim_plant.base.order_tracking import order_amplitudes
from sim_plant.servers.modbus_device import ModbusDevice
from tests.lockstep.bench import Bench, Setup, settled
from tests.lockstep.known_response import SPEED_M_S
from tests.lockstep.plants import PLANTS, FrameWire, Stand, UnusualPlant, gateway_on
from tests.lockstep.silent import watched

pytestmark = [pytest.mark.long, pytest.mark.timeout(900)]
ORDERS = (1, 2, 3, 4)
"""The largest of the shape that setup proposes to learn; nobody says anything of the drive."""
SILENT_S, ARMED_S, JUDGED_S = 15.0, 40.0, 20.0
QUIETER = 0.1
FLOOR_N = 0.05


def at_the_wire(plant: UnusualPlant, line: Path, plc: Path, site_file: Path, **more) -> Bench:
    """Return runtime and line with real frames between them."""
    bench = Bench(Setup(line=line, site=site_file, plc_map=plc, **more))
    device = ModbusDevice(bench.plant.registers, allow_fc23=plant.fc23)
    wire = FrameWire(bench._transport.live, device, bench.plant.faults, bench.clock)
    bench.cycle = bench._cycle(gateway_on(wire, load_site(site_file), bench.clock))
    return bench


def ripple_N(rows: list[tuple[float, ...]]) -> np.ndarray:
    """Return the unwind's orders in the true tension of its web."""
    unwind_N, _, unwind_rad, follower_rad = np.array(rows).T
    return np.abs(order_amplitudes(unwind_N, unwind_rad, ORDERS, {"f": follower_rad}))


@dataclass(frozen=True)
class Commissioned:
    """What came of it."""

    site: Site
    unasked: list[str]
    before_N: np.ndarray
    after_N: np.ndarray
    state: State
    said: str


def commissioned(plant: UnusualPlant, folder: Path) -> Commissioned:
    """Let setup write a site file, probe on it, arm."""
    line = plant.line_file(folder)
    stand = Stand(plant, deepcopy(settled(line, SPEED_M_S)), folder)
    site_file, plc = folder / "site.yaml", folder / "plc.yaml"
    technician = stand.commission(site_file)
    site = load_site(site_file)

    bench = at_the_wire(plant, line, plc, site_file)
    probe = Probe(site_params(site), probe_params(site, tuple(site.actuators)))
    bench.run(0.5)
    bench.outside.advise = lambda _: Advice()  # type: ignore[method-assign]
    for said in (Swap(law=probe), Arm()):
        bench.say(said)
    bench.run(probe.expected_s + 3.0)
    assert probe.stage is Stage.DONE, (probe.reason, bench.outside.blocked_by)
    about = {
        name: Provenance(actuator=name, signal=row.error.signal, cycle_s=site.cycle_s)
        for name, row in site.actuators.items()
    }
    responses = {
        found.response.provenance.actuator: found.response for found in probe.result(about)
    }

    whole, _ = with_identified(site, responses)
    law = site_params(whole)
    bench = at_the_wire(plant, line, plc, site_file, responses=responses, law=law)
    rows = watched(bench)
    bench.run(1.0)
    rows.clear()
    bench.run(SILENT_S)
    before_N = ripple_N(rows)
    bench.say(Arm())
    bench.run(ARMED_S)
    rows.clear()
    bench.run(JUDGED_S)
    return Commissioned(
        site=site,
        unasked=technician.unasked,
        before_N=before_N,
        after_N=ripple_N(rows),
        state=bench.guard.state,
        said=bench.outside.blocked_by,
    )


@pytest.mark.parametrize("name", PLANTS)
def test_an_unusual_plant_gets_to_a_quiet_web(name: str, tmp_path: Path) -> None:
    found = commissioned(PLANTS[name], tmp_path)
    assert found.state is State.ACTIVE, found.said
    unwind = found.site.actuators["unwind"].blocks
    corrected = {order for block in unwind if block.roll == "unwind" for order in block.orders}
    assert corrected >= {1, 2}
    for order, before, after in zip(ORDERS, found.before_N, found.after_N, strict=True):
        if order not in corrected:  # without an encoder setup proposes no shape
            continue
        assert before > 0.3
        assert after < max(QUIETER * before, FLOOR_N), f"{order}x: {before:.3f} -> {after:.4f} N"
