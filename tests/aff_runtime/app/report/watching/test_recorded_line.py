"""What the store takes from a line in virtual time, against what the plant has."""

import duckdb
import numpy as np
import pandas as pd
import pytest
from pyarrow.parquet import read_schema as schema_of

from aff_runtime.app.report.comparison.window import window_of
from aff_runtime.app.report.run_export import export_run
from aff_runtime.app.report.watching.drive_rows import drive_rows
from aff_runtime.app.report.watching.order_rows import order_rows
from aff_runtime.app.report.watching.run_hours import run_hours
from aff_runtime.app.report.watching.store import Store
from aff_runtime.base.runs.table import read_table
from aff_runtime.base.runs.window import RunWindow
from aff_runtime.base.signals import State
from sim_plant.line.reading.load import load_declaration
from sim_plant.servers.extra_words import ExtraWords
from tests.aff_runtime.app.report.watching.made_store import hour
from tests.doubles.recorded_run import LINE_FILE, RecordedRun, files

pytestmark = pytest.mark.timeout(300)


def eccentric(size_m):
    return {
        "effect": "eccentric_roller",
        "location": "R6",
        "parameters": {"eccentricity_m": size_m, "angle_rad": 0.5},
    }


def recorded(folder, size_m, seconds=27.0, cycle_ms=5):
    """Return a run on the demo's line, AFF on with a block for R6 after one second."""
    made = files(folder, [eccentric(size_m)], cycle_ms=cycle_ms, for_record=True)
    run = RecordedRun(made, folder / "runs", law_too=True)
    run.bench.run(1.0)
    run.bench.arm(seconds - 1.0)
    return run.end()


@pytest.fixture(scope="module")
def short_run(tmp_path_factory):
    return recorded(tmp_path_factory.mktemp("run"), 1e-4, 16.0, 10)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    return [recorded(tmp_path_factory.mktemp("run"), size_m) for size_m in (1e-4, 2e-4)]


def of(run):
    store = Store()
    store.add(run_hours(run))
    return store


def r6(store, column):
    chosen = (store.orders["roll"] == "r6") & (store.orders["signal"] == "unwind_tension_N")
    return float(store.orders[column][chosen][0])


@pytest.mark.long
def test_the_stroke_is_proportional_to_the_eccentricity_though_its_ripple_is_cancelled(runs):
    once, twice = map(of, runs)
    assert r6(twice, "stroke_m") == pytest.approx(2.0 * r6(once, "stroke_m"), rel=0.03)
    assert 1e-4 < r6(once, "stroke_m") < 4e-4  # two spans, and a drive that follows 4 Hz in part
    assert r6(once, "ripple_N") < 0.1
    assert once.orders["correcting"].all()
    assert once.orders["is_roll"][once.orders["roll"] == "unwind"].all()
    assert not once.orders["is_roll"][once.orders["roll"] == "r6"].any()
    assert np.isnan(once.orders["stroke_m"][once.orders["roll"] == "unwind"]).all()


def test_duckdb_and_pandas_read_the_records_of_the_demos_line_with_their_units(
    short_run, tmp_path
):
    path = tmp_path / "run.parquet"
    rows, lost = export_run(RunWindow(folder=short_run), path)
    assert (rows, lost) == (16 * 100, ())
    columns = read_table(RunWindow(folder=short_run)).columns
    frame = pd.read_parquet(path)
    for name, values in columns.items():
        np.testing.assert_array_equal(frame[name], values)
    speed, error = duckdb.sql(
        f"""select avg(line_speed_m_s), stddev(unwind_tension_N - tension_ref_N) from '{path}'
        where state = {int(State.ACTIVE)} and time_s > 10"""
    ).fetchone()
    assert speed == pytest.approx(1.0, abs=0.002)
    assert error == pytest.approx(0.25, rel=0.1)  # the cell's noise: what repeats is cancelled
    units = {f.name: (f.metadata or {}).get(b"unit", b"").decode() for f in schema_of(path)}
    bare = {name for name, unit in units.items() if not unit}
    assert {units["unwind_tension_N"], units["line_speed_m_s"]} == {"N", "m/s"}
    assert units["unwind.r6_1x.amplitude_m_s"] == "m/s"
    assert units["unwind_torque_N_m"] == "N m"
    assert set(frame["unwind_supplier_number"]) == {ExtraWords(None, ()).supplier}
    counts = {
        "unwind_supplier_number",
        "tick",
        "periods_count",
        "fresh",
        "plc_heartbeat",
        "roll_id",
        "echo_age",
    }
    words = {"state", "state_bits", "alarm", "outcome", "status", "missed_count"}
    assert {name for name in bare if "." not in name} == counts | words
    assert units["unwind.r6_1x.ripple"] == units["unwind.r6_1x.ripple_before"] == "N"
    of_law = {name.rpartition(".")[2] for name in bare if "." in name}
    assert of_law == {"state", "source", "quality"}


def friction_to_the_cell_N_m(speed_m_s, radius_m):
    """The declared friction of the unwind and of the idlers up to the middle of R9's cell."""
    rollers = {one.name: one for one in load_declaration(LINE_FILE).rollers}

    def friction(name, turns_rad_s):
        one = rollers[name]
        constant = one.friction_constant_N_m * np.tanh(turns_rad_s / 0.3)
        return constant + one.friction_viscous_N_m_s * turns_rad_s

    idlers = [f"R{k}" for k in range(1, 10)]
    drag = [friction(k, speed_m_s / rollers[k].radius_m) / rollers[k].radius_m for k in idlers]
    return friction("unwind", speed_m_s / radius_m) + radius_m * (sum(drag) - 0.5 * drag[-1])


def test_friction_and_supplier_of_the_record_are_those_of_the_plant(short_run):
    window = window_of(read_table(RunWindow(folder=short_run, from_s=6.0)))
    (drive,) = drive_rows(window, hour(0))
    assert (drive.roll, drive.signal, drive.is_roll) == ("unwind", "unwind_torque_N_m", True)
    assert drive.speed_rad_s == pytest.approx(1.0 / drive.radius_m, rel=0.01)
    there = friction_to_the_cell_N_m(1.0, drive.radius_m)
    assert 0.0 < drive.friction_error_N_m < 0.1 * there
    assert abs(drive.friction_N_m - there) < 3.0 * drive.friction_error_N_m
    assert drive.torque_N_m == pytest.approx(drive.web_N_m + drive.friction_N_m)
    whole = window_of(read_table(RunWindow(folder=short_run)))
    first = next(row for row in order_rows(whole, hour(0)) if row.roll == "unwind")
    assert first.supplier == ExtraWords(None, ()).supplier
