"""A run's columns by the names of the line, its references, radii and corrections."""

from copy import deepcopy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.line.running.simulation import LineSimulation
from sim_plant.refine.model.record_match import twin_of
from sim_plant.refine.model.run_caveats import run_caveats
from sim_plant.refine.model.run_match import mean_over_row, run_on_line
from sim_plant.refine.records.recording import Recording
from sim_plant.servers.map_file import load_plc_map
from sim_plant.servers.plant import Plant
from sim_plant.servers.plc import Plc
from tests.doubles.recorded_run import PLC_FILE
from tests.each_case import each_case
from tests.sim_plant.refine.model.made_run import (
    FOLLOWER_M,
    FOLLOWER_RAD,
    LINE,
    ROWS,
    SPEED_M_S,
    STEP_S,
    TIME_S,
    UNWIND_M,
    UNWIND_RAD,
    actuator,
    run,
)


def test_channels_are_found_by_what_the_site_file_uses_them_for():
    record = run_on_line(LINE, run())
    expected = {
        "unwind_tension_N": "web_N",  # error signal of the actuator that the unwind's loop acts on
        "line_speed_m_s": "v_m_s",
        "unwind_angle_rad": "turns_rad",
        "swrap_follower_angle_rad": "follower_rad",
        "unwind_radius_m": "roll_m",
        "tension_ref_N": "t_ref_N",
    }
    theirs = run().columns
    for mine, name in expected.items():
        read = theirs[name]
        wanted = mean_over_row(read, 1.0) if mine == "tension_ref_N" else read
        assert record.columns[mine].tolist() == wanted.tolist(), mine
    assert set(record.columns) == {*expected, "line_speed_ref_m_s"}
    assert record.zeros_rad == {"unwind_angle_rad": 3.5}
    assert "unwind_tension_N is the run's web_N" in record.findings


BEHIND = {"swrap_follower_tension_N": np.full(ROWS, 93.0)}


def corrected(*names, signal="swrap_follower_tension_N", roll=""):
    """Return the unwind's actuator and another, each by a name."""
    behind = replace(actuator(reference="", roll=roll), signal=signal)
    return {"unwind": actuator(), **dict.fromkeys(names, behind)}


@pytest.mark.parametrize(
    "actuators", [corrected("swrap_follower"), corrected("s2", roll="Swrap_Follower")]
)
def test_the_tension_behind_a_second_roller_is_the_one_cell_of_its_zone_by_whatever_name(
    actuators,
):
    """So a site file that `aff-runtime setup` wrote calls it, from the roller's name."""
    record = run_on_line(LINE, run(BEHIND, actuators=actuators))
    assert record.columns["pullroll_tension_N"][0] == 93.0
    assert "pullroll_tension_N is the run's swrap_follower_tension_N" in record.findings
    assert not any("not used" in text for text in record.findings)


def test_of_two_cells_in_that_zone_none_is_guessed_and_the_reading_is_named():
    other = next(s for s in LINE.sensors if s.channel == "pullroll_tension_N")
    second = other.model_copy(update={"channel": "r13_tension_N", "roller": "R13"})
    line = LINE.model_copy(update={"sensors": (*LINE.sensors, second)})
    record = run_on_line(line, run(BEHIND, actuators=corrected("swrap_follower")))
    assert "pullroll_tension_N" not in record.columns
    (text,) = [t for t in record.findings if "not used" in t]
    assert "not used: swrap_follower_tension_N: no sensor of the line file" in text
    by_name = {**BEHIND, "r13_tension_N": np.full(ROWS, 92.0)}  # then the other one is left
    record = run_on_line(line, run(by_name, actuators=corrected("swrap_follower")))
    assert record.columns["pullroll_tension_N"][0] == 93.0


def test_what_a_drive_that_a_loop_trims_keeps_quiet_is_no_other_cell_of_its_zone():
    record = run_on_line(
        LINE, run({"r3_N": np.full(ROWS, 91.0)}, actuators=corrected(signal="r3_N"))
    )
    assert "r3_tension_N" not in record.columns
    assert any("not used: r3_N" in text for text in record.findings)


