"""Rows of drives in a store: kept with their hours, bounded, and not in an older store."""

import duckdb
import numpy as np
import pytest

from aff_runtime.app.report.parquet import table, write_parquet
from aff_runtime.app.report.watching import store as stores
from aff_runtime.app.report.watching.run_hours import HourRead
from aff_runtime.app.report.watching.store import VERSION, load_store, save_store
from aff_runtime.app.report.watching.tables import DRIVE_FIELDS, HOUR_FIELDS, ORDER_FIELDS
from tests.aff_runtime.app.report.watching.made_store import drive, hour, made_store


def test_rows_of_drives_are_kept_with_their_hour_and_bounded_with_it(tmp_path, monkeypatch):
    store = made_store(8)
    store.drives = table(DRIVE_FIELDS, [drive(day, friction_N_m=0.1 * day) for day in range(8)])
    save_store(tmp_path, store)
    mean, unit = duckdb.sql(
        f"select avg(friction_N_m), max(roll) from '{tmp_path}/drives.parquet'"
    ).fetchone()
    assert (mean, unit) == (pytest.approx(0.35), "unwind")
    again = load_store(tmp_path)
    assert again.drives["friction_N_m"].tolist() == pytest.approx(0.1 * np.arange(8))
    monkeypatch.setattr(stores, "MOST_ORDERS", 6)
    again._replace("run-7", [HourRead(hour=hour(7), orders=(), drives=(drive(7), drive(7)))])
    assert set(again.drives["run_id"]) <= set(again.hours["run_id"])
    assert again.drives["hour"].size <= 6
    (tmp_path / "drives.parquet").unlink()  # moved away: its hours are to be read again
    assert load_store(tmp_path, begin=True).hours["hour"].size == 0


def test_a_store_of_the_release_before_is_read_on_without_what_it_lacks(tmp_path):
    store = made_store(3)
    save_store(tmp_path, store)
    older = [column for column in ORDER_FIELDS if column.name != "supplier"]
    about = {"line": store.line, "version": VERSION}
    write_parquet(tmp_path / "orders.parquet", older, store.orders, about)
    write_parquet(tmp_path / "hours.parquet", HOUR_FIELDS, store.hours, about)
    (tmp_path / "drives.parquet").unlink()
    again = load_store(tmp_path)
    assert again.orders["supplier"].tolist() == [0] * store.orders["hour"].size
    assert again.drives["hour"].size == 0
