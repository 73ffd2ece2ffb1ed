"""A store of runs: nothing counts twice, nothing is half written, and it keeps to its bound."""

import gzip
import math
import os
import re
import shutil
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import duckdb
import numpy as np
import pandas as pd
import pyarrow.parquet
import pytest

from aff_runtime.app.report.watching import store as stores
from aff_runtime.app.report.watching.run_hours import run_hours
from aff_runtime.app.report.watching.store import FILES, Store, load_store, lock_store, save_store
from aff_runtime.app.report.watching.tables import DRIVE_FIELDS, HOUR_FIELDS, ORDER_FIELDS
from aff_runtime.base.errors import AffError, ConfigError
from tests.doubles.virtual_weeks import BEGAN, KM_A_DAY, SPEED_M_S, Weeks, write_weeks

DAYS = 4
WEEKS = Weeks(r6_m=lambda km, _: 4e-5 + 1e-8 * km)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    return list(write_weeks(WEEKS, tmp_path_factory.mktemp("runs"), range(DAYS)))


def of(*folders):
    store = Store()
    for folder in folders:
        store.add(run_hours(folder))
    return store


def stroke(store):
    chosen = (store.orders["roll"] == "r6") & np.isfinite(store.orders["stroke_m"])
    return store.orders["stroke_m"][chosen]


def assert_same(first, second):
    for name in ("hours", "orders", "exchanges"):
        one, other = getattr(first, name), getattr(second, name)
        for column, values in one.items():
            np.testing.assert_array_equal(values, other[column], err_msg=column)


def test_a_run_gives_its_hours_and_what_each_roller_was(runs):
    store = of(*runs)
    assert store.line == "Weeks"
    assert store.hours["hour"].tolist() == [0, 9] * DAYS  # those between are deleted
    assert np.nansum(store.hours["length_m"]) == pytest.approx(DAYS * 1e3 * KM_A_DAY, rel=1e-4)
    sizes = [4e-5 + 1e-8 * day * KM_A_DAY for day in range(DAYS)]
    np.testing.assert_allclose(stroke(store), sizes, rtol=2e-4)
    first = store.orders["roll"] == "r6"
    assert store.orders["frequency_Hz"][first][0] == pytest.approx(
        SPEED_M_S / 0.0381 / math.tau, rel=1e-3
    )
    assert store.orders["noise_N"][first][0] == pytest.approx(0.05, rel=0.1)
    assert store.orders["limit_m"][first][0] == pytest.approx(
        0.002 / (SPEED_M_S / 0.0381), rel=1e-3
    )
    assert 200.0 <= store.hours["tick_p50_us"][0] <= store.hours["tick_p99_us"][0] <= 220.0


def test_the_web_that_ran_counts_from_run_to_run(runs):
    travelled = of(*runs).orders["travelled_km"]
    np.testing.assert_allclose(
        travelled.reshape(DAYS, -1)[:, 0], [d * KM_A_DAY + 0.02 for d in range(DAYS)], atol=2e-3
    )


def test_the_order_in_which_runs_are_given_does_not_matter(runs):
    assert_same(of(*runs), of(*reversed(runs)))


def test_a_run_that_is_in_the_store_or_a_copy_of_it_is_not_counted_again(runs, tmp_path):
    store, before = of(*runs), of(*runs)
    copy = shutil.copytree(runs[1], tmp_path / "copy_of_it")
    assert store.add(run_hours(runs[0])).new == 0
    assert store.add(run_hours(copy)).known == 2
    assert_same(store, before)


def test_a_run_that_was_still_being_recorded_gives_what_is_new_of_it(runs, tmp_path):
    young = shutil.copytree(runs[0], tmp_path / runs[0].name)
    last = sorted(young.glob("signals-*"))[-1]
    rest = last.rename(tmp_path / "later")
    store = of(young)
    assert store.hours["covered_s"].tolist() == pytest.approx([40.0], abs=0.1)
    rest.rename(last)
    assert store.add(run_hours(young)).new == 1  # an hour that it did not have yet
    assert np.sum(store.hours["length_m"]) == pytest.approx(1e3 * KM_A_DAY, rel=1e-4)
    assert_same(of(runs[0], young), of(runs[0]))


def test_an_hour_of_which_there_is_more_now_takes_the_place_of_what_was_read(runs):
    part, whole = run_hours(runs[0]), run_hours(runs[0])
    hour = replace(part.hours[0], to_s=30.0, web_to_s=30.0)
    store = Store()
    store.add(replace(part, hours=(hour,)))
    assert store.orders["turns"].max() < of(runs[0]).orders["turns"].max()
    assert store.add(whole).new == 2
    assert_same(store, of(runs[0]))


def test_a_run_that_has_lost_segments_since_does_not_take_its_hours_away(runs, tmp_path):
    store, old = of(runs[0]), shutil.copytree(runs[0], tmp_path / "run")
    min(old.glob("signals-*")).unlink()
    assert store.add(run_hours(old)).new == 0
    assert_same(store, of(runs[0]))


