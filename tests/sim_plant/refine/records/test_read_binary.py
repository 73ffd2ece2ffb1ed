"""Parquet and MDF4 files written by their own packages."""

import numpy as np
import pyarrow
import pyarrow.parquet
import pytest
from asammdf import MDF, Signal

from aff_runtime.base.errors import PlantError
from sim_plant.refine.records import read
from sim_plant.refine.records.mdf_table import mdf_table
from sim_plant.refine.records.parquet_table import parquet_table
from sim_plant.refine.records.read import read_record

ROWS = 400
STAMPS = np.round(0.01 * np.arange(ROWS), 4)
FORCE = 90.0 + np.sin(STAMPS)


@pytest.fixture
def in_this_process(monkeypatch):
    """Have asammdf, which is imported here anyway, read in this process and not in a child."""
    monkeypatch.setattr(
        read, "table_from_child", lambda path, _, payload: mdf_table(path, payload)
    )


def parquet(path, *fields):
    names, arrays, units = zip(*fields, strict=True)
    schema = [
        pyarrow.field(n, a.type, metadata={"unit": u} if u else None)
        for n, a, u in zip(names, arrays, units, strict=True)
    ]
    pyarrow.parquet.write_table(pyarrow.table(list(arrays), pyarrow.schema(schema)), path)
    return path


def mdf(path, *groups):
    with MDF(version="4.10") as file:
        for group in groups:
            file.append(list(group))
        file.save(path, overwrite=True)
    return path


def signal(name, unit="", stamps=STAMPS, samples=None, **more):
    values = FORCE[: stamps.size] if samples is None else samples
    return Signal(samples=values, timestamps=stamps, name=name, unit=unit, **more)


def test_parquet_units_stand_in_the_name_or_in_the_fields_metadata(tmp_path):
    path = parquet(
        tmp_path / "r.parquet",
        ("time [ms]", pyarrow.array(1e3 * STAMPS), ""),
        ("unwind_tension", pyarrow.array(FORCE), "lbf"),
        ("count", pyarrow.array(np.arange(ROWS, dtype=np.int32)), ""),
    )
    record = read_record(path)
    assert record.sample_time_s == pytest.approx(0.01)
    np.testing.assert_allclose(record.columns["unwind_tension_N"], 4.4482216152605 * FORCE)
    np.testing.assert_array_equal(record.columns["count"], np.arange(ROWS))


def test_parquet_time_of_day_becomes_seconds_from_the_first_row(tmp_path):
    stamps = np.datetime64("2026-03-01T10:00:00") + (1e6 * STAMPS).astype("timedelta64[us]")
    path = parquet(
        tmp_path / "r.parquet",
        ("time", pyarrow.array(stamps), ""),
        ("unwind_tension_N", pyarrow.array(FORCE), ""),
    )
    record = read_record(path)
    assert record.sample_time_s == pytest.approx(0.01)
    assert record.samples == ROWS


def test_a_parquet_null_is_a_missing_value_with_its_row(tmp_path):
    values = [*FORCE[:50], None, *FORCE[51:]]
    path = parquet(
        tmp_path / "r.parquet",
        ("time_s", pyarrow.array(STAMPS), ""),
        ("unwind_tension_N", pyarrow.array(values), ""),
    )
    with pytest.raises(PlantError, match="1 value is missing or not a number, in row 51"):
        read_record(path)


def test_a_parquet_column_of_words_is_refused(tmp_path):
    path = parquet(
        tmp_path / "r.parquet",
        ("time_s", pyarrow.array(STAMPS), ""),
        ("state", pyarrow.array(["run"] * ROWS), ""),
    )
    with pytest.raises(PlantError, match="column state holds string; expected numbers"):
        read_record(path)


def test_mdf_channels_start_at_zero_seconds_in_si(tmp_path):
    path = mdf(tmp_path / "r.mf4", [signal("unwind_tension", "lbf", STAMPS + 55.0)])
    record = read_record(path)
    assert record.sample_time_s == pytest.approx(0.01)
    np.testing.assert_allclose(record.columns["unwind_tension_N"], 4.4482216152605 * FORCE)


@pytest.mark.usefixtures("in_this_process")
def test_a_unit_that_is_given_beats_the_one_in_the_name(tmp_path):
    path = mdf(tmp_path / "r.mf4", [signal("unwind_tension_N", "lbf")])
    found = read_record(path).columns["unwind_tension_N"]
    np.testing.assert_allclose(found, 4.4482216152605 * FORCE)


