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
def test_a_full_disk_is_counted_not_raised(tmp_path: Path) -> None:
    (tmp_path / "signals-0001.csv.gz").symlink_to("/dev/full")
    writer = SegmentWriter(tmp_path, ["time_s", "a_N"], segment_s=60)
    writer.append(rows(0, 4))
    assert writer.rows_lost == 4
    assert "space" in writer.last_error
    writer.append(rows(4, 6))
    writer.close()
    assert writer.rows_written == 2
