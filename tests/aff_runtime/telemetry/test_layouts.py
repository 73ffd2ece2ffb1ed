"""What lies in a ring, a run folder and on the recorder's lines, byte for byte."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

from aff_runtime.telemetry.header import Right, RingHeader, RunMeta
from aff_runtime.telemetry.recorder_messages import (
    Note,
    RecorderReport,
    RunContext,
    context_of,
    note_of,
    report_of,
)
from aff_runtime.telemetry.run_folder import RunFolder
from tests.aff_runtime.telemetry.heads import head_of
from tests.doubles.run_reader import read_run
from tests.each_case import each_case

META = RunMeta(
    config_hash="3f9a",
    versions={"python": "3.11.2", "aff-runtime": "1"},
    rights=(
        Right(granted=True, text="FIFO: granted"),
        Right(granted=False, text="memory: refused"),
    ),
    machine="Linux gateway",
    start_ns=1000,
    heartbeat_modulus=256,
)
CONTEXT = RunContext(
    name="Line 1",
    site_file="/etc/aff/site.yaml",
    started_by="uid 7",
    site_hash="5e",
    learned={"unwind": {"response": "ab", "shape": "cd"}},
    max_MB=500.0,
    segment_s=60.0,
    wire_files={"a.dbc": "ef"},
    site_text="version: 1\n",
)
HEADER = (
    b'{"columns": ["time_s"], "capacity": 1, "event_capacity": 1, "signals_at": 4096, '
    b'"events_at": 8192, "writer_pid": 7, "start_utc": "2026-01-02T03:04:05.678", "meta": '
    b'{"config_hash": "3f9a", "versions": {"python": "3.11.2", "aff-runtime": "1"}, "rights": '
    b'[{"granted": true, "text": "FIFO: granted"}, {"granted": false, "text": "memory: refused"}],'
    b' "machine": "Linux gateway", "start_ns": 1000, "shadow": false, "heartbeat_modulus": 256}}'
)
RUN_YAML = """\
name: Line 1
site_file: /etc/aff/site.yaml
started_by: uid 7
site_hash: 5e
learned:
  unwind:
    response: ab
    shape: cd
max_MB: 500.0
segment_s: 60.0
wire_files:
  a.dbc: ef
config_hash: 3f9a
versions:
  python: 3.11.2
  aff-runtime: '1'
rights:
- granted: true
  text: 'FIFO: granted'
- granted: false
  text: 'memory: refused'
machine: Linux gateway
start_ns: 1000
shadow: false
heartbeat_modulus: 256
start_utc: '2026-01-02T03:04:05.678'
site_sha256: 09bfcc6a14b83e2192b8673677725c84883ee9cd0c70e45c9ec09daa8f2b2847
columns:
- time_s
- tick
- state
- wake_us
"""
SUMMARY_ENDS = {
    "rows_written": 2,
    "rows_lost_to_disk": 0,
    "files_lost_to_disk": 0,
    "segments_deleted": 0,
    "ring_overruns": 3,
    "from_s": 0.0,
}
CONTEXT_LINE = (
    b'{"name": "Line 1", "site_file": "/etc/aff/site.yaml", "started_by": "uid 7", "site_hash": '
    b'"5e", "learned": {"unwind": {"response": "ab", "shape": "cd"}}, "max_MB": 500.0, '
    b'"segment_s": 60.0, "wire_files": {"a.dbc": "ef"}, "site_text": "version: 1\\n", '
    b'"takes_over": "", "died": ""}\n'
)


def test_the_head_of_a_ring_is_json_and_comes_back() -> None:
    head = head_of(META)
    assert head.encode() == HEADER
    assert RingHeader.decode(HEADER) == head


def run(folder: Path) -> Path:
    """Write a run of two rows; return its folder."""
    head = replace(head_of(META), columns=("time_s", "tick", "state", "wake_us"))
    made = RunFolder(folder, head, CONTEXT)
    made.add([(0.0, 1.0, 4.0, 20.0), (0.005, 2.0, 4.0, 30.0)])
    made.finish(ring_overruns=3)
    return made.path


def test_run_yaml_says_what_supervisor_and_control_process_say(tmp_path: Path) -> None:
    folder = run(tmp_path)
    assert folder.name == "20260102T030405Z_Line-1"
    assert (folder / "run.yaml").read_text() == RUN_YAML
    found = read_run(folder)
    assert found.about.meta == META
    assert found.about.context == replace(CONTEXT, site_text="")


def test_the_summary_says_what_was_kept_and_lost(tmp_path: Path) -> None:
    folder = run(tmp_path)
    text = (folder / "summary.json").read_text()
    said = json.loads(text)
    assert list(said)[:4] == ["rows", "rows_by_state", "timing_us", "columns_by_state"]
    assert dict(list(said.items())[4:]) == SUMMARY_ENDS
    assert said["rows_by_state"] == {"ACTIVE": 2}
    assert said["columns_by_state"]["ACTIVE"]["tick"] == {
        "mean": 1.5,
        "sd": 0.5,
        "min": 1.0,
        "max": 2.0,
        "last": 2.0,
    }
    summary = read_run(folder).summary
    assert summary is not None
    assert summary.encode() == text


def test_the_recorder_is_told_the_context_and_then_notes() -> None:
    assert CONTEXT.encode() == CONTEXT_LINE
    assert context_of(CONTEXT_LINE.strip()) == CONTEXT
    note = Note(name="EDIT", text="6 -> 9")
    said = (
        b'{"name": "EDIT", "text": "6 -> 9", "site_text": "", "site_hash": "", '
        b'"response": "", "actuator": ""}\n'
    )
    assert note.encode() == said
    assert note_of(note.encode()) == note
    assert note_of(b'{"name": "EDIT", "text": "6 -> 9"}') == note


def test_the_recorder_reports_about_itself_and_others_see_whether_it_lives() -> None:
    report = RecorderReport(
        folder="/r/x", rows=10, rows_lost=2, ring_overruns=1, error="full", free_bytes=900
    )
    assert report.encode() == (
        b'{"folder": "/r/x", "rows": 10, "rows_lost": 2, "ring_overruns": 1, "error": "full", '
        b'"kept_bytes": -1, "max_bytes": -1, "free_bytes": 900, "disk_bytes": -1}\n'
    )
    assert report_of(report.encode()) == report
    assert report.seen(alive=True) == replace(report, alive=True)


@each_case("line", [b"", b"{", b"[1]", b"7", b"\xff"])
def test_a_line_that_is_none_is_no_word(line: bytes) -> None:
    assert context_of(line) is None
    assert note_of(line) is None
    assert report_of(line) is None


def test_a_context_of_another_release_gives_what_is_known() -> None:
    assert context_of(b'{"name": "L", "news": 1}') == RunContext(name="L")