def test_a_folder_begun_later_by_the_same_clock_is_where_it_was_on_the_day(runs, tmp_path):
    """After new columns the rows go on counting from the start of the control process."""
    late = shutil.copytree(runs[0], tmp_path / "run")
    first, last = sorted(late.glob("signals-*"))
    first.unlink()
    last.rename(first)  # its first segment, whose first row is at 36000 s
    found = run_hours(late)
    moment = found.read(found.hours[0]).hour.time_utc
    assert abs(moment - np.datetime64(BEGAN.replace(tzinfo=None))) < np.timedelta64(1, "s")


def test_a_run_of_another_line_is_named_and_nothing_of_it_taken(runs, tmp_path):
    other = shutil.copytree(runs[1], tmp_path / "run")
    for name in ("site.yaml", "run.yaml"):
        (other / name).write_text((other / name).read_text().replace("Weeks", "Other"))
    store = of(runs[0])
    with pytest.raises(ConfigError, match="a run of line Other, the store is of Weeks"):
        store.add(run_hours(other))
    assert_same(store, of(runs[0]))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("segment_s: 40.0", "segment_s: 1.0e+300"),
        ("segment_s: 40.0", "segment_s: [40]"),
        ("segment_s: 40.0", "segment_s: -1"),
        ("start_utc: '2026-01", "start_utc: '9999-01"),
    ],
)
def test_odd_numbers_of_a_run_add_few_hours(runs, tmp_path, old, new):
    odd = shutil.copytree(runs[0], tmp_path / "run")
    text = (odd / "run.yaml").read_text()
    assert old in text
    (odd / "run.yaml").write_text(text.replace(old, new))
    assert 1 <= of(odd).hours["hour"].size <= 3


@pytest.mark.parametrize("start", ["0001-01-01T00:00:00+14:00", "", "yesterday", "2026-13-01"])
def test_a_start_that_no_clock_shows_is_named(runs, tmp_path, start):
    odd = shutil.copytree(runs[0], tmp_path / "run")
    text = (odd / "run.yaml").read_text()
    (odd / "run.yaml").write_text(re.sub(r"start_utc: .*", f"start_utc: '{start}'", text))
    with pytest.raises(AffError, match="without it nobody knows when the run was"):
        run_hours(odd)


def test_a_run_by_a_clock_that_was_not_set_is_left_out(runs, tmp_path):
    """One reading of 1970 beside those of a week would be all that a slope goes by."""
    odd = shutil.copytree(runs[0], tmp_path / "run")
    text = (odd / "run.yaml").read_text()
    (odd / "run.yaml").write_text(text.replace("start_utc: '2026-01", "start_utc: '1970-01"))
    with pytest.raises(AffError, match=r"began on 1970-01-0. by a clock that was not set yet"):
        run_hours(odd)


@pytest.mark.parametrize("time", ["1e300", "-1e18", "5e8"])
def test_a_row_at_no_time_of_a_run_adds_at_most_its_own_hour(runs, tmp_path, time):
    odd = shutil.copytree(runs[0], tmp_path / "run")
    last = sorted(odd.glob("signals-*"))[-1]
    head, row, *_ = gzip.decompress(last.read_bytes()).decode().splitlines()
    cells = row.split(",")
    last.write_bytes(gzip.compress("\n".join([head, ",".join([time, *cells[1:]]), ""]).encode()))
    assert of(odd).hours["hour"].size <= 3


def test_what_is_written_is_read_back(runs, tmp_path):
    store = of(*runs)
    store.exchange("r6", BEGAN + timedelta(days=2), "worn")
    save_store(tmp_path, store)
    assert_same(load_store(tmp_path), store)
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(FILES.values())
    assert_same(load_store(tmp_path / "nowhere", begin=True), Store())


