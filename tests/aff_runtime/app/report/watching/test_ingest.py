"""Runs are taken hour by hour: one that ends early keeps what was read and goes on there."""

import gzip
import re
import shutil
import signal
from dataclasses import replace

import numpy as np
import pytest

from aff_runtime.app.report.watching import ingest
from aff_runtime.app.report.watching import run_hours as run_hours_module
from aff_runtime.app.report.watching.run_hours import READ_S, RunHours, run_hours
from aff_runtime.app.report.watching.store import load_store
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.runs import segment as run_segment
from aff_runtime.base.runs import table as run_table
from tests.doubles.virtual_weeks import BEGAN, RADIUS_M, RUN_S, SITE, Weeks, write_run, write_weeks

WEEKS = Weeks(r6_m=lambda km, _: 4e-5 + 1e-8 * km)


class Torn:
    """A run of which an hour cannot be read, the second by default."""

    def __init__(self, run, at=2):
        self._run = run
        self._read = 0
        self._at = at

    def __getattr__(self, name):
        return getattr(self._run, name)

    def read(self, hour):
        self._read += 1
        if self._read == self._at:
            raise ConfigError("segment 2 is torn.")
        return self._run.read(hour)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    return list(write_weeks(WEEKS, tmp_path_factory.mktemp("runs"), range(2)))


def take(folder, runs, said):
    return ingest.ingest_runs(folder, runs, said.append, said.append)


def test_a_run_that_ends_in_the_middle_keeps_what_was_read_and_goes_on_there(
    runs, tmp_path, monkeypatch
):
    said, read = [], []
    monkeypatch.setattr(ingest, "run_hours", lambda folder: Torn(run_hours(folder)))
    found = take(tmp_path / "store", runs[1:], said)
    assert (found.runs, found.refused) == (1, 0)
    assert said[-1].startswith("not to its end: segment 2 is torn. What was read of it is kept")
    assert load_store(tmp_path / "store").hours["hour"].tolist() == [0]
    monkeypatch.undo()
    whole, one_by_one = RunHours.read, lambda run, hour: read.append(hour.hour) or whole(run, hour)
    monkeypatch.setattr(RunHours, "read", one_by_one)
    assert take(tmp_path / "store", runs[1:], said).refused == 0
    assert read == [run_hours(runs[1]).hours[1].hour]  # the first is not read again
    take(tmp_path / "at_once", runs[1:], said)
    found, wanted = (load_store(tmp_path / name) for name in ("store", "at_once"))
    for name in ("hours", "orders"):
        for column, values in getattr(wanted, name).items():
            assert np.array_equal(
                getattr(found, name)[column], values, equal_nan=values.dtype.kind == "f"
            )


def test_a_run_that_takes_too_long_goes_on_where_it_was(runs, tmp_path, monkeypatch):
    whole, read = RunHours.read, []

    def slow(run, hour):
        if read:
            signal.raise_signal(signal.SIGALRM)  # what comes when the time is over
        read.append(hour.hour)
        return whole(run, hour)

    monkeypatch.setattr(RunHours, "read", slow)
    said = []
    take(tmp_path / "store", runs[:1], said)
    assert "takes more than 600 s to read" in said[-1]
    assert load_store(tmp_path / "store").hours["hour"].tolist() == read == [0]


def test_a_first_run_that_fails_does_not_give_the_store_its_line(runs, tmp_path, monkeypatch):
    monkeypatch.setattr(ingest, "run_hours", lambda folder: Torn(run_hours(folder), at=1))
    found = take(tmp_path / "store", runs[:1], [])
    assert found.refused == 1
    assert found.store.line == ""


def test_what_is_wrong_with_the_files_of_an_hour_is_said(runs, tmp_path):
    run = shutil.copytree(runs[0], tmp_path / "run")
    first = sorted(run.glob("signals-*"))[0]
    content = bytearray(first.read_bytes())
    content[-8] ^= 1  # of its checksum
    first.write_bytes(content)
    said = []
    take(tmp_path / "store", [run], said)
    assert any(f"{first.name}: its checksum is not that of its rows" in text for text in said)


def test_a_run_with_the_site_file_of_another_line_is_left_out(runs, tmp_path):
    run = shutil.copytree(runs[0], tmp_path / "run")
    site = run / "site.yaml"
    site.write_text(site.read_text().replace("name: Weeks", "name: Film"))
    said = []
    found = take(tmp_path / "store", [run], said)
    assert (found.refused, found.store.line) == (1, "")
    assert "left out: " in said[-1]
    assert "its site.yaml is of line Film, its run.yaml of Weeks" in said[-1]


SECONDS, PIECE_S = 10_000, 10
"""Of the run below, in segments of so many seconds: hours 0, 1 and a part of 2."""


