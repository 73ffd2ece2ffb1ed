"""The files of a run beside its signals, on a disk that refuses."""

from __future__ import annotations

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.recorder_messages import RunContext
from aff_runtime.telemetry.run_folder import RunFolder
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
