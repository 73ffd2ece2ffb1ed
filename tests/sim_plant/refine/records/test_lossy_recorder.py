"""A recorder that is killed in the middle, or has no disk for a while: what its runs still are."""

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.app.supervisor.recorder_child import RecorderChild
from aff_runtime.base.runs.table import read_table
from aff_runtime.base.runs.window import run_window
from aff_runtime.config.loader import load_recorded_site
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.recorder_messages import RunContext
from aff_runtime.telemetry.ring import RingReader, RingWriter
from sim_plant.demo.loop.drawn import IDLER, drawn, write_files
from sim_plant.refine.records.read import read_record
from tests.aff_runtime.app.card.measure.recorded import recorded, switched
from tests.doubles.recorded_run import PLC_FILE, Files, RecordedRun, files
from tests.processes import kill, until

pytestmark = [pytest.mark.processes, pytest.mark.timeout(300)]
STEP_S, KILLED_S, END_S = 0.005, 21.5, 46.0
KEPT_ROWS, LOST_ROWS = 4096, 600
"""Rows that the ring keeps for a recorder that comes later, and those that it cannot keep."""
FULL_S, ROOM_S = 21.0, 25.0
"""The disk is full from the one to the other."""
BUFFERED_ROWS = 100
"""Rows in half a second: so much of a part may be in a file still, or in none yet."""

ON_WIRES = [pytest.param(wire, marks=pytest.mark.long) for wire in ("modbus", "can")]
"""The rows alone differ."""


@pytest.fixture(scope="module", params=["by formula", *ON_WIRES])
def run(request, tmp_path_factory):
    """A whole run, armed: by a formula; in virtual time on Modbus and on CAN by DBC."""
    folder = tmp_path_factory.mktemp("whole")
    if request.param == "by formula":
        columns, _ = switched(END_S, [(8.0, 18.0)])
        return recorded(folder / "runs", columns)
    made, can_map = files(folder), None
    if request.param == "can":
        on_can = write_files(folder, drawn(IDLER, 1), "can")
        made = Files(line=on_can.plant, site=on_can.site, plc_map=PLC_FILE)
        can_map = on_can.plc
    run = RecordedRun(made, folder / "runs", can_map=can_map)
    run.bench.run(8.0)
    run.bench.arm(10.0)
    run.bench.plant.set_reference("tension_ref_N", 95.0)
    run.bench.run(END_S - 18.0)
    return run.end()


@pytest.fixture(scope="module")
def whole_record(run):
    """The record of the whole run, read once; nobody writes to it."""
    return read_record(run)


# quick of rows lost: demo/loop/test_recorder_kill.py; of a hole in a record: test_run_record.py
TOO_LATE = pytest.param(LOST_ROWS, id="too late", marks=pytest.mark.long)


@pytest.fixture(scope="module", params=[pytest.param(0, id="in time"), TOO_LATE])
def killed(request, run, tmp_path_factory):
    """The same rows through a ring to a recorder that is killed, and to the one that follows.

    Its folder, how many rows were lost, and what the first one had left of it.
    """
    table = read_table(run_window(run))
    rows = list(zip(*table.columns.values(), strict=True))
    runs = tmp_path_factory.mktemp("killed")
    ring, reader = _ring(table)
    at = round(KILLED_S / STEP_S)
    first = _recorder(reader, runs, table.site_text)
    _feed(ring, first, rows[:at])
    kill(first.pid)
    until("the recorder is dead", lambda: not first.report().alive)
    first.wait(0.0)
    left = tmp_path_factory.mktemp("left") / "run"
    shutil.copytree(first.report().folder, left)
    gone = at + KEPT_ROWS - 1 if request.param else at + KEPT_ROWS // 2
    unread = gone + request.param
    for row in rows[at:unread]:
        ring.write(row)
    died = (first.report().folder, first.how_it_ended())
    second = _recorder(reader, runs, table.site_text, *died)
    until("the other goes on", lambda: second.report().rows >= min(unread - at, KEPT_ROWS - 1))
    for row in rows[unread:]:
        ring.write(row)
    ring.close()
    until("the other has ended", lambda: not second.report().alive)
    second.wait(0.0)
    reader.close()
    (folder,) = runs.iterdir()
    return folder, request.param, left


def _ring(table):
    ring = RingWriter(list(table.columns), meta=RunMeta(start_ns=1), capacity=KEPT_ROWS)
    return ring, RingReader(ring.open_for_readers())


def _recorder(reader, runs, site_text, takes_over="", died=""):
    said = {"takes_over": takes_over, "died": died}
    name = load_recorded_site(site_text, "site.yaml").line.name
    context = RunContext(name=name, site_text=site_text, max_MB=50, **said)
    return RecorderChild(reader, runs, context)


