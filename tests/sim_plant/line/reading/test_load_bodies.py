"""A line file with dancers, accumulators or heated spans that contradict themselves is refused."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.line.arrays.corrections import declared_numbers
from sim_plant.line.declared.sections import Section
from sim_plant.line.reading.load import load_declaration
from tests.sim_plant.line.bodies import coater
from tests.sim_plant.line.lines import LINES

TEXT = (LINES / "coater.yaml").read_text()
WRONG = [
    ("rollers: [D1]", "rollers: [D7]", "dancers.dancer.rollers: roller D7 does not exist"),
    ("rollers: [D1]", "rollers: [infeed]", "read infeed of kind driven; expected idlers"),
    ("rollers: [A1, A3]", "rollers: [A1, D1]", "roller D1 moves with two of them"),
    ("rotation: cw\n  load", "rotation: ccw\n  load", "dancers.dancer.rotation: somewhere"),
    ("direction_deg: 90.0\n  lift", "direction_deg: 270.0\n  lift", "accumulator.direction_deg"),
    ("travel_m: [-0.6, 0.8]", "travel_m: [-1.1, 0.8]", "look at the centres"),
    ("travel_m: [-0.6, 0.8]", "travel_m: [0.1, 0.8]", "expected stops on both sides of 0"),
    ("pivot_x_m: 0.58", "pivot_x_m: 1.08", "it has no arm"),
    ("    carriage: dancer", "    carriage: dancr", "read 'dancr'; expected one of"),
    ("    carriage: dancer", "    carriage: accumulator", "has a drive of its own"),
    ("position_m: 0.0", "position_m: 0.3", "expected a travel between the stops"),
    (
        "  - loop: dancer\n    acts_on: unwind",
        "  - loop: dancer\n    acts_on: R1",
        "no drive on R1",
    ),
    (
        "  - loop: dancer\n    acts_on: unwind",
        "  - loop: dancer\n    acts_on: rewind",
        "two loops",
    ),
    ("  start: R3\n  end: R4\n  w", "  start: R3\n  end: R5\n  w", "two rollers of one span"),
    ("thermal_expansion_1_K: 2.0e-05", "thermal_expansion_1_K: 0.0", "needs the web's expansion"),
    ("carriage_position\n  roller: D1", "carriage_position\n  roller: R1", "moves with no dancer"),
    (
        "  drive:\n    K_ref_rad_s: 100.0\n    zeta: 1.1\n    force_limit_N: 500.0\n",
        "",
        "nothing holds",
    ),
]


def refused(tmp_path: Path, before: str, after: str) -> str:
    assert TEXT.count(before) == 1, before
    path = tmp_path / "line.yaml"
    path.write_text(TEXT.replace(before, after))
    with pytest.raises(PlantError) as said:
        load_declaration(path)
    return str(said.value)


@pytest.mark.parametrize(("before", "after", "said"), WRONG)
def test_a_contradiction_is_told_with_its_place(
    before: str, after: str, said: str, tmp_path: Path
) -> None:
    message = refused(tmp_path, before, after)
    assert said in message
    assert "line.yaml: " in message


def test_a_wrong_key_of_a_dancer_is_told_with_file_line_and_column(tmp_path: Path) -> None:
    message = refused(tmp_path, "  inertia_kg_m2: 1.5\n", "  inertia_kg_m2: -1.5\n")
    number = TEXT.split("  inertia_kg_m2: 1.5\n")[0].count("\n") + 1
    assert re.search(rf"line.yaml:{number}:3: dancers.0.inertia_kg_m2: read -1.5", message)


def test_a_kind_of_dancer_that_is_none_is_told(tmp_path: Path) -> None:
    assert "dancers.0" in refused(tmp_path, "kind: pendulum", "kind: rocker")


def test_every_number_of_a_body_that_a_record_feels_has_a_correction() -> None:
    names = {number.name for number in declared_numbers(coater())}
    assert {
        "dancers.dancer.inertia_kg_m2",
        "dancers.dancer.load_N_m",
        "dancers.dancer.damping_N_m_s",
        "accumulators.accumulator.mass_kg",
        "accumulators.accumulator.lift_N",
        "heated_spans.oven.warming_K",
        "heated_spans.oven.exchange_s",
        "web.thermal_expansion_1_K",
        "control.position_pi.dancer.gain_m_s_per_m",
    } <= names
    assert not any(
        "position_pi" in n.name for n in declared_numbers(load_declaration(LINES / "euclid.yaml"))
    )
    assert issubclass(type(coater().dancers[0]), Section)
