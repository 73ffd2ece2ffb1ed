"""Segments of bounded length, and disks that refuse."""

from __future__ import annotations

import gzip
import os
from pathlib import Path

import pytest

from aff_runtime.telemetry.segments import SegmentWriter


def rows(start: int, stop: int) -> list[tuple[float, ...]]:
    return [(k * 0.1, float(k)) for k in range(start, stop)]


def test_rows_fall_into_segments_by_their_time(tmp_path: Path) -> None:
    writer = SegmentWriter(tmp_path, ["time_s", "a_N"], segment_s=1.0)
    assert writer.append(rows(0, 25))
    writer.close()
    texts = [gzip.decompress(p.read_bytes()) for p in sorted(tmp_path.glob("*.csv.gz"))]
    assert [len(text.splitlines()) - 1 for text in texts] == [10, 10, 5]
    assert texts[2].splitlines()[:2] == [b"time_s,a_N", b"2,20"]


def test_rows_are_readable_before_the_segment_is_closed(tmp_path: Path) -> None:
    writer = SegmentWriter(tmp_path, ["time_s", "a_N"], segment_s=60)
    writer.append(rows(0, 3))
    with gzip.open(writer.path) as file:
        assert file.read1(1000).splitlines()[1:] == [b"0,0", b"0.1,1", b"0.2,2"]
    writer.close()


def test_a_folder_that_is_gone_costs_rows_and_writing_resumes_when_it_is_back(
    tmp_path: Path,
) -> None:
    folder = tmp_path / "run"
    writer = SegmentWriter(folder, ["time_s", "a_N"], segment_s=60)
    writer.append(rows(0, 5))
    assert (writer.rows_lost, writer.rows_written) == (5, 0)
    assert writer.last_error
    folder.mkdir()
    writer.append(rows(5, 8))
    writer.close()
    assert (writer.rows_lost, writer.rows_written) == (5, 3)


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_a_full_disk_is_counted_not_raised_and_leaves_one_empty_segment(tmp_path: Path) -> None:
    for number in (1, 2, 3, 4):
        (tmp_path / f"signals-{number:04d}.csv.gz").symlink_to("/dev/full")
    writer = SegmentWriter(tmp_path, ["time_s", "a_N"], segment_s=60)
    writer.append(rows(0, 4))
    writer.append(rows(4, 6))
    assert (writer.rows_lost, writer.rows_written) == (6, 0)
    assert "space" in writer.last_error
    assert writer.path.name == "signals-0001.csv.gz"  # not one more for every batch
    writer.path.unlink()  # the disk has room again
    writer.append(rows(6, 9))
    writer.close()
    assert (writer.rows_lost, writer.rows_written) == (6, 3)
    text = gzip.decompress((tmp_path / "signals-0001.csv.gz").read_bytes())
    assert text.splitlines() == [b"time_s,a_N", b"0.6,6", b"0.7,7", b"0.8,8"]


def test_what_was_written_before_the_disk_was_full_stays(tmp_path: Path) -> None:
    writer = SegmentWriter(tmp_path, ["time_s", "a_N"], segment_s=60)
    writer.append(rows(0, 3))
    refused = tmp_path / "signals-0002.csv.gz"
    refused.symlink_to("/dev/full")
    writer.append([(60.0, 1.0)])  # the next segment, which the disk refuses
    refused.unlink()
    writer.append([(61.0, 2.0)])
    writer.close()
    texts = [gzip.decompress(p.read_bytes()) for p in sorted(tmp_path.glob("*.csv.gz"))]
    assert [text.splitlines()[1:] for text in texts] == [[b"0,0", b"0.1,1", b"0.2,2"], [b"61,2"]]
    assert writer.rows_lost == 1


def test_ticks_and_angles_of_a_process_that_runs_for_a_year_stay_apart(tmp_path: Path) -> None:
    year_s, turned_rad = 365.0 * 86400.0, 4e8
    writer = SegmentWriter(tmp_path, ["time_s", "roll_angle_rad"], segment_s=60)
    ticks = [(year_s + 0.005 * k, turned_rad + 0.001 * k) for k in range(3)]
    writer.append(ticks)
    writer.close()
    lines = gzip.decompress(writer.path.read_bytes()).decode().splitlines()[1:]
    read = [tuple(map(float, line.split(","))) for line in lines]
    for (time_s, angle_rad), tick in zip(read, ticks, strict=True):
        assert time_s == pytest.approx(tick[0], abs=1e-4)
        assert angle_rad == pytest.approx(tick[1], abs=1e-4)