@pytest.mark.parametrize(("name", "roll"), [("UNWIND", ""), ("a1", "unwind"), ("a1", "Unwind")])
def test_the_tension_of_a_loop_is_found_by_its_actuators_drive_too(name, roll):
    record = run_on_line(LINE, run(actuators={name: actuator(roll=roll)}))
    assert "unwind_tension_N is the run's web_N" in record.findings


def test_the_roll_of_a_declared_drive_goes_before_the_actuators_name():
    wave = 0.01 * np.sin(TIME_S)
    follower = replace(actuator(roll="swrap_follower"), signal="swrap_follower_tension_N")
    actuators = {"brake": actuator(roll="unwind"), "unwind": follower}
    columns = {**BEHIND, "correction_unwind_m_s": wave}
    record = run_on_line(LINE, run(columns, actuators=actuators))
    assert record.columns["applied_swrap_follower_m_s"].tolist() == wave.tolist()
    assert "applied_unwind_m_s" not in record.columns
    assert "unwind_tension_N is the run's web_N" in record.findings
    assert "pullroll_tension_N is the run's swrap_follower_tension_N" in record.findings


def test_a_name_that_the_line_has_itself_goes_before_its_use():
    record = run_on_line(LINE, run({"unwind_tension_N": np.full(ROWS, 70.0)}))
    assert record.columns["unwind_tension_N"][0] == 70.0


def test_the_set_point_of_another_zone_is_none_of_the_loops():
    """The unwind has no reference; behind the S-wrap 120 N are wanted, at the unwind's cell 88."""
    actuators = corrected("swrap_follower")
    actuators["unwind"] = actuator(reference="")
    actuators["swrap_follower"] = replace(
        actuators["swrap_follower"], reference="pullroll_setpoint_N"
    )
    columns = {**BEHIND, "pullroll_setpoint_N": np.full(ROWS, 120.0)}
    record = run_on_line(LINE, run(columns, actuators=actuators))
    assert record.columns["tension_ref_N"].tolist() == [88.0] * ROWS
    assert (
        "no tension reference is recorded: the mean of unwind_tension_N, 88 N, stands in"
        in record.findings
    )


@each_case(
    "owner", [("unwind", ""), ("UNWIND", ""), ("a1", "unwind"), ("a1", ""), ("swrap_follower", "")]
)
def test_the_set_point_of_the_loops_own_tension_is_taken_whoever_names_it(owner):
    """By the actuator's name, by its declared drive, or by the signal that is the loop's cell."""
    name, roll = owner
    own = replace(actuator(roll=roll), signal="unwind_tension_N")
    columns = {"web_N": None, "unwind_tension_N": np.full(ROWS, 88.0)}
    record = run_on_line(LINE, run(columns, actuators={name: own}))
    assert record.columns["tension_ref_N"][[0, -1]].tolist() == [88.0, 92.0]


def test_a_mapped_speed_reference_is_taken_and_nothing_said():
    wanted = np.linspace(0.9, 1.0, ROWS)
    record = run_on_line(LINE, run({"v_set_m_s": wanted}, speed_reference="v_set_m_s"))
    assert record.columns["line_speed_ref_m_s"].tolist() == mean_over_row(wanted, 1.0).tolist()
    assert not any("reference" in text for text in record.findings)


def test_without_one_the_speed_stands_in_at_the_level_of_a_driven_rollers_turns():
    record = run_on_line(LINE, run())
    # the speed word reads 0.4 mm/s too much; turns times the declared radius are exact
    assert record.columns["line_speed_ref_m_s"] == pytest.approx(
        np.full(ROWS, SPEED_M_S), rel=1e-9
    )
    (text,) = [t for t in run_caveats(record, twin_of(LINE, record)) if "speed reference" in t]
    assert "at which of several like idlers of a zone an effect sits is not told" in text


