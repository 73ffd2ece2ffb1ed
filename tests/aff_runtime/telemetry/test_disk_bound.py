"""What goes when the recordings grow too large."""

from __future__ import annotations

import shutil
from pathlib import Path

from aff_runtime.telemetry.disk_bound import delete_oldest, used_bytes
from aff_runtime.telemetry.header import RingHeader, RunMeta
from aff_runtime.telemetry.recorder_messages import NOT_SAID, RunContext
from aff_runtime.telemetry.run_folder import RunFolder


def run(directory: Path, name: str, segments: int) -> Path:
    folder = directory / name
    folder.mkdir()
    (folder / "run.yaml").touch()
    for k in range(1, segments + 1):
        (folder / f"signals-{k:04d}.csv.gz").write_bytes(bytes(1000))
    return folder


def names(folder: Path) -> list[str]:
    return sorted(p.name for p in folder.iterdir())


def test_the_oldest_segments_of_the_oldest_run_go_first(tmp_path: Path) -> None:
    old = run(tmp_path, "20260101T000000Z_line", 3)
    new = run(tmp_path, "20260102T000000Z_line", 2)
    keep = new / "signals-0002.csv.gz"
    assert delete_oldest(tmp_path, max_bytes=3500, keep=keep) == 2
    assert names(old) == ["run.yaml", "signals-0003.csv.gz"]
    assert len(names(new)) == 3


def test_a_run_without_segments_goes_as_a_whole_and_the_kept_segment_stays(tmp_path: Path) -> None:
    old = run(tmp_path, "20260101T000000Z_line", 1)
    (old / "run.yaml").write_bytes(bytes(50))
    responses = ("response-unwind-0123456789ab.json", "response-unwind-0123456789ac.json.part")
    for name in ("site-0123456789ab.yaml", "site-0123456789ac.yaml.part", *responses):
        (old / name).write_bytes(bytes(50))
    new = run(tmp_path, "20260102T000000Z_line", 3)
    delete_oldest(tmp_path, max_bytes=1000, keep=new / "signals-0003.csv.gz")
    assert not old.exists()
    assert names(new) == ["run.yaml", "signals-0003.csv.gz"]
    assert used_bytes(tmp_path) == 1000


def test_segments_go_by_their_number_also_beyond_four_digits(tmp_path: Path) -> None:
    folder = run(tmp_path, "20260101T000000Z_line", 0)
    for k in (9998, 9999, 10_000, 10_001):
        (folder / f"signals-{k}.csv.gz").write_bytes(bytes(1000))
    keep = folder / "signals-10001.csv.gz"
    assert delete_oldest(tmp_path, max_bytes=2000, keep=keep) == 2
    assert names(folder) == ["run.yaml", "signals-10000.csv.gz", "signals-10001.csv.gz"]


def test_folders_not_named_like_runs_are_left_alone(tmp_path: Path) -> None:
    mine = run(tmp_path, "my-precious-data", 5)
    new = run(tmp_path, "20260102T000000Z_line", 1)
    delete_oldest(tmp_path, max_bytes=0, keep=new / "signals-0001.csv.gz")
    assert len(names(mine)) == 6


def test_a_run_says_what_all_runs_take_once_a_segment_has_ended(tmp_path: Path) -> None:
    header = RingHeader(
        columns=("time_s", "tick", "state"),
        capacity=16,
        event_capacity=16,
        signals_at=0,
        events_at=0,
        writer_pid=1,
        start_utc="2026-01-01T00:00:00Z",
        meta=RunMeta(),
    )
    folder = RunFolder(tmp_path, header, RunContext(max_MB=2.0, segment_s=1.0))
    assert (folder.kept_bytes, folder.max_bytes) == (NOT_SAID, 2_000_000)
    left, size = folder.free_bytes()
    assert 0 < left <= size == shutil.disk_usage(tmp_path).total
    folder.add([(0.0, 0.0, 3.0)])
    folder.add([(1.5, 300.0, 3.0)])
    folder.finish(ring_overruns=0)
    files = sum(one.stat().st_size for one in folder.path.iterdir())
    assert 0 < folder.kept_bytes <= files
