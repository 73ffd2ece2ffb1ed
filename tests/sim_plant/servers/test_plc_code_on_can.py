"""What PLC code of the user's says in its words is what a bus carries, as Modbus does."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from sim_plant.servers.can_catalogue import can_node
from sim_plant.servers.faults import parse_fault
from sim_plant.servers.plant import Plant
from sim_plant.servers.plc import Plc
from sim_plant.servers.plc_code import CodePlc
from tests.aff_runtime.fieldbus.canopen_bench import CONFIG, SITE, CanopenBench
from tests.aff_runtime.fieldbus.euclid_can import DATABASE
from tests.sim_plant.servers.built_code import built
from tests.sim_plant.servers.fake_line import FakeLine, default_map

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler `cc` on PATH")
MAP = default_map()
SAYS_MORE_N, SAYS_m_s, ADDS_m_s = 5.0, 0.0012, 0.002
CODE = """
#include "aff_plc.h"

static uint16_t heartbeat;

void aff_plc_begin(void) { heartbeat = 0; }

int aff_plc_scan(struct aff_plc_scan *scan)
{
    scan->shown[0] = ++heartbeat;
    uint32_t tension_mN = ((uint32_t)scan->shown[2] << 16 | scan->shown[3]) + 5000;
    scan->shown[2] = tension_mN >> 16;
    scan->shown[3] = tension_mN & 0xFFFF;
    scan->corrections[0] = 0.002;
    scan->shown[16] = 120;
    return 0;
}
"""
NO_NUMBERS = CODE.replace("scan->shown[16] = 120;", "scan->shown[16] = 0x8000;").replace(
    "scan->shown[3] = tension_mN & 0xFFFF;", "scan->shown[2] = 0x8000; scan->shown[3] = 0;"
)


def frames_of(plant: Plant) -> dict[str, float]:
    """Return every signal of the next scan's frames, by cantools."""
    node = can_node(plant, "dbc", CONFIG / "plc" / "can_dbc.yaml")
    plant.step()
    told: dict[str, float] = {}
    for frame in node.publish(plant):
        told |= DATABASE.decode_message(frame.can_id, frame.data)  # type: ignore[arg-type]
    return told


def test_a_wrong_word_of_the_code_is_wrong_on_a_bus_by_dbc(tmp_path: Path) -> None:
    plant = Plant(FakeLine(), CodePlc(MAP, built(tmp_path, CODE)))
    told = frames_of(plant)
    assert told["AppliedUnwind"] == pytest.approx(SAYS_m_s)
    assert plant.applied_m_s["unwind"] == ADDS_m_s
    true_N = plant.measured["true_unwind_tension_N"]
    assert told["UnwindTension"] == pytest.approx(true_N + SAYS_MORE_N, abs=0.001)
    assert told["PullrollTension"] == pytest.approx(95.0)


def test_a_wrong_word_of_the_code_is_wrong_on_canopen(tmp_path: Path) -> None:
    bench = CanopenBench(CodePlc(MAP, built(tmp_path, CODE)))
    bench.run(1.0)
    shot = bench.tick()
    assert shot.applied[0] == pytest.approx(SAYS_m_s)
    true_N = bench.lockstep.plant.measured["true_unwind_tension_N"]
    values = dict(zip(SITE.gateway.read.channels, shot.values, strict=True))
    assert values["unwind_tension_N"] == pytest.approx(true_N + SAYS_MORE_N, abs=0.2)


def test_what_the_code_leaves_alone_is_as_fine_as_the_bus_counts(tmp_path: Path) -> None:
    """A hair that no word of the map can say reaches the frames."""
    plant = Plant(FakeLine(), CodePlc(MAP, built(tmp_path, CODE)))
    assert plant.shown.measured["unwind_angle_rad"] == plant.measured["unwind_angle_rad"]
    assert plant.shown.measured["unwind_tension_N"] != plant.measured["unwind_tension_N"]


def test_a_channel_that_the_code_calls_none_is_none_on_the_bus(tmp_path: Path) -> None:
    code = Plant(FakeLine(), CodePlc(MAP, built(tmp_path, NO_NUMBERS)))
    simulated = Plant(FakeLine(), Plc(MAP))
    simulated.inject(parse_fault("nan=unwind_tension_N"))
    assert frames_of(code)["UnwindTension"] == frames_of(simulated)["UnwindTension"]


def test_a_correction_beyond_the_object_is_shown_at_its_end(tmp_path: Path) -> None:
    """Where the map has no word of what is applied it is what reaches the drives."""
    code = CODE.replace("0.002", "5.0")
    bench = CanopenBench(CodePlc(replace(MAP, applied=()), built(tmp_path, code)))
    bench.run(1.0)
    assert bench.tick().applied[0] == pytest.approx(0x7FFF * 1e-5)
