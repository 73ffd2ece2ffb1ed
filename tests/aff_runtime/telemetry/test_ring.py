"""The ring file: header, status, life of the writer."""

from __future__ import annotations

import errno
import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from aff_runtime.base.errors import AffError
from aff_runtime.telemetry.ring import RingReader, RingWriter


def test_columns_meta_records_and_events_pass_through_the_file(tmp_path: Path) -> None:
    path = tmp_path / "ring"
    writer = RingWriter(path, ["time_s", "unwind_tension_N"], meta={"config_hash": "3f9a"})
    reader = RingReader(path)
    assert reader.columns == ("time_s", "unwind_tension_N")
    assert reader.header["meta"] == {"config_hash": "3f9a"}
    assert reader.status() is None
    writer.write((0.005, 88.9))
    writer.event(1, 5_000_000, 15)
    assert reader.status() == {"time_s": 0.005, "unwind_tension_N": 88.9}
    assert reader.signals.read_new() == [(0.005, 88.9)]
    assert reader.events.read_new() == [(1, 5_000_000, 15, 0)]
    writer.close()


def test_the_file_is_private_to_its_user(tmp_path: Path) -> None:
    writer = RingWriter(tmp_path / "ring", ["time_s"], meta={})
    assert stat.S_IMODE((tmp_path / "ring").stat().st_mode) == 0o600
    writer.close()


def test_the_writer_counts_as_gone_after_close(tmp_path: Path) -> None:
    writer = RingWriter(tmp_path / "ring", ["time_s"], meta={})
    reader = RingReader(tmp_path / "ring")
    assert reader.writer_alive()
    writer.close()
    assert not reader.writer_alive()


def test_the_writer_counts_as_gone_after_sigkill(tmp_path: Path) -> None:
    code = (
        "import sys, pathlib\n"
        "from aff_runtime.telemetry.ring import RingWriter\n"
        "ring = RingWriter(pathlib.Path(sys.argv[1]), ['time_s'], meta={})\n"
        "print('up', flush=True)\n"
        "sys.stdin.read()\n"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path / "ring")],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    )
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdout.readline()
    reader = RingReader(tmp_path / "ring")
    assert reader.writer_alive()
    process.kill()
    process.wait()
    process.stdin.close()
    process.stdout.close()
    assert not reader.writer_alive()


def test_a_foreign_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "ring").write_bytes(b"x" * 4096)
    with pytest.raises(AffError, match="not a ring"):
        RingReader(tmp_path / "ring")


def test_a_second_writer_leaves_the_first_readers_mapping_intact(tmp_path: Path) -> None:
    first = RingWriter(tmp_path / "ring", ["time_s"], meta={})
    first.write((1.0,))
    reader = RingReader(tmp_path / "ring")
    second = RingWriter(tmp_path / "ring", ["time_s"], meta={})
    second.write((2.0,))
    assert reader.status() == {"time_s": 1.0}
    assert RingReader(tmp_path / "ring").status() == {"time_s": 2.0}
    first.close()
    second.close()


def test_removal_takes_the_own_file_and_leaves_a_successors(tmp_path: Path) -> None:
    path = tmp_path / "ring"
    first = RingWriter(path, ["time_s"], meta={})
    second = RingWriter(path, ["time_s"], meta={})
    first.remove()
    assert path.exists()
    second.remove()
    assert not path.exists()


def test_a_full_file_system_refuses_the_ring_instead_of_killing_its_writer_later(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "posix_fallocate", full)
    with pytest.raises(AffError, match=r"ring: no room for .* MB \(No space left"):
        RingWriter(tmp_path / "ring", ["time_s"], meta={})
    assert list(tmp_path.iterdir()) == []


def test_every_page_of_the_ring_is_there_from_the_start(tmp_path: Path) -> None:
    writer = RingWriter(tmp_path / "ring", ["time_s"] * 50, meta={})
    found = (tmp_path / "ring").stat()
    assert found.st_blocks * 512 >= found.st_size
    writer.close()