def _feed(ring, recorder, rows, fed=0):
    """Write rows no faster than the recorder takes them, which it says once a second."""
    for start in range(0, len(rows), KEPT_ROWS // 2):
        part = rows[start : start + KEPT_ROWS // 2]
        for row in part:
            ring.write(row)
        fed += len(part)
        until("they are taken", lambda n=fed: _taken(recorder.report()) >= n)


def _taken(report):
    return report.rows + report.rows_lost


def test_what_was_written_before_is_a_record_and_it_says_that_its_end_is_missing(
    whole_record, killed
):
    whole, cut = whole_record, read_record(killed[2])
    assert any("the recorder did not end by itself" in text for text in cut.findings)
    assert cut.duration_s == pytest.approx(KILLED_S, abs=0.05)
    for name, values in cut.columns.items():
        assert values == pytest.approx(whole.columns[name][: cut.samples]), name


def test_the_one_that_follows_goes_on_in_the_same_run_and_says_what_was_lost(run, killed):
    folder, lost, _ = killed
    whole, table = (read_table(run_window(path)) for path in (run, folder))
    missing = np.setdiff1d(whole.columns["tick"], table.columns["tick"])
    assert missing.size == lost
    assert set(np.diff(table.columns["tick"])) == ({1.0, lost + 1.0} if lost else {1.0})
    (said,) = [text for text in table.lost if "another one goes on" in text]
    assert "killed by SIGKILL" in said
    words = f"{lost} ticks are lost, nothing is recorded for {(lost + 1) * STEP_S:.3g} s"
    assert said.endswith(words if lost else "no tick is lost")
    counted = [text for text in table.lost if "rows were overwritten before" in text]
    assert counted == (
        [f"{lost} rows were overwritten before the recorder had read them"] * bool(lost)
    )


def test_the_record_is_the_same_as_without_a_death_or_what_is_behind_the_hole(
    whole_record, killed
):
    folder, lost, _ = killed
    whole, record = whole_record, read_record(folder)
    first_s = KILLED_S + lost * STEP_S if lost else 0.0
    assert record.duration_s == pytest.approx(END_S - first_s, abs=0.05)
    if not lost:
        for name, values in record.columns.items():
            assert values == pytest.approx(whole.columns[name]), name
        assert record.sha256 == whole.sha256  # so is all that refine makes of it
        return
    assert any(f"nothing was read for {(lost + 1) * STEP_S:.3g} s" in t for t in record.findings)


@pytest.fixture(scope="module")
def disk(tmp_path_factory):
    """A file system of its own, some MB large."""
    if os.geteuid():
        pytest.skip("only root mounts a file system")
    folder = tmp_path_factory.mktemp("disk")
    mount = ["mount", "-t", "tmpfs", "-o", "size=16m", "tmpfs", str(folder)]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("no file system can be mounted here")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


def _filled(disk):
    """Leave nothing of it; return the file to remove."""
    filler = disk / "filler"
    with filler.open("ab", buffering=0) as file:
        try:
            while file.write(bytes(1 << 20)):
                pass
        except OSError:
            return filler


@pytest.fixture(scope="module")
def short_of_disk(run, disk):
    """The same rows to a recorder whose disk is full for a while; its folder, what it reported."""
    table = read_table(run_window(run))
    rows = list(zip(*table.columns.values(), strict=True))
    ring, reader = _ring(table)
    recorder = _recorder(reader, disk, table.site_text)
    full, room = (round(at / STEP_S) for at in (FULL_S, ROOM_S))
    _feed(ring, recorder, rows[:full])
    filler = _filled(disk)
    _feed(ring, recorder, rows[full:room], fed=full)
    report = recorder.report()
    segments = len(list(Path(report.folder).glob("signals-*")))
    filler.unlink()
    _feed(ring, recorder, rows[room:], fed=room)
    ring.close()
    until("the recorder has ended", lambda: not recorder.report().alive)
    recorder.wait(0.0)
    reader.close()
    return Path(report.folder), report, segments


def test_a_full_disk_costs_the_rows_of_its_time_and_the_recorder_says_how_many(short_of_disk):
    _, report, segments = short_of_disk
    assert report.alive
    assert report.rows_lost == pytest.approx((ROOM_S - FULL_S) / STEP_S, abs=BUFFERED_ROWS)
    assert "No space left" in report.error
    assert report.free_bytes == 0
    assert segments <= 2  # not one more for every try


def test_the_run_is_a_record_on_both_sides_of_the_hole_and_says_what_it_lost(
    whole_record, short_of_disk
):
    folder, _, _ = short_of_disk
    whole, later = whole_record, read_record(folder)
    assert later.duration_s == pytest.approx(END_S - ROOM_S, abs=BUFFERED_ROWS * STEP_S)
    (lost,) = [text for text in later.findings if "rows were refused by the disk" in text]
    assert int(lost.split()[0]) == pytest.approx((ROOM_S - FULL_S) / STEP_S, abs=BUFFERED_ROWS)
    assert any("ends torn, its last row is whole" in text for text in later.findings)
    before = read_record(f"{folder}@0..{ROOM_S}")
    assert before.duration_s == pytest.approx(FULL_S, abs=BUFFERED_ROWS * STEP_S)
    for name, values in before.columns.items():
        assert values == pytest.approx(whole.columns[name][: before.samples]), name
