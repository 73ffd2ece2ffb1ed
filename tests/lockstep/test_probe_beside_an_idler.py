"""An idler that nobody knows: the probe beside its ripple, and its block on that response."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.app.wiring.site_to_law import probe_params, site_params
from aff_runtime.config.loader import load_site
from aff_runtime.core.controller import Controller
from aff_runtime.core.probe.probe import Probe, ProbeResult, Stage
from aff_runtime.core.response import MAX_PHASE_ERROR_RAD, Provenance
from aff_runtime.loop.messages import Arm, Bypass, Swap
from aff_runtime.loop.ports import Advice
from sim_plant.base.order_tracking import order_amplitudes, reduction_dB
from sim_plant.demo.loop.drawn import Files, Hidden, write_files
from sim_plant.line.linear.frequency import response
from sim_plant.line.reading.load import load_declaration
from tests import quick_yaml
from tests.lockstep.bench import Bench, Setup
from tests.lockstep.known_response import CYCLE_S, CYCLES_ON_THE_WAY

pytestmark = pytest.mark.timeout(300)
SPEED_M_S, RADIUS_M = 0.85, 0.0381
IDLER_HZ = SPEED_M_S / (math.tau * RADIUS_M)
FULL_M = 0.17  # so that no order of the unwind meets the idler's in the test
BLOCKS = "      - { roll: swrap_follower, orders: [1], settle_s: 10, amp_limit_m_s: 0.01 }\n"


@dataclass(frozen=True)
class Probed:
    """A bench that has been probed with the site file as its owner has it."""

    bench: Bench
    files: Files
    results: dict[str, ProbeResult]


def files_of(folder: Path) -> Files:
    """Return the demo's files with R9 out of centre by 0.3 mm: 1 N at the load cell."""
    roll = {"shape": "ellipse", "size_m": 1.5e-3, "angle_rad": 4.0}
    idler = {"eccentricity_m": 3.1e-4, "angle_rad": 4.1}
    files = write_files(
        folder,
        (
            Hidden(effect="out_of_round_roll", location="unwind", parameters=roll),
            Hidden(effect="eccentric_roller", location="R9", parameters=idler),
        ),
    )
    plant = quick_yaml.safe_load(files.plant.read_text())
    plant["initial_radii_m"]["unwind"] = FULL_M
    files.plant.write_text(quick_yaml.safe_dump(plant, sort_keys=False))
    return files


@pytest.fixture(scope="module")
def probed(tmp_path_factory) -> Probed:
    folder = tmp_path_factory.mktemp("idler")
    (folder / "run").mkdir()
    files = files_of(folder)
    bench = Bench(
        Setup(line=files.plant, site=files.site, plc_map=files.plc, line_speed_m_s=SPEED_M_S)
    )
    site = load_site(files.site)
    names = tuple(site.actuators)
    probe = Probe(site_params(site), probe_params(site, names))
    advise, bench.outside.advise = bench.outside.advise, lambda _: Advice()
    for said in (Swap(law=probe), Arm()):
        bench.say(said)
    bench.run(32.0)
    assert probe.stage is Stage.DONE, probe.reason
    bench.say(Bypass())
    bench.run(1.0)
    bench.outside.advise = advise
    about = {name: Provenance(actuator=name, signal="") for name in names}
    return Probed(bench, files, {r.actuator: r for r in probe.result(about)})


@pytest.mark.long  # quick: core/probe/test_probe.py, beside ripple that nobody declared
def test_the_response_is_sure_at_the_frequency_of_an_idler_that_nobody_declared(probed):
    found = probed.results["unwind"].response
    true = response(
        load_declaration(probed.files.plant),
        "unwind",
        "unwind_tension_N",
        np.array([IDLER_HZ]),
        SPEED_M_S,
    )[0]
    on_the_way = cmath.exp(-1j * math.tau * IDLER_HZ * CYCLES_ON_THE_WAY * CYCLE_S)
    bound = found.phase_error_bound_rad(IDLER_HZ)
    assert bound < MAX_PHASE_ERROR_RAD
    assert abs(cmath.phase(found.at(IDLER_HZ) / (true * on_the_way))) < bound


@pytest.mark.long  # quick: core/probe/test_probe.py
def test_the_probe_says_that_there_is_ripple_of_a_roll_that_the_file_does_not_have(probed):
    (remark,) = probed.results["unwind"].remarks
    assert "belongs to no roll of the site file" in remark


@pytest.mark.long
def test_a_block_that_is_added_live_takes_the_idlers_ripple_down_by_25_dB(probed, tmp_path):
    bench = probed.bench
    responses = {name: found.response for name, found in probed.results.items()}
    text = probed.files.site.read_text()
    text = text.replace("rolls:\n", f"rolls:\n  r9: {{ radius_m: {RADIUS_M} }}\n", 1)
    block = "      - { roll: r9, orders: [1], settle_s: 8, amp_limit_m_s: 0.02 }\n"
    proposed = tmp_path / "proposed.yaml"
    proposed.write_text(text.replace(BLOCKS, BLOCKS + block, 1))
    present = Controller(site_params(load_site(probed.files.site)), responses)
    bench.say(Swap(law=present))
    bench.run(1.0)
    bench.arm(15.0)
    before_N = first_order(bench, 10.0)
    with_block = Controller(site_params(load_site(proposed)), responses)
    bench.say(Swap(law=with_block, take_over=with_block.adopt))
    bench.run(15.0)
    assert reduction_dB(before_N, first_order(bench, 16.0)) >= 25.0


def first_order(bench: Bench, seconds: float) -> float:
    """Return the amplitude of R9's order 1 in the true tension over some seconds, N."""
    rows: list[tuple[float, ...]] = []
    names = ("true_unwind_tension_N", "true_r9_angle_rad", "true_unwind_angle_rad")

    def look(plant) -> None:
        rows.append(tuple(plant.measured[name] for name in names))

    bench.plant.observers.append(look)
    bench.run(seconds)
    bench.plant.observers.remove(look)
    tension_N, idler_rad, unwind_rad = np.array(rows).T
    return float(abs(order_amplitudes(tension_N, idler_rad, (1,), {"u": unwind_rad})[0]))
