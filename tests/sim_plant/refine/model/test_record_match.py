from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.cli.main import main
from sim_plant.line.declared.declaration import DriveSpeed, RollAngle, RollRadius
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.model.record_match import (
    declaration_for,
    record_caveats,
    sidecar_of,
    twin_of,
)
from sim_plant.refine.records.recording import Recording
from tests import quick_yaml
from tests.each_case import each_case

LINE_FILE = Path(__file__).parents[4] / "config/lines/euclid.yaml"
LINE = load_declaration(LINE_FILE)
SAMPLES = 400


def columns():
    """Return what a line standing still at its operating point would record."""
    found = {"line_speed_ref_m_s": np.full(SAMPLES, 1.0), "tension_ref_N": np.full(SAMPLES, 89.0)}
    for sensor in LINE.sensors:
        radius = LINE.rollers[LINE.body(sensor.roller)].radius_m
        value = np.full(SAMPLES, 89.0)
        if isinstance(sensor, DriveSpeed) and sensor.scale_radius_m is not None:
            value = np.full(SAMPLES, 1.0)
        elif isinstance(sensor, DriveSpeed):
            value = np.full(SAMPLES, 1.0 / radius)
        elif isinstance(sensor, RollAngle):
            value = np.arange(SAMPLES) * LINE.sample_time_s / radius
        elif isinstance(sensor, RollRadius):
            value = np.full(SAMPLES, radius)
        found[sensor.channel] = value
    return found


def record(changed=None, dropped=None, sample_time_s=LINE.sample_time_s):
    found = columns() | (changed or {})
    found = {name: values for name, values in found.items() if name != dropped}
    return Recording(path=Path("r.csv"), sha256="0", sample_time_s=sample_time_s, columns=found)


def test_a_record_of_this_line_is_accepted():
    twin = twin_of(LINE, record())
    assert set(twin.channels) <= {s.channel for s in LINE.sensors}
    assert "line_speed_m_s" in twin.channels


def degrees_called_radians():
    return {"unwind_angle_rad": np.rad2deg(columns()["unwind_angle_rad"])}


def all_forces(factor):
    return {k: factor * v for k, v in columns().items() if k.endswith("_N")}


@each_case(
    ("changed", "said"),
    [
        (degrees_called_radians(), "unwind_angle_rad: turns 57.3 times as fast"),
        ({"unwind_angle_rad": np.zeros(SAMPLES)}, "unwind_angle_rad: turns 0 times as fast"),
        (all_forces(1000.0), "tension_ref_N: 8.9e.04 N would strain the declared web"),
        (all_forces(0.0), "column tension_ref_N is 0 throughout"),
        ({"line_speed_ref_m_s": np.zeros(SAMPLES)}, "line_speed_ref_m_s is 0 throughout"),
    ],
)
def test_a_unit_that_every_column_gets_wrong_alike_is_refused_all_the_same(changed, said):
    with pytest.raises(PlantError, match=said):
        twin_of(LINE, record(changed))


def test_an_angle_that_starts_over_each_turn_is_accepted():
    angle = np.mod(columns()["unwind_angle_rad"], 2.0 * np.pi)
    assert twin_of(LINE, record({"unwind_angle_rad": angle}))


def one_row(name, value):
    values = columns()[name]
    values[300] = value
    return {name: values}


def backwards():
    return {k: -v for k, v in columns().items() if k.endswith(("_m_s", "_rad_s", "_angle_rad"))}


def stopped():
    speed = np.zeros(SAMPLES)
    speed[0] = 1.0
    return {"line_speed_ref_m_s": speed}


@each_case(
    ("changed", "said"),
    [
        ({"unwind_angle_rad": -columns()["unwind_angle_rad"]}, "unwind_angle_rad: counts back"),
        (stopped(), "line_speed_ref_m_s: the line stands, .* in 99.8 % of the rows"),
        (backwards(), "the line runs backwards"),
        (one_row("tension_ref_N", 1e9), r"line 302: column tension_ref_N: read 1e\+09"),
        (one_row("tension_ref_N", -5.0), "line 302: column tension_ref_N: read -5"),
        (one_row("unwind_tension_N", 99999.0), "line 302: column unwind_tension_N: read 99999"),
        ({"aff_correction_m_s": np.full(SAMPLES, 5.0)}, "line 2: column aff_correction_m_s"),
    ],
)
def test_what_this_line_cannot_do_is_refused_with_its_place(changed, said):
    with pytest.raises(PlantError, match=said):
        twin_of(LINE, record(changed))