@pytest.mark.usefixtures("in_this_process")
def test_a_slower_mdf_group_is_put_on_the_stamps_of_the_fastest_and_said(tmp_path):
    slow = np.round(0.04 * np.arange(ROWS // 4), 4)
    path = mdf(
        tmp_path / "r.mf4",
        [signal("unwind_tension_N")],
        [signal("rewind_tension_N", "", slow, samples=2.0 * slow)],
    )
    record = read_record(path)
    np.testing.assert_allclose(record.columns["rewind_tension_N"][:397], 2.0 * STAMPS[:397])
    assert "rewind_tension_N has stamps of its own" in record.findings[0]


@pytest.mark.usefixtures("in_this_process")
def test_an_mdf_group_whose_stamps_go_back_is_refused(tmp_path):
    odd = np.round(0.04 * np.arange(ROWS // 4), 4)
    odd[50:60] = odd[59:49:-1].copy()
    path = mdf(
        tmp_path / "r.mf4",
        [signal("unwind_tension_N")],
        [signal("rewind_tension_N", "", odd, samples=2.0 * odd)],
    )
    with pytest.raises(PlantError, match="stamps of channel rewind_tension_N stand still or go"):
        read_record(path)


@pytest.mark.usefixtures("in_this_process")
def test_an_mdf_group_of_another_stretch_is_refused(tmp_path):
    path = mdf(
        tmp_path / "r.mf4",
        [signal("unwind_tension_N")],
        [signal("rewind_tension_N", "", STAMPS[:100])],
    )
    with pytest.raises(PlantError, match=r"rewind_tension_N runs from 0 s to 0.99 s, others"):
        read_record(path)


@pytest.mark.usefixtures("in_this_process")
def test_an_invalidated_mdf_sample_is_a_missing_value(tmp_path):
    bad = np.zeros(ROWS, dtype=bool)
    bad[7] = True
    path = mdf(tmp_path / "r.mf4", [signal("unwind_tension_N", invalidation_bits=bad)])
    with pytest.raises(PlantError, match="1 value is missing or not a number, in row 8"):
        read_record(path)


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("name", ["r.parquet", "r.mf4"])
def test_a_file_of_something_else_is_refused(tmp_path, name):
    (tmp_path / name).write_bytes(b"time_s,unwind_tension_N\n" * 50)
    with pytest.raises(PlantError, match="not a readable"):
        read_record(tmp_path / name)


def test_a_missing_package_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pyarrow.parquet", None)
    with pytest.raises(PlantError, match="pip install pyarrow"):
        parquet_table(tmp_path / "r.parquet", b"")


def columns_of(path, **arrays):
    written = parquet(path, *((name, array, "") for name, array in arrays.items()))
    return parquet_table(written, written.read_bytes())[0]


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        (pyarrow.nulls(3), [np.nan, np.nan, np.nan]),
        (pyarrow.array([True, None, False]), [1.0, np.nan, 0.0]),
        (pyarrow.array([True, True, False]), [1.0, 1.0, 0.0]),
        (pyarrow.array([7, None, -2]), [7.0, np.nan, -2.0]),
        (pyarrow.array([1.5, None, 2.5]), [1.5, np.nan, 2.5]),
    ],
)
def test_a_missing_value_of_any_kind_of_column_is_nan(tmp_path, values, expected):
    found = columns_of(tmp_path / "r.parquet", x=values)["x"]
    assert found.dtype == np.float64
    np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("kind", [pyarrow.timestamp("us"), pyarrow.timestamp("ns", "UTC")])
def test_stamps_count_from_the_first_that_is_there(tmp_path, kind):
    at = [None, 1_000_000, 1_500_000, None, 3_000_000]
    scale = {"us": 1, "ns": 1000}[kind.unit]
    stamps = pyarrow.array([None if t is None else t * scale for t in at], pyarrow.int64())
    (found,) = columns_of(tmp_path / "r.parquet", time=stamps.cast(kind)).values()
    np.testing.assert_allclose(found, [np.nan, 0.0, 0.5, np.nan, 2.0])


def test_a_column_without_one_stamp_is_nan(tmp_path):
    stamps = pyarrow.nulls(3, pyarrow.timestamp("us"))
    (found,) = columns_of(tmp_path / "r.parquet", time=stamps).values()
    assert np.isnan(found).all()