@pytest.mark.parametrize(("roll", "start_m", "grows"), [("rewind", 0.15, 1), ("unwind", 0.19, -1)])
def test_a_roll_of_which_only_the_turning_is_known_starts_at_its_radius_then(roll, start_m, grows):
    # radius from the area of its side: web run times thickness; 0.9 mm lie between 0 and 10 s
    radius_m = np.sqrt(start_m**2 + grows * SPEED_M_S * TIME_S * LINE.web.thickness_m / np.pi)
    columns = {f"{roll}_speed_rad_s": SPEED_M_S / radius_m}
    columns |= {"roll_m": None, "turns_rad": None} if roll == "unwind" else {}
    rolls = {"swrap_follower": {"angle": "follower_rad"}}
    record = run_on_line(LINE, run(columns, rolls=rolls if roll == "unwind" else None))
    radii = twin_of(LINE, record).declaration.initial_radii_m
    assert getattr(radii, roll) == pytest.approx(start_m, rel=2e-5)


def test_a_straight_ramp_stands_in_where_a_drive_follows_one():
    wanted = np.interp(TIME_S, [10.0, 14.0], [0.8, 1.2])
    acts = mean_over_row(wanted, 0.0)
    # the drive, an integral in its loop: e'' + K e' + K^2 / (4 zeta^2) e = v_ref''
    gain, integral = 20.0, 20.0**2 / 4.84
    error, summed, measured = 0.0, 0.0, []
    for v in wanted:
        measured.append(v - error if not measured else measured[-1])
        error = v - measured[-1]
        summed += error * STEP_S
        measured[-1] += STEP_S * (gain * error + integral * summed)
    counts = np.round(np.array(measured) / 0.001) * 0.001
    turned = np.cumsum(np.array(measured)) * STEP_S / FOLLOWER_M
    for columns in ({"follower_rad": None}, {"follower_rad": turned}):
        record = run_on_line(LINE, run({"v_m_s": counts, **columns}))
        assert record.columns["line_speed_ref_m_s"] == pytest.approx(acts, abs=0.004)
        travel = np.cumsum(record.columns["line_speed_ref_m_s"] - acts) * STEP_S
        assert np.max(np.abs(travel)) < 0.004  # a tenth of a radian of an idler of 38 mm


def test_a_change_of_speed_that_is_no_straight_ramp_is_followed_and_said():
    wave = 1.0 + 0.1 * np.sin(2.0 * np.pi * np.clip(TIME_S - 10.0, 0.0, 8.0) / 8.0)
    record = run_on_line(LINE, run({"v_m_s": wave, "follower_rad": None}))
    assert record.columns["line_speed_ref_m_s"] == pytest.approx(wave, abs=0.012)
    said = "1 change of speed: no straight ramp fits, smoothed there"
    assert any(said in text for text in record.findings)


def test_without_a_tension_reference_the_loops_own_mean_stands_in():
    record = run_on_line(LINE, run(actuators={"unwind": actuator(reference="")}))
    assert record.columns["tension_ref_N"].tolist() == [88.0] * ROWS
    assert any("no tension reference is recorded" in text for text in record.findings)


def test_radii_and_sample_time_are_those_of_the_runs_beginning():
    shrinking = UNWIND_M - 1e-4 * TIME_S
    twin = twin_of(LINE, run_on_line(LINE, run({"roll_m": shrinking})))
    radii, declared = twin.declaration.initial_radii_m, LINE.initial_radii_m
    assert radii.unwind == pytest.approx(UNWIND_M, abs=1e-6)
    web = declared.unwind**2 + declared.rewind**2  # what has left the one roll is on the other
    assert radii.unwind**2 + radii.rewind**2 == pytest.approx(web)
    assert twin.declaration.rollers[0].radius_m == radii.unwind


def test_a_radius_that_is_not_recorded_comes_from_web_travel_over_turns():
    # a spiral: travel = R angle - h angle^2 / 4 pi
    per_turn_m = LINE.web.thickness_m
    left_m = np.sqrt(UNWIND_M**2 - SPEED_M_S * TIME_S * per_turn_m / np.pi)
    columns = {"roll_m": None, "turns_rad": (UNWIND_M - left_m) * 2.0 * np.pi / per_turn_m}
    twin = twin_of(LINE, run_on_line(LINE, run(columns)))
    assert twin.declaration.initial_radii_m.unwind == pytest.approx(UNWIND_M, rel=1e-6)


