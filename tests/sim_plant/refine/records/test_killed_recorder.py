"""A recorder that is killed in the middle: what the two run folders still are, as records."""

import numpy as np
import pytest

from aff_runtime.app.supervisor.recorder_child import RecorderChild
from aff_runtime.base.run_table import read_table
from aff_runtime.base.run_window import run_window
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


ON_WIRES = [pytest.param(wire, marks=pytest.mark.campaign) for wire in ("modbus", "can")]
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
def folders(run, tmp_path_factory):
    """The same rows through a ring to a recorder that is killed, and to the one that follows."""
    table = read_table(run_window(run))
    rows = list(zip(*table.columns.values(), strict=True))
    runs = tmp_path_factory.mktemp("killed")
    ring = RingWriter(list(table.columns), meta=RunMeta(start_ns=1), capacity=KEPT_ROWS)
    descriptor = ring.open_for_readers()
    reader = RingReader(descriptor)
    at = round(KILLED_S / STEP_S)
    first = _recorder(reader, runs, table.site_text)
    _feed(ring, first, rows[:at])
    kill(first.pid)
    until("the recorder is dead", lambda: not first.report().alive)
    first.wait(0.0)
    unread = at + LOST_ROWS + KEPT_ROWS
    for row in rows[at:unread]:
        ring.write(row)
    second = _recorder(reader, runs, table.site_text)
    until("the other has begun", lambda: second.report().rows >= KEPT_ROWS - 1)
    for row in rows[unread:]:
        ring.write(row)
    ring.close()
    until("the other has ended", lambda: not second.report().alive)
    second.wait(0.0)
    reader.close()
    return [first.report().folder, second.report().folder]


def _recorder(reader, runs, site_text):
    return RecorderChild(reader, runs, RunContext(name="Euclid", site_text=site_text, max_MB=50))


def _feed(ring, recorder, rows):
    """Write rows no faster than the recorder takes them, which it says once a second."""
    for start in range(0, len(rows), KEPT_ROWS // 2):
        part = rows[start : start + KEPT_ROWS // 2]
        for row in part:
            ring.write(row)
        fed = start + len(part)
        until("they are written", lambda n=fed: recorder.report().rows >= n)


def test_what_was_written_before_is_a_record_and_it_says_that_its_end_is_missing(run, folders):
    whole, cut = read_record(run), read_record(folders[0])
    assert any("the recorder did not end by itself" in text for text in cut.findings)
    assert cut.duration_s == pytest.approx(KILLED_S, abs=0.05)
    for name, values in cut.columns.items():
        assert values == pytest.approx(whole.columns[name][: cut.samples]), name


def test_the_one_that_follows_has_what_the_ring_still_held_and_says_what_it_did_not(run, folders):
    rest = read_record(folders[1])
    table = read_table(run_window(run))
    ticks = table.columns["tick"]
    found = [read_table(run_window(folder)).columns["tick"] for folder in folders]
    lost = np.setdiff1d(ticks, np.concatenate(found))
    assert lost.size == pytest.approx(LOST_ROWS, abs=2)
    before = int(np.sum(ticks < found[1][0]))  # it cannot know what the one before it wrote
    assert f"{before} rows were overwritten before the recorder had read them" in rest.findings
    first_kept_s = KILLED_S + LOST_ROWS * STEP_S
    assert rest.duration_s == pytest.approx(END_S - first_kept_s, abs=0.05)
