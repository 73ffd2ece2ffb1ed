"""The files of a run beside its signals, on a disk that refuses."""

from __future__ import annotations

import errno
import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from aff_runtime.base.runs.responses import (
    LARGEST_RESPONSE,
    MOST_RESPONSES,
    RESPONSE_FILE,
    response_file,
)
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.recorder_messages import RunContext
from aff_runtime.telemetry.run_folder import EVENT_HEADER, MOST_SITES, RunFolder
from aff_runtime.telemetry.takeover import Takeover
from tests.aff_runtime.telemetry.heads import head_of


@contextmanager
def room_for(size: int) -> Iterator[None]:
    """Let no file of this process grow beyond ``size`` bytes: a write is taken in part."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_a_row_of_events_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    folder = RunFolder(tmp_path, head_of(RunMeta()), RunContext(name="line"))
    events = folder.path / "events.csv"
    folder.add_note("EDIT", "before")
    there = events.read_bytes()
    with room_for(len(there) + 10):
        folder.add_note("EDIT", "a text that is longer than the room there is")
    assert events.read_bytes() == there
    assert folder.files_lost == 1
    folder.add_note("EDIT", "after")
    assert events.read_text().splitlines()[-2:] == [
        "0.0000,,,EDIT,,before",
        "0.0000,,,EDIT,,after",
    ]


def test_events_that_came_before_the_disk_took_the_header_stay(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as disk:
        disk.setattr(Path, "open", full)
        folder = RunFolder(tmp_path, head_of(RunMeta()), RunContext(name="line"))
    assert folder.files_lost == 3
    folder.add_note("EDIT", "there is room again")
    folder.add([[0.0] * len(head_of(RunMeta()).columns)])  # begins a segment, and makes up
    folder.add_note("EDIT", "later")
    assert (folder.path / "events.csv").read_text().splitlines() == [
        EVENT_HEADER.strip(),
        "0.0000,,,EDIT,,there is room again",
        "0.0000,,,EDIT,,later",
    ]
    folder.finish(ring_overruns=0)
    assert (folder.path / "run.yaml").stat().st_size > 0


def test_a_run_without_events_has_their_header(tmp_path: Path) -> None:
    folder = RunFolder(tmp_path, head_of(RunMeta()), RunContext(name="line"))
    folder.add_events([], 0.0)
    assert (folder.path / "events.csv").read_text() == EVENT_HEADER


HASH = "0123456789abcdef" * 4
LATER = f"site-{HASH[:12]}.yaml"


def kept(folder: RunFolder) -> dict[str, str]:
    return {path.name: path.read_text() for path in sorted(folder.path.glob("site*.yaml"))}


def test_a_site_file_that_runs_later_is_kept_once_and_the_first_one_stays(tmp_path: Path) -> None:
    context = RunContext(name="line", site_text="a: 1\n", site_hash="f" * 64)
    folder = RunFolder(tmp_path, head_of(RunMeta()), context)
    for site_hash, text in (("f" * 64, "a: 1\n"), (HASH, "a: 2\n"), (HASH, "a: 2 # same\n")):
        folder.keep_site(site_hash, text)
    assert kept(folder) == {"site.yaml": "a: 1\n", LATER: "a: 2\n"}


@pytest.mark.parametrize("name", ["", "../../x", "0123", "G" * 12])
def test_what_is_no_hash_names_no_file(tmp_path: Path, name: str) -> None:
    folder = RunFolder(tmp_path, head_of(RunMeta()), RunContext(name="line", site_text="a: 1\n"))
    folder.keep_site(name, "a: 2\n")
    assert list(kept(folder)) == ["site.yaml"]


def test_a_later_site_file_that_the_disk_refused_is_made_up_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    folder = RunFolder(tmp_path, head_of(RunMeta()), RunContext(name="line", site_text="a: 1\n"))
    with monkeypatch.context() as disk:
        disk.setattr(Path, "write_text", full)
        folder.keep_site(HASH, "a: 2\n")
    assert folder.files_lost == 1
    folder.add([[0.0] * len(head_of(RunMeta()).columns)])  # begins a segment, and makes up
    folder.finish(ring_overruns=0)
    assert kept(folder)[LATER] == "a: 2\n"


def test_a_site_file_that_the_disk_cuts_short_is_none_and_comes_at_the_end(tmp_path: Path) -> None:
    folder = RunFolder(tmp_path, head_of(RunMeta()), RunContext(name="line", site_text="a: 1\n"))
    text = "a: 2\n" + "# a comment\n" * 100
    with room_for(500):
        folder.keep_site(HASH, text)
    assert kept(folder) == {"site.yaml": "a: 1\n"}
    assert list(folder.path.glob("*.part")) == []
    assert folder.files_lost == 1
    folder.finish(ring_overruns=0)
    assert kept(folder) == {"site.yaml": "a: 1\n", LATER: text}
    assert '"files_lost_to_disk": 1' in (folder.path / "summary.json").read_text()


def test_a_run_keeps_so_many_later_site_files_and_no_more(tmp_path: Path) -> None:
    folder = RunFolder(tmp_path, head_of(RunMeta()), RunContext(name="line", site_text="a: 1\n"))
    for number in range(MOST_SITES + 5):
        folder.keep_site(f"{number:012x}", f"a: {number}\n")
    assert len(kept(folder)) == MOST_SITES + 1


RESPONSE = '{"format": "aff-response-1", "points": []}'


def responses(path: Path) -> dict[str, str]:
    return {one.name: one.read_text() for one in path.glob("response-*")}


def test_a_measured_response_is_kept_once_also_by_a_recorder_that_takes_over(
    tmp_path: Path,
) -> None:
    folder = RunFolder(tmp_path, head_of(RunMeta()), RunContext(name="line"))
    name = response_file("unwind", RESPONSE)
    for actuator, text in (("unwind", RESPONSE), ("unwind", RESPONSE), ("unwind", "")):
        folder.keep_response(actuator, text)
    assert responses(folder.path) == {name: RESPONSE}
    (folder.path / name).write_text("as the first recorder wrote it")
    taken = Takeover(
        folder=folder.path, segment=1, tick=1.0, time_s=1.0, tick_at=0, events=frozenset()
    )
    after = RunFolder(tmp_path, head_of(RunMeta()), RunContext(name="line"), taken)
    after.keep_response("unwind", RESPONSE)
    assert responses(folder.path) == {name: "as the first recorder wrote it"}


def test_responses_of_a_run_are_bounded_and_stay_in_its_folder(tmp_path: Path) -> None:
    folder = RunFolder(tmp_path, head_of(RunMeta()), RunContext(name="line"))
    folder.keep_response("../../x", RESPONSE)
    folder.keep_response("large", "x" * (LARGEST_RESPONSE + 1))
    for k in range(MOST_RESPONSES):
        folder.keep_response("rewind", f"{k}")
    assert len(responses(folder.path)) == MOST_RESPONSES
    assert not any("large" in name for name in responses(folder.path))
    assert all(RESPONSE_FILE.fullmatch(name) for name in responses(folder.path))