def test_every_correction_is_an_input_of_the_drive_it_went_to():
    wave = 0.01 * np.sin(TIME_S)
    columns = {
        "correction_unwind_m_s": wave,
        "correction_other_m_s": 2.0 * wave,
        "correction_pull_roll_N_m": 3.0 * wave,
    }
    actuators = {
        "unwind": actuator(),
        "other": actuator(roll="swrap_follower"),  # its declared drive turns that roll
        "pull_roll": actuator(suffix="N_m"),
    }
    twin = twin_of(LINE, run_on_line(LINE, run(columns, actuators=actuators)))
    assert twin.speed_holds
    assert twin.aff_m_s.keys() == {"unwind", "swrap_follower"}
    assert twin.aff_m_s["unwind"].tolist() == wave.tolist()
    assert twin.aff_m_s["swrap_follower"].tolist() == (2.0 * wave).tolist()
    assert twin.aff_N_m["pull_roll"].tolist() == (3.0 * wave).tolist()


def test_a_correction_of_what_is_no_drive_of_the_line_is_refused_unless_it_was_zero():
    actuators = {"unwind": actuator(), "brake": actuator()}
    still = {"correction_brake_m_s": np.zeros(ROWS)}
    assert twin_of(LINE, run_on_line(LINE, run(still, actuators=actuators))).aff_m_s == {}
    moved = {"correction_brake_m_s": np.full(ROWS, 0.001)}
    with pytest.raises(PlantError, match="went out through brake, which is no drive of this line"):
        run_on_line(LINE, run(moved, actuators=actuators))


def test_a_run_of_another_line_is_refused_by_its_tensions_or_its_radius():
    with pytest.raises(PlantError, match=r"holds no tension of this line.*another line"):
        run_on_line(LINE, run({"web_N": None}))
    with pytest.raises(PlantError, match=r"unwind begins at a radius of 3 m.*another line"):
        twin_of(LINE, run_on_line(LINE, run({"roll_m": np.full(ROWS, 3.0)})))


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ({"follower_rad": 1.25 * FOLLOWER_RAD}, r"swrap_follower turns as a body of 0.12[23]"),
        ({"turns_rad": 1.25 * UNWIND_RAD}, r"unwind turns as a body of 0.152.* m.* by the run"),
        ({"follower_rad": 0.0 * FOLLOWER_RAD}, r"swrap_follower_angle_rad: turns 0 times as"),
    ],
)
def test_a_run_of_another_line_with_the_same_channels_is_refused_by_what_does_not_fit(
    columns, said
):
    with pytest.raises(PlantError, match=rf"{said}.*(another line|the line file)"):
        twin_of(LINE, run_on_line(LINE, run(columns, speed_reference="v_m_s")))


def test_a_roll_that_grows_thin_within_the_record_is_no_other_line():
    """From 0.19 to 0.13 m: over all of it the roll turns as its mean radius makes it."""
    end_m, metres = 0.13, SPEED_M_S * (TIME_S[-1] + STEP_S)
    thickness_m = np.pi * (UNWIND_M**2 - end_m**2) / metres
    radius = np.sqrt(UNWIND_M**2 - thickness_m * SPEED_M_S * TIME_S / np.pi)
    turned = 2.0 * np.pi * (UNWIND_M - radius) / thickness_m
    thick = LINE.model_copy(
        update={"web": LINE.web.model_copy(update={"thickness_m": thickness_m})}
    )
    record = run({"turns_rad": turned, "roll_m": radius}, speed_reference="v_m_s")
    twin = twin_of(thick, run_on_line(thick, record))
    assert twin.declaration.initial_radii_m.unwind == pytest.approx(UNWIND_M, rel=1e-4)
    with pytest.raises(PlantError, match=r"unwind turns as a body of 0.128.* by the run"):
        twin_of(thick, run_on_line(thick, run(record.columns | {"turns_rad": 1.25 * turned})))


