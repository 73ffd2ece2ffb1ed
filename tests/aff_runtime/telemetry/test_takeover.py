"""A recorder that follows one that died: one run, nothing twice, what is lost is counted."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from aff_runtime.base.runs.table import RECORDER_DIED, read_table
from aff_runtime.base.runs.window import run_window
from aff_runtime.telemetry.header import RingHeader, RunMeta
from aff_runtime.telemetry.recorder_messages import RunContext
from aff_runtime.telemetry.run_folder import RunFolder
from aff_runtime.telemetry.takeover import Takeover, takeover_of
from tests.aff_runtime.telemetry.heads import head_of

COLUMNS = ("time_s", "tick", "tension_N")
HEADER = replace(head_of(RunMeta(start_ns=5), "2026-01-02T03:04:05"), columns=COLUMNS)
STEP_S = 0.01
WRITTEN = 150
"""Ticks that the first recorder wrote: a segment and a half."""
EVENTS = [(3.0, 30e6 + 5, 17.0, 1.0), (3.0, 30e6 + 5, 4.0, 0.5), (140.0, 1.4e9 + 5, 17.0, 2.0)]


def rows(first: int, end: int) -> list[tuple[float, float, float]]:
    return [(k * STEP_S, float(k), 90.0 + 0.001 * k) for k in range(first, end)]


@pytest.fixture
def died(tmp_path: Path) -> Iterator[RunFolder]:
    """A run whose recorder died: no summary, its newest segment torn in the middle of a row."""
    folder = RunFolder(tmp_path, HEADER, RunContext(site_text="line: {}\n", segment_s=1.0))
    for k in range(0, WRITTEN, 25):
        folder.add(rows(k, k + 25))
    folder.add_events(EVENTS[:2], 5.0)
    yield folder
    folder.signals.close()


def follower(died: RunFolder, header: RingHeader = HEADER) -> Takeover | None:
    context = RunContext(segment_s=1.0, takes_over=str(died.path))
    return takeover_of(context, header)


def goes_on(died: RunFolder, kept: list[tuple[float, float, float]], end: int) -> str:
    """Let another one follow with the rows that the ring kept; return what it says."""
    taken = follower(died)
    assert taken is not None
    folder = RunFolder(died.path.parent, HEADER, RunContext(segment_s=1.0), taken)
    said = taken.words("recorder 7: killed by SIGKILL", kept)
    folder.add_note(RECORDER_DIED, said)
    folder.add(kept)
    folder.add_events(EVENTS, 5.0)
    folder.add(rows(round(kept[-1][1]) + 1, end))
    folder.finish(ring_overruns=taken.lost(kept))
    return said


def test_the_run_goes_on_in_its_folder_with_the_first_tick_that_is_in_no_file(died: RunFolder):
    before = (died.path / "signals-0002.csv.gz").read_bytes()
    said = goes_on(died, rows(0, 200), 300)
    assert said.endswith("goes on behind segment 2: no tick is lost")
    assert list(died.path.parent.iterdir()) == [died.path]
    assert (died.path / "signals-0002.csv.gz").read_bytes() == before
    table = read_table(run_window(died.path))
    assert table.columns["tick"].tolist() == list(range(300))
    assert table.site_text == "line: {}\n"
    assert [text for text in table.lost if "overwritten" in text] == []
    assert f"at 1.4900 s {said}" in table.lost


def test_the_site_file_that_runs_when_a_recorder_follows_is_kept(died: RunFolder):
    """The one that died may not have had it."""
    taken = follower(died)
    context = RunContext(segment_s=1.0, site_hash="ab" * 32, site_text="line: {name: later}\n")
    folder = RunFolder(died.path.parent, HEADER, context, taken)
    folder.finish(ring_overruns=0)
    later = died.path / "site-abababababab.yaml"
    assert later.read_text() == "line: {name: later}\n"


def test_rows_behind_the_last_whole_one_of_a_torn_segment_come_from_the_ring(died: RunFolder):
    segment = died.path / "signals-0002.csv.gz"
    segment.write_bytes(segment.read_bytes()[:-40])
    whole = read_table(run_window(died.path)).columns["tick"][-1]
    assert whole < WRITTEN - 1
    goes_on(died, rows(0, 200), 300)
    assert read_table(run_window(died.path)).columns["tick"].tolist() == list(range(300))


def test_ticks_that_the_ring_no_longer_has_are_counted_and_timed(died: RunFolder):
    said = goes_on(died, rows(WRITTEN + 20, 200), 300)
    assert "20 ticks are lost, nothing is recorded for 0.21 s" in said
    table = read_table(run_window(died.path))
    assert table.columns["tick"].size == 280
    assert "20 rows were overwritten before the recorder had read them" in table.lost


def test_an_event_stands_once_and_half_a_row_of_one_not_at_all(died: RunFolder):
    with (died.path / "events.csv").open("ab") as file:
        file.write(b"1.39,139,1")
    goes_on(died, rows(0, 200), 300)
    events = read_table(run_window(died.path)).events
    codes = [(row["tick"], row["code"]) for row in events if row["code"]]
    assert codes == [("3", "17"), ("3", "4"), ("140", "17")]


@pytest.mark.parametrize(
    "header",
    [replace(HEADER, meta=RunMeta(start_ns=6)), replace(HEADER, columns=(*COLUMNS, "more"))],
    ids=["another start", "other columns"],
)
def test_a_run_of_another_ring_is_not_gone_on_with(died: RunFolder, header: RingHeader):
    assert follower(died) is not None
    assert follower(died, header) is None


def test_a_run_that_has_ended_or_holds_no_row_is_not_gone_on_with(died: RunFolder, tmp_path: Path):
    empty = RunFolder(tmp_path / "empty", HEADER, RunContext())
    assert follower(empty) is None
    died.finish(ring_overruns=0)
    assert follower(died) is None


def test_a_folder_that_is_gone_or_none_is_not_gone_on_with(died: RunFolder, tmp_path: Path):
    (died.path / "run.yaml").unlink()
    assert follower(died) is None
    assert takeover_of(RunContext(takes_over=str(tmp_path / "nowhere")), HEADER) is None
    assert takeover_of(RunContext(), HEADER) is None


def test_the_summary_says_from_when_on_its_statistics_count(died: RunFolder):
    goes_on(died, rows(0, 200), 300)
    text = (died.path / "summary.json").read_text(encoding="utf-8")
    assert '"from_s": 1.49' in text
    assert f'"rows_written": {300 - WRITTEN}' in text