def own_file(tmp_path, **more):
    data = quick_yaml.safe_load(LINE_FILE.read_text())
    (tmp_path / "r.yaml").write_text(quick_yaml.safe_dump(data | more))
    return replace(record(), path=tmp_path / "r.csv")


def test_a_sidecar_leaves_what_was_put_right_before(tmp_path):
    """Else numbers that an earlier run put right would be found, and added, once more."""
    line = LINE.model_copy(update={"corrections": {"web.EA_N": 0.05, "web.thickness_m": 0.01}})
    beside = own_file(tmp_path, corrections={"web.EA_N": 0.02})
    found = declaration_for(line, beside).corrections
    assert found == {"web.EA_N": 0.02, "web.thickness_m": 0.01}


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"effects": [{"effect": "gremlin", "location": "R6"}]}, "effects.0.effect: read"),
        (
            {
                "effects": [
                    {
                        "effect": "eccentric_roller",
                        "location": "R6",
                        "parameters": {"eccentricity_m": None},
                    }
                ]
            },
            "effects.0.parameters.eccentricity_m: read None; expected a number",
        ),
    ],
)
def test_what_cannot_be_put_on_the_line_is_refused_before_the_search(tmp_path, more, said):
    with pytest.raises(PlantError, match=r"r\.csv: its line cannot be built: " + said):
        twin_of(LINE, own_file(tmp_path, **more))


def test_a_correction_of_a_number_that_no_line_has_is_refused_with_its_file(tmp_path):
    beside = own_file(tmp_path, corrections={"web.colour": 1.0})
    with pytest.raises(
        PlantError, match=r"r\.yaml: corrections\.web\.colour: this line declares no"
    ):
        twin_of(LINE, beside)


def test_one_speed_only_is_said():
    assert any("one speed only" in text for text in record_caveats(twin_of(LINE, record())))


@pytest.mark.parametrize("name", ["line_speed_ref_m_s", "unwind_tension_N"])
def test_a_missing_column_is_named(name):
    with pytest.raises(PlantError, match=name):
        twin_of(LINE, record(dropped=name))


@each_case(
    ("name", "factor"),
    [
        ("unwind_tension_N", 1000.0),
        ("unwind_tension_N", 4.448),
        ("rewind_tension_N", 1 / 4.448),
        ("line_speed_m_s", 196.85),
        ("unwind_speed_rad_s", 9.55),
    ],
)
def test_a_wrong_unit_is_noticed(name, factor):
    with pytest.raises(PlantError, match=name):
        twin_of(LINE, record({name: columns()[name] * factor}))


def test_another_roll_radius_means_another_line_file():
    with pytest.raises(PlantError, match="not this record's line file"):
        twin_of(LINE, record({"unwind_radius_m": columns()["unwind_radius_m"] * 0.7}))


def test_another_sample_time_is_refused():
    with pytest.raises(PlantError, match="sample_time_s"):
        twin_of(LINE, record(sample_time_s=0.02))


@each_case(
    "ending", [".csv", ".csv.gz", ".txt", ".txt.gz", ".parquet", ".mf4", ".mdf", ".MDF", ".CSV.gz"]
)
def test_the_sidecar_has_the_records_stem(ending):
    assert sidecar_of(Path(f"a/line01.a{ending}")) == Path("a/line01.a.yaml")


def test_a_run_folder_has_no_ending_to_lose():
    assert sidecar_of(Path("runs/a.b@10..40")) == Path("runs/a.b@10..40.yaml")


def test_the_command_refuses_and_writes_nothing(tmp_path, capsys):
    data = columns()
    data["unwind_tension_N"] = data["unwind_tension_N"] * 1000.0
    time_s = np.arange(SAMPLES) * LINE.sample_time_s
    path = tmp_path / "r.csv"
    np.savetxt(
        path,
        np.column_stack([time_s, *data.values()]),
        "%.6f",
        ",",
        header=",".join(["time_s", *data]),
        comments="",
    )
    out = tmp_path / "out"
    assert main(["refine", str(LINE_FILE), str(path), "--out", str(out)]) == 2
    assert "unwind_tension_N" in capsys.readouterr().err
    assert not out.exists()


def test_an_unknown_effect_cannot_be_left_out(tmp_path, capsys):
    arguments = ["refine", str(LINE_FILE), "r.csv", "--out", str(tmp_path), "--without", "magic"]
    assert main(arguments) == 2
    assert "magic" in capsys.readouterr().err