def test_a_radius_that_is_roughly_declared_makes_no_other_line():
    near = run({"follower_rad": 1.03 * FOLLOWER_RAD}, speed_reference="v_m_s")
    assert twin_of(LINE, run_on_line(LINE, near))


def test_corrections_of_any_driven_roller_are_taken_from_files_too():
    speed = np.full(ROWS, SPEED_M_S)
    columns = {s.channel: np.full(ROWS, 88.0) for s in LINE.sensors}
    for s in LINE.sensors:
        if s.channel.endswith(("_m_s", "_rad_s")):
            radius = (
                getattr(s, "scale_radius_m", None) or LINE.rollers[LINE.body(s.roller)].radius_m
            )
            columns[s.channel] = speed if s.channel.endswith("_m_s") else speed / radius
        if s.channel.endswith("_angle_rad"):
            columns[s.channel] = SPEED_M_S * TIME_S / LINE.rollers[LINE.body(s.roller)].radius_m
        if s.channel.endswith("_radius_m"):
            columns[s.channel] = np.full(ROWS, LINE.initial_radii_m.unwind)
    wave = 0.01 * np.sin(TIME_S)
    columns |= {
        "line_speed_ref_m_s": speed,
        "tension_ref_N": np.full(ROWS, 88.0),
        "aff_correction_m_s": wave,
        "applied_swrap_follower_m_s": 2.0 * wave,
    }
    record = Recording(path=Path("a.csv"), sha256="0", sample_time_s=STEP_S, columns=columns)
    twin = twin_of(LINE, record)
    assert not twin.speed_holds  # the speed of a file is linear between rows
    aff = twin.aff_m_s
    assert {name: values.tolist() for name, values in aff.items()} == {
        "unwind": wave.tolist(),
        "swrap_follower": (2.0 * wave).tolist(),
    }
    columns["applied_R6_m_s"] = wave
    with pytest.raises(PlantError, match="R6 has no drive in this line"):
        twin_of(LINE, record)


def test_a_reference_acts_in_the_scan_that_ends_with_the_row_that_first_shows_it():
    """From a row to the middle of the next it is half a row; shown it is half a scan later."""
    ramp = 0.8 + 0.05 * TIME_S
    for scan_rows in (1.0, 0.4, 0.0):
        led_rows = (mean_over_row(ramp, scan_rows) - ramp)[:-1] / (0.05 * STEP_S)
        assert led_rows == pytest.approx(np.full(ROWS - 1, 0.5 + 0.5 * scan_rows)), scan_rows
    assert mean_over_row(np.full(7, 3.0), 0.4) == pytest.approx(np.full(7, 3.0))


def test_the_twin_turns_as_the_plant_does_through_a_ramp():
    """A driven roller that is 0.1 mm of web behind after a ramp is told as a drag."""
    line = LineSimulation(LINE, seed=None, line_speed_m_s=0.85)
    line.settle(4.0)
    plant = Plant(line, Plc(load_plc_map(PLC_FILE)))
    twin = deepcopy(line)  # as it is at the first row
    rows = []
    for wanted_m_s in np.interp(np.arange(400), [100, 300], [0.85, 0.62]):
        rows.append(dict(plant.measured))
        plant.set_reference("line_speed_ref_m_s", float(wanted_m_s))
        plant.step()
    read = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    given = {n: mean_over_row(read[n], 1.0) for n in ("line_speed_ref_m_s", "tension_ref_N")}
    names = ("swrap_follower_angle_rad", "unwind_angle_rad", "line_speed_m_s")
    held = deepcopy(twin).simulate(*given.values(), speed_holds=True)
    for name in names:
        assert held[name] == pytest.approx(read[name], abs=1e-9), name
    # linear between rows, 1 ms ticks take the beginnings of theirs: 0.4 of a row too early
    linear = deepcopy(twin).simulate(*given.values())
    ahead_rad = 0.4 * STEP_S * 0.23 / FOLLOWER_M
    # the speed falls: who is early has turned less
    assert read[names[0]][-1] - linear[names[0]][-1] == pytest.approx(ahead_rad, rel=0.02)