@pytest.fixture(scope="module")
def in_pieces(runs, tmp_path_factory):
    """A run in 1000 segments of twenty rows."""
    run = shutil.copytree(runs[0], tmp_path_factory.mktemp("pieces") / "run")
    for segment in run.glob("signals-*"):
        head = gzip.decompress(segment.read_bytes()).split(b"\n")[0]
        segment.unlink()
    about = run / "run.yaml"
    about.write_text(
        re.sub(r"(?m)^segment_s: .*$", f"segment_s: {PIECE_S:.1f}", about.read_text())
    )
    rest = b",0" * head.count(b",")
    for number in range(SECONDS // PIECE_S):
        halves = range(2 * PIECE_S * number, 2 * PIECE_S * (number + 1))
        rows = b"".join(b"%.1f%s\n" % (0.5 * half, rest) for half in halves)
        content = gzip.compress(head + b"\n" + rows, compresslevel=1)
        (run / f"signals-{number + 1:04d}.csv.gz").write_bytes(content)
    return run


def test_the_segments_of_a_run_are_looked_at_once(in_pieces, tmp_path, monkeypatch):
    """Each of up to three looks at an hour opened them all again."""
    opened, whole = [], run_segment.open_plain
    monkeypatch.setattr(
        run_segment, "open_plain", lambda path: opened.append(path.name) or whole(path)
    )
    said = []
    assert take(tmp_path / "store", [in_pieces], said).refused == 0
    assert load_store(tmp_path / "store").hours["covered_s"].sum() == pytest.approx(SECONDS, abs=5)
    # at three places of three hours, a segment more at either end
    pieces, looks = SECONDS // PIECE_S, 3 * 3 * (READ_S / PIECE_S + 2)
    assert pieces <= len(opened) <= pieces + looks + 10


@pytest.mark.parametrize(("at_s", "limit_m_s"), [(5.0, 0.004), (RUN_S - 0.1, 0.002)])
def test_the_limit_of_an_order_is_that_of_the_site_file_in_force_in_its_stretch(
    tmp_path, at_s, limit_m_s
):
    """The block's own limit is doubled by a live edit: within the stretch, hours after it."""
    sizes = {"r6": 4e-5, "healthy": 2e-5}
    weeks = Weeks(r6_m=lambda _km, _day: 4e-5)
    run = write_run(weeks, tmp_path, BEGAN, sizes, np.random.default_rng(1))
    text = SITE.replace("amp_limit_m_s: 0.002", "amp_limit_m_s: 0.004")
    (run / "site-bbbbbbbbbbbb.yaml").write_text(text)
    with (run / "events.csv").open("a") as file:
        file.write(f'{0.0},,,CONFIG_APPLIED,,"{"c" * 12}: site {"a" * 12}; unwind: none"\n')
        file.write(f'{at_s},,,CONFIG_APPLIED,,"{"d" * 12}: site {"b" * 12}; unwind: none"\n')
    found = run_hours(run)
    orders = [row for hour in found.hours for row in found.read(hour).orders]
    (limit_m,) = {row.limit_m for row in orders if row.roll == "r6" and np.isfinite(row.stroke_m)}
    assert limit_m == pytest.approx(limit_m_s / (weeks.speed_m_s / RADIUS_M["r6"]), rel=1e-3)


def test_site_files_of_a_run_are_looked_at_once_whatever_is_read_of_it(tmp_path, monkeypatch):
    weeks = Weeks(r6_m=lambda _km, _day: 4e-5)
    sizes = {"r6": 4e-5, "healthy": 2e-5}
    run = write_run(weeks, tmp_path, BEGAN, sizes, np.random.default_rng(1))
    looked = []
    whole = run_table.sites_in_force
    monkeypatch.setattr(
        run_table, "sites_in_force", lambda *given: looked.append(given) or whole(*given)
    )
    found = run_hours(run)
    assert sum(found.read(hour).hour.stretch_s > 0.0 for hour in found.hours) > 0
    assert len(looked) == 1


@pytest.mark.parametrize(
    ("missing_rows", "missed"), [(slice(0, 0), 7.0), (slice(0, 3), 5.0), (slice(None), np.nan)]
)
def test_missed_ticks_are_counted_between_the_rows_that_have_a_number(
    runs, monkeypatch, missing_rows, missed
):
    """They count up by 2, 2 and 3: the first three rows without a number take the first with."""
    whole = run_hours_module.read_table

    def with_counts(window, **more):
        table = whole(window, **more)
        rows = table.columns["time_s"].size
        counts = np.full(rows, 10.0)
        counts[2:] += 2.0
        counts[rows // 10 :] += 2.0
        counts[rows // 9 :] += 3.0
        counts[missing_rows] = np.nan
        return replace(table, columns=table.columns | {"missed_count": counts})

    found = run_hours(runs[0])
    monkeypatch.setattr(run_hours_module, "read_table", with_counts)
    read = found.read(found.hours[0])
    assert read.hour.missed_count == pytest.approx(missed, nan_ok=True)
    assert (run_hours_module.NOT_COUNTED in read.lost) == np.isnan(missed)
