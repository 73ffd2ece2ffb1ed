"""The recorder as a real process behind a real ring."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import AffError
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.ring import RingWriter
from tests.doubles.run_reader import Run, read_run
from tests.processes import until

pytestmark = pytest.mark.processes

COLUMNS = ["time_s", "tick", "state", "unwind_tension_N", "wake_latency_us"]
WAIT = MonotonicClock()


def start(ring: RingWriter, runs: Path) -> subprocess.Popen[bytes]:
    descriptor = ring.open_for_readers()
    try:
        return subprocess.Popen(
            [
                *(sys.executable, "-m", "aff_runtime.telemetry.recorder"),
                *(f"/dev/fd/{descriptor}", str(runs)),
            ],
            pass_fds=[descriptor],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
    finally:
        os.close(descriptor)


def record(tmp_path: Path, rows: list[tuple[float, ...]], segment_s: float = 60.0) -> Run:
    ring = RingWriter(COLUMNS, meta=RunMeta(start_ns=1000, config_hash="3f9a"))
    process = start(ring, tmp_path / "runs")
    assert process.stdin is not None
    context = {"name": "Line 1", "site_text": "version: 1\n", "segment_s": segment_s}
    process.stdin.write(json.dumps(context).encode() + b"\n")
    process.stdin.flush()
    for row in rows:
        ring.write(row)
    ring.event(2, 1000 + 10_000_000, 17, 4)
    process.stdin.write(b'{"name": "EDIT", "text": "settle_s: 6 -> 9"}\n')
    process.stdin.flush()
    WAIT.sleep_until_ns(WAIT.now_ns() + 500_000_000)
    ring.close()
    process.communicate(timeout=20)
    assert process.returncode == 0
    (folder,) = (tmp_path / "runs").iterdir()
    return read_run(folder)


def test_a_run_comes_back_as_it_was_written(tmp_path: Path) -> None:
    rows = [(k * 0.005, k, 4, 88.9 + k, 20.0) for k in range(1000)]
    run = record(tmp_path, [tuple(map(float, row)) for row in rows])
    table = np.array(rows)
    for i, name in enumerate(COLUMNS):
        np.testing.assert_allclose(run.columns[name], table[:, i], rtol=1e-9)
    assert run.about.meta.config_hash == "3f9a"
    assert run.about.columns == tuple(COLUMNS)
    assert run.summary is not None
    assert run.summary.statistics.rows_by_state == {"ACTIVE": 1000}
    assert run.summary.statistics.timing_us["wake_latency_us"]["p50"] == 20.0
    assert run.summary.ring_overruns == 0
    spoken = {event["name"]: event for event in run.events}
    assert spoken["SPLICE"]["time_s"] == "0.0100"
    assert spoken["EDIT"]["text"] == "settle_s: 6 -> 9"


def test_a_note_has_the_time_of_the_newest_row_from_the_first_one_on(tmp_path: Path) -> None:
    """A folder that is begun later, with other columns, does not begin at 0."""
    ring = RingWriter(COLUMNS, meta=RunMeta(start_ns=1000))
    for k in range(100):
        ring.write((43.0 + k * 0.005, 8600.0 + k, 4.0, 88.9, 20.0))
    process = start(ring, tmp_path / "runs")
    said = b'{"name": "Line 1"}\n{"name": "", "actuator": "unwind", "response": "{}"}\n'
    said += b'{"name": "OPERATOR", "text": "arm"}\n'
    assert process.stdin is not None
    process.stdin.write(said)
    process.stdin.flush()
    until("it is kept", lambda: b"arm" in b"".join(p.read_bytes() for p in events(tmp_path)))
    ring.close()
    process.communicate(timeout=20)
    (kept,) = read_run(folder := events(tmp_path)[0].parent).events
    assert (kept["text"], kept["time_s"]) == ("arm", "43.4950")
    assert [one.read_text() for one in folder.glob("response-unwind-*.json")] == ["{}"]


def events(folder: Path) -> list[Path]:
    return list(folder.glob("runs/*/events.csv"))


def test_segments_and_the_copy_of_the_site_file_lie_in_the_folder(tmp_path: Path) -> None:
    record(tmp_path, [(k * 0.005, k, 4, 1.0, 1.0) for k in range(1000)], segment_s=2)
    (folder,) = (tmp_path / "runs").iterdir()
    assert folder.name.endswith("Z_Line-1")
    assert len(list(folder.glob("signals-*.csv.gz"))) == 3
    assert (folder / "site.yaml").read_text() == "version: 1\n"


def test_a_run_cut_short_is_readable_up_to_its_last_whole_row(tmp_path: Path) -> None:
    record(tmp_path, [(k * 0.005, k, 4, 1.0, 1.0) for k in range(1000)])
    (folder,) = (tmp_path / "runs").iterdir()
    segment = folder / "signals-0001.csv.gz"
    segment.write_bytes(segment.read_bytes()[:-400])
    (folder / "summary.json").unlink()
    run = read_run(folder)
    ticks = run.columns["tick"]
    assert 0 < len(ticks) < 1000
    np.testing.assert_array_equal(ticks, np.arange(len(ticks)))
    assert run.summary is None


def test_a_folder_that_is_no_run_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(AffError, match=r"run\.yaml"):
        read_run(tmp_path)
