"""Runs of the whole runtime in virtual time, read as records; attacked as runs are."""

import gzip
import shutil

import numpy as np
import pytest
import yaml

from aff_runtime.base.errors import PlantError
from aff_runtime.base.runs.table import read_table
from aff_runtime.base.runs.window import run_window
from sim_plant.refine.records.read import read_record
from tests.doubles.recorded_run import RecordedRun, files
from tests.sim_plant.refine.records.altered_run import (
    at_cycle,
    blank,
    blank_some,
    cut,
    halve_scans,
    rename,
)

STEP_S = 0.02
"""At 20 ms a run takes a quarter of the time of one at 5 ms."""
SPEED_M_S = 0.5
"""At 1 m/s the roller turns faster than the law can correct at this cycle."""
APPLIED = "correction_unwind_m_s"
pytestmark = pytest.mark.timeout(300)
OUT_OF_ROUND = {
    "effect": "eccentric_roller",
    "location": "R6",
    "parameters": {"eccentricity_m": 2.5e-4, "angle_rad": 1.0},
}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A run of 49 s: off 25 s, on 20 s, a splice, off again; what the plant had beside it."""
    folder = tmp_path_factory.mktemp("run")
    made = files(folder, [OUT_OF_ROUND], cycle_ms=20)
    run = RecordedRun(made, folder / "runs", line_speed_m_s=SPEED_M_S)
    truth = []
    run.bench.plant.observers.append(
        lambda plant: truth.append(
            (plant.measured["unwind_tension_N"], plant.applied_m_s["unwind"])
        )
    )
    run.bench.run(25.0)
    run.bench.arm(20.0)
    run.bench.inject("splice")
    run.bench.run(4.0)
    return run.end(), np.array(truth)


@pytest.fixture(scope="module")
def whole(made):
    """The record of that run, read once; nobody writes to it."""
    return read_record(made[0])


@pytest.fixture(scope="module")
def with_holes(tmp_path_factory):
    """A run of 22 s in which ten times two ticks are missed while AFF is on, and the truth."""
    folder = tmp_path_factory.mktemp("holes")
    made, truth = files(folder, [OUT_OF_ROUND], cycle_ms=20), []
    run = RecordedRun(made, folder / "runs", line_speed_m_s=SPEED_M_S)
    run.bench.plant.observers.append(
        lambda plant: truth.append(
            (plant.measured["unwind_tension_N"], plant.applied_m_s["unwind"])
        )
    )
    run.bench.run(8.0)
    run.bench.arm(3.0)
    for _ in range(10):
        run.bench.run(1.0)
        run.bench.clock.advance_ns(3 * run.bench.period_ns)
    run.bench.run(1.0)
    return run.end(), np.array(truth)


@pytest.fixture
def run(made, tmp_path):
    """A copy to damage."""
    shutil.copytree(made[0], tmp_path / "run")
    return tmp_path / "run"


def said_of(record, text):
    return [finding for finding in record.findings if text in finding]


def test_readings_and_corrections_are_those_of_the_plant_sample_by_sample(made, whole):
    record, truth = whole, made[1]
    assert record.sample_time_s == pytest.approx(STEP_S)
    rows = record.samples
    tension = record.columns["unwind_tension_N"]
    shift = next(k for k in range(4) if np.allclose(tension, truth[k : k + rows, 0], atol=6e-4))
    applied = record.columns[APPLIED]
    assert np.any(applied)
    assert applied == pytest.approx(truth[shift : shift + rows, 1], abs=1.1e-5)


@pytest.mark.parametrize("missing", ["", "plc_applied_unwind_m_s", "echo_age"])
def test_over_missed_ticks_the_correction_is_the_one_that_the_plant_had(
    with_holes, tmp_path, missing
):
    """The PLC has the command of the last tick by its next scan, and holds it."""
    path, truth = with_holes
    shutil.copytree(path, tmp_path / "run")
    for column in ("plc_applied_unwind_m_s", "echo_age") if missing == "echo_age" else [missing]:
        if column:
            rename(tmp_path / "run", column, f"gone_{column}")
    record = read_record(tmp_path / "run")
    assert said_of(record, "20 ticks were missed")
    tension, rows = record.columns["unwind_tension_N"], record.samples
    shift = min(
        range(len(truth) - rows + 1),
        key=lambda k: np.median(np.abs(tension - truth[k : k + rows, 0])),
    )
    applied = truth[shift : shift + rows, 1]
    assert np.ptp(applied) > 0.01
    assert record.columns[APPLIED] == pytest.approx(applied, abs=1.1e-5)


@pytest.mark.parametrize("missing", ["plc_applied_unwind_m_s", "echo_age"])
def test_the_correction_is_the_same_without_the_plcs_own_words(whole, run, missing):
    rename(run, "plc_applied_unwind_m_s", "gone_1")
    if missing == "echo_age":
        rename(run, "echo_age", "gone_2")
    record = read_record(run)
    assert record.columns[APPLIED][20:] == pytest.approx(whole.columns[APPLIED][20:], abs=1.1e-5)
    assert record.run is not None
    assert record.run.delivery_known["unwind"] == (missing != "echo_age")


def test_a_site_files_delay_counts_cycles_of_the_service_where_the_plc_scans_more_slowly(run):
    for column in ("plc_applied_unwind_m_s", "echo_age"):
        rename(run, column, f"gone_{column}")
    halve_scans(run)
    site = yaml.safe_load((run / "site.yaml").read_text())
    site["actuators"]["unwind"]["drive"] = {"roll": "unwind", "transport_ms": 80}
    (run / "site.yaml").write_text(yaml.safe_dump(site))
    record = read_record(run)
    assert record.sample_time_s == pytest.approx(2.0 * STEP_S)
    # from the snapshot to the drive 80 ms of 20 ms each, less the one in which the drive takes it
    assert said_of(record, "as sent, 3 cycles late (the site file's delay)")


def test_on_off_and_the_piece_taken_are_said(whole):
    record = whole
    assert record.run is not None
    assert record.run.activity.on_s == pytest.approx(20.0, abs=1.0)
    assert record.run.activity.off_s == pytest.approx(25.0, abs=1.0)
    assert record.duration_s == pytest.approx(45.0, abs=0.2)
    assert said_of(record, "a splice begins")
    assert said_of(record, "taken is 0.0..45.0 s of the run; left out")


def test_an_angle_begins_at_zero_and_its_zero_is_kept(made, whole):
    part = read_record(f"{made[0]}@10..40")
    name = "unwind_angle_rad"
    assert part.columns[name][0] == 0.0
    table = read_table(run_window(f"{made[0]}@10..40")).columns
    assert part.zeros_rad[name] == table[name][0]
    turned = part.zeros_rad[name] - whole.zeros_rad[name]
    assert turned == pytest.approx(whole.columns[name][500 - 1], abs=0.05)  # 10 s, one count
    assert turned == pytest.approx(10.0 * SPEED_M_S / 0.2032, rel=0.01)


def test_a_run_that_a_crash_ended_at_once_is_refused_with_what_is_missing(run):
    first, *others = sorted(run.glob("signals-*"))
    for segment in others:
        segment.unlink()
    first.write_bytes(first.read_bytes()[:-100])
    with pytest.raises(PlantError, match=r"no 20 s of the running line without a break"):
        read_record(run)


def test_a_last_segment_torn_by_a_crash_is_used_up_to_there(whole, run):
    last = sorted(run.glob("signals-*"))[-2]  # the segment from 20 to 40 s
    sorted(run.glob("signals-*"))[-1].unlink()
    last.write_bytes(last.read_bytes()[: last.stat().st_size // 2])
    (run / "summary.json").unlink()
    record = read_record(run)
    assert 25.0 < record.duration_s < 40.0
    assert said_of(record, "ends torn")
    for name, values in record.columns.items():
        assert values == pytest.approx(whole.columns[name][: record.samples]), name


def test_a_full_disk_in_a_segment_leaves_a_hole_that_is_named_and_not_bridged(run):
    cut(run, 2, 100, 200)
    record = read_record(run)
    assert record.duration_s == pytest.approx(22.0, abs=0.1)  # the second segment begins at 20 s
    assert said_of(record, "100 rows are missing")
    assert said_of(record, "nothing was read for 2.0")


def test_one_missed_row_is_filled_in_and_said(whole, run):
    cut(run, 1, 500, 501)
    record = read_record(run)
    assert record.samples == whole.samples
    assert said_of(record, "1 missing samples are filled in between")
    name = "unwind_tension_N"
    k = int(np.flatnonzero(record.columns[name] != whole.columns[name])[0])
    neighbours = whole.columns[name][[k - 1, k + 1]]
    assert record.columns[name][k] == pytest.approx(neighbours.mean())


def test_a_site_file_that_was_edited_in_the_middle_is_named(run):
    with (run / "events.csv").open("a") as file:
        file.write('12.0,,,EDIT,,"actuators.unwind.limit_m_s: 0.05 -> 0.1"\n')
        file.write('14.0,,,EDIT,,"/l/unwind.json: response none -> c5 (probed here; root)"\n')
    record = read_record(run)
    assert said_of(record, "at 12.0 s the site file was changed (actuators.unwind.limit")
    assert said_of(record, "at 14.0 s the response that a probe had measured was taken (/l/unw")


@pytest.mark.parametrize("text", ["- 1", "line: {name: x}", "{", "line: 3\ngateway: 4"])
def test_a_run_whose_site_file_says_nothing_is_refused_in_words(run, text):
    (run / "site.yaml").write_text(text)
    with pytest.raises(PlantError, match=r"site.yaml: does not say what the columns") as told:
        read_record(run)
    assert "Error" not in str(told.value)


def test_a_run_without_its_site_file_is_refused(run):
    (run / "site.yaml").unlink()
    with pytest.raises(PlantError, match=r"site.yaml: is not there, empty, or closed to you; put"):
        read_record(run)


def test_a_folder_whose_name_breaks_lines_is_told_on_one(run):
    strange = run.rename(run.with_name("ru\nn\x1b[31m"))
    for window in ("@3..9", "@6000..6100"):
        with pytest.raises(PlantError) as told:
            read_record(f"{strange}{window}")
        assert "ru\\nn\\x1b[31m" in str(told.value)
        assert "\n" not in str(told.value)


def test_a_run_of_an_older_recorder_is_refused_by_the_columns_it_lacks(run):
    rename(run, "periods_count", "other")
    with pytest.raises(PlantError, match="has no column periods_count"):
        read_record(run)


def test_a_window_that_is_too_short_says_so(run):
    said = r"no 20 s of the running line without a break, (5\.98|6) s at most: the window is too"
    with pytest.raises(PlantError, match=said):
        read_record(f"{run}@3..9")


def test_a_refusal_says_which_segments_are_gone(run):
    first, *others = sorted(run.glob("signals-*"))
    others[0].unlink()
    for segment in others[1:]:
        segment.write_bytes(b"")
    with pytest.raises(PlantError, match=r"segment 2: not there; signals-0003.csv.gz: holds no"):
        read_record(f"{run}@1..")
    first.unlink()
    with pytest.raises(PlantError, match="no segment of the run holds a row"):
        read_record(run)


def test_a_clock_that_is_set_back_in_the_middle_is_named(run):
    segment = sorted(run.glob("signals-*"))[1]
    head, *rows = gzip.decompress(segment.read_bytes()).decode().splitlines()
    before_s, after_s = (float(rows[k].partition(",")[0]) for k in (499, 500))
    for k in range(500, len(rows)):
        at, _, rest = rows[k].partition(",")
        rows[k] = f"{float(at) - 100.0:.10g},{rest}"
    segment.write_bytes(gzip.compress("\n".join([head, *rows, ""]).encode()))
    record = read_record(run)
    assert said_of(
        record, f"its clock goes back, from {before_s:.2f} s to {after_s - 100.0:.2f} s"
    )
    assert said_of(record, "500 rows are of a time before 0 s; left out")


def test_a_site_file_of_another_run_is_named_by_the_channel_that_is_not_there(run):
    site = run / "site.yaml"
    site.write_text(site.read_text().replace("pullroll_tension_N", "other_tension_N"))
    assert said_of(read_record(run), "other_tension_N: its site.yaml maps it, the run has no such")


def test_a_site_file_of_another_line_is_refused_with_both_names(run):
    site = run / "site.yaml"
    site.write_text(site.read_text().replace("name: Euclid", "name: Film"))
    with pytest.raises(
        PlantError, match=r"site.yaml is of line Film, its run.yaml of Euclid; put"
    ):
        read_record(run)


def test_a_segment_of_another_cycle_is_left_out_and_its_hole_named(run):
    at_cycle(run, "signals-0002.csv.gz", 0.5)
    cycle = "signals-0002.csv.gz: a tick takes 10 ms in it, 20 ms in the others"
    with pytest.raises(PlantError, match=f"{cycle}.*nothing was read for 20 s"):
        read_record(run)  # no part of 20 s is left


def test_a_run_of_another_cycle_than_its_site_file_is_named(run):
    site = run / "site.yaml"
    site.write_text(site.read_text().replace("cycle_ms: 20", "cycle_ms: 10"))
    assert said_of(read_record(run), "a tick takes 20 ms, its site.yaml says 10 ms")


def test_what_is_no_record_is_refused_with_what_was_meant(run):
    for name, said in (
        (f"{run}@20", r"times of a run are written RUN_DIR@FROM\.\.TO"),
        (
            run.parent,
            r"a folder of runs, name one of them, such as .*\); name one that has run\.yaml",
        ),
        (run / "nowhere", "is not there; give"),
        (run / "run.yaml", "unknown kind of file"),
    ):
        with pytest.raises(PlantError, match=f"(?i){said}"):
            read_record(name)


def test_no_last_digit_of_a_filled_hole_is_said_to_be_a_resolution(run):
    cut(run, 1, 250, 400)
    for said in said_of(read_record(f"{run}@3..45"), "is read in steps of"):
        assert "e-1" not in said


def test_a_channel_for_the_record_alone_that_is_missing_for_long_is_left_out_and_ends_no_piece(
    whole, run
):
    blank(run, "swrap_follower_speed_m_s", 100, 150)
    record = read_record(run)
    assert record.duration_s == whole.duration_s
    assert "swrap_follower_speed_m_s" not in record.columns
    (said,) = said_of(record, "swrap_follower_speed_m_s is left out")
    assert "is missing from 2.00 s to 3.02 s of the run" in said


def test_of_a_channel_for_the_record_alone_the_share_that_is_bridged_is_said(run):
    for segment in run.glob("signals-*"):
        blank_some(segment, "swrap_follower_speed_m_s", range(3), 10)
    record = read_record(f"{run}@1..23")
    (said,) = said_of(record, "swrap_follower_speed_m_s: ")
    assert said.endswith(
        ": 30 % of its readings are no numbers and bridged between their neighbours"
    )


def test_a_reading_that_the_correction_waits_for_and_is_missing_for_long_ends_a_piece(run):
    blank(run, "unwind_tension_N", 100, 150)
    assert said_of(read_record(run), "nothing was read for 1")


def test_a_roll_whose_number_is_missing_is_said_and_ends_no_piece(whole, run):
    blank(run, "roll_id", 100, 150)
    record = read_record(run)
    assert record.duration_s == whole.duration_s
    assert said_of(record, "roll_id is no number in 5")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("name: Euclid", "name: Film", "a site file of line Film: no live edit does that"),
        ("scale: 0.02 mm", "scale: 0.2 mm", "a site file with other channels (unwind_radius_m)"),
        ("rolls:", "rolls: 7 #", "a site file that cannot be read"),
    ],
)
def test_a_site_file_in_the_middle_that_no_live_edit_makes_is_named(run, old, new, said):
    text = (run / "site.yaml").read_text()
    assert old in text
    later = "a" * 12
    (run / f"site-{later}.yaml").write_text(text.replace(old, new, 1))
    with (run / "events.csv").open("a") as file:
        file.write(f'0.1,,,CONFIG_APPLIED,,"a1: site {"b" * 12}; began"\n')
        file.write(f'12.0,,,CONFIG_APPLIED,,"b1: site {later}; by hand"\n')
    assert said_of(read_record(run), f"from 12.0 s on the run has {said}")