def test_a_write_that_fails_leaves_the_store_as_it_was(runs, tmp_path, monkeypatch):
    save_store(tmp_path, of(runs[0]))
    before = {name: (tmp_path / name).read_bytes() for name in FILES.values()}

    def full(_descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(ConfigError, match="No space left on device"):
        save_store(tmp_path, of(*runs))
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == before


def test_rows_that_a_crash_left_without_their_hour_do_not_count(runs, tmp_path):
    save_store(tmp_path, of(runs[0]))
    hours = (tmp_path / "hours.parquet").read_bytes()
    save_store(tmp_path, of(*runs))
    (tmp_path / "hours.parquet").write_bytes(hours)  # it is written last
    assert_same(load_store(tmp_path), of(runs[0]))


@pytest.mark.parametrize("content", [b"", b"PAR1 and nothing", b"time_s,tick\n0,1\n"])
def test_a_file_that_is_no_table_is_named(tmp_path, content):
    (tmp_path / "hours.parquet").write_bytes(content)
    with pytest.raises(ConfigError, match=r"hours.parquet: cannot be read \("):
        load_store(tmp_path)


@pytest.mark.parametrize("broken", ["hours", "orders"])
def test_a_table_that_broke_is_moved_away_and_read_anew_with_the_exchanges_kept(
    runs, tmp_path, broken
):
    store = of(*runs)
    store.exchange("r6", datetime(2026, 1, 6, tzinfo=UTC), "serial 4711")
    save_store(tmp_path, store)
    path = tmp_path / f"{broken}.parquet"
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(ConfigError, match=rf"{broken}.parquet: cannot be read.*Move it away"):
        load_store(tmp_path)
    path.unlink()
    again = load_store(tmp_path, begin=True)
    assert again.line == store.line
    for run in runs:
        again.add(run_hours(run))
    assert again.exchanges["why"].tolist() == ["serial 4711"]
    for name, values in store.orders.items():
        np.testing.assert_array_equal(again.orders[name], values)


def test_a_second_command_on_the_same_store_is_refused(tmp_path):
    with (
        lock_store(tmp_path),
        pytest.raises(ConfigError, match=r"another .* is at it"),
        lock_store(tmp_path),
    ):
        pass
    with lock_store(tmp_path):
        pass


def test_a_run_folder_is_no_place_for_a_store(tmp_path):
    (tmp_path / "run.yaml").write_text("columns: [time_s]\n")
    said = r"is a run folder, and no store; .*watch add STORE RUN_DIR"
    with pytest.raises(ConfigError, match=said), lock_store(tmp_path):
        pass
    assert [path.name for path in tmp_path.iterdir()] == ["run.yaml"]


def test_above_the_bound_every_second_old_hour_goes_and_its_web_stays(runs, monkeypatch):
    whole = of(*runs)
    monkeypatch.setattr(stores, "MOST_HOURS", 6)
    store = of(*runs)
    assert store.hours["hour"].size <= 6
    assert np.sum(store.hours["length_m"]) == pytest.approx(np.sum(whole.hours["length_m"]))
    newest = store.hours["time_utc"] >= store.hours["time_utc"][-3]
    kept = np.isin(whole.hours["time_utc"], store.hours["time_utc"][newest])
    np.testing.assert_allclose(
        store.hours["travelled_km"][newest], whole.hours["travelled_km"][kept]
    )
    assert set(store.orders["hour"]) <= set(store.hours["hour"])


def test_what_was_thinned_out_is_not_taken_again(runs, monkeypatch):
    monkeypatch.setattr(stores, "MOST_HOURS", 6)
    store = of(*runs)
    before = np.sum(store.hours["length_m"])
    taken = store.add(run_hours(runs[0]))
    assert (taken.new, taken.known + taken.too_old) == (0, 2)
    assert taken.too_old > 0
    assert np.sum(store.hours["length_m"]) == pytest.approx(before)


def test_an_exchange_numbers_the_lives_of_its_roller_alone(runs):
    store = of(*runs)
    store.exchange("r6", BEGAN + timedelta(days=2), "")
    store.exchange("r6", BEGAN + timedelta(days=2), "told twice")
    lives = {
        r: store.orders["life"][store.orders["roll"] == r].tolist() for r in ("r6", "healthy")
    }
    assert lives == {"r6": [1, 1, 2, 2], "healthy": [1, 1, 1, 1]}
    with pytest.raises(
        ConfigError, match="R7: the store knows no such roller; it knows healthy, r6"
    ):
        store.exchange("R7", BEGAN, "")


def test_duckdb_reads_a_store_as_it_is(runs, tmp_path):
    save_store(tmp_path, of(*runs))
    rows = duckdb.sql(
        "select o.roll, count(*), 1e6 * max(o.stroke_m), max(h.travelled_km) "
        f"from '{tmp_path}/orders.parquet' o join '{tmp_path}/hours.parquet' h "
        "using (run_id, hour) where o.correcting group by o.roll order by o.roll"
    ).fetchall()
    assert [row[:2] for row in rows] == [("healthy", DAYS), ("r6", DAYS)]
    assert rows[1][2] == pytest.approx(40.0 + 1e-2 * 3 * KM_A_DAY, rel=1e-3)
    units = duckdb.sql(f"select * from '{tmp_path}/orders.parquet'")
    assert str(dict(zip(units.columns, units.types, strict=True))["time_utc"]).startswith(
        "TIMESTAMP"
    )


def test_pandas_reads_a_store_as_it_is_with_units_in_the_metadata(runs, tmp_path):
    save_store(tmp_path, of(*runs))
    frame = pd.read_parquet(tmp_path / "orders.parquet")
    assert frame["supplier"].tolist() == [0] * (2 * DAYS)  # these runs have none
    assert frame["stroke_m"].notna().sum() == 2 * DAYS
    assert str(frame["time_utc"].dt.tz) == "UTC"
    for name, layout in (
        ("hours", HOUR_FIELDS),
        ("orders", ORDER_FIELDS),
        ("drives", DRIVE_FIELDS),
    ):
        schema = pyarrow.parquet.read_schema(tmp_path / f"{name}.parquet")
        said = {f.name: (f.metadata or {}).get(b"unit", b"").decode() for f in schema}
        assert said == {column.name: column.unit for column in layout}
        assert {said[n] for n in said if n.endswith("_N")} <= {"N"}
        assert all(said[n] for n in schema.names if n.endswith(("_m", "_s", "_N", "_us", "_km")))
