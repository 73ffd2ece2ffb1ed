"""The ring: header, status, life of the writer."""

from __future__ import annotations

import errno
import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from aff_runtime.base.errors import AffError
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.ring import RingReader, RingWriter

pytestmark = pytest.mark.processes


def reader_of(writer: RingWriter) -> RingReader:
    descriptor = writer.open_for_readers()
    try:
        return RingReader(Path(f"/dev/fd/{descriptor}"))
    finally:
        os.close(descriptor)


def test_columns_meta_records_and_events_pass_through_the_ring() -> None:
    writer = RingWriter(["time_s", "unwind_tension_N"], meta=RunMeta(config_hash="3f9a"))
    reader = reader_of(writer)
    assert reader.columns == ("time_s", "unwind_tension_N")
    assert reader.header.meta == RunMeta(config_hash="3f9a")
    assert reader.status() is None
    writer.write((0.005, 88.9))
    writer.event(1, 5_000_000, 15)
    assert reader.status() == {"time_s": 0.005, "unwind_tension_N": 88.9}
    assert reader.signals.read_new() == [(0.005, 88.9)]
    assert reader.events.read_new() == [(1, 5_000_000, 15, 0)]
    writer.close()


def test_the_ring_has_no_name_and_is_private_to_its_user() -> None:
    before = set(os.listdir("/dev/shm"))
    writer = RingWriter(["time_s"], meta=RunMeta())
    assert set(os.listdir("/dev/shm")) == before
    reader = reader_of(writer)
    found = os.fstat(reader.fileno())
    assert stat.S_IMODE(found.st_mode) == 0o600
    assert found.st_nlink == 0
    writer.close()


def test_a_reader_cannot_write() -> None:
    writer = RingWriter(["time_s"], meta=RunMeta())
    descriptor = writer.open_for_readers()
    with pytest.raises(OSError, match="Bad file descriptor"):
        os.write(descriptor, b"x")
    os.close(descriptor)
    writer.close()


def test_the_writer_counts_as_gone_after_close() -> None:
    writer = RingWriter(["time_s"], meta=RunMeta())
    reader = reader_of(writer)
    assert reader.writer_alive()
    writer.close()
    assert not reader.writer_alive()


def test_the_writer_counts_as_gone_after_sigkill() -> None:
    code = (
        "import sys\n"
        "from aff_runtime.telemetry.header import RunMeta\n"
        "from aff_runtime.telemetry.ring import RingWriter\n"
        "ring = RingWriter(['time_s'], meta=RunMeta())\n"
        "print(ring.open_for_readers(), flush=True)\n"
        "sys.stdin.read()\n"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert process.stdin is not None
    assert process.stdout is not None
    descriptor = int(process.stdout.readline())
    reader = RingReader(Path(f"/proc/{process.pid}/fd/{descriptor}"))
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


def test_a_second_ring_leaves_the_first_readers_mapping_intact() -> None:
    first = RingWriter(["time_s"], meta=RunMeta())
    first.write((1.0,))
    reader = reader_of(first)
    second = RingWriter(["time_s"], meta=RunMeta())
    second.write((2.0,))
    first.close()
    assert reader.status() == {"time_s": 1.0}
    assert reader_of(second).status() == {"time_s": 2.0}
    second.close()


def test_too_little_memory_refuses_the_ring_instead_of_killing_its_writer_later(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def full(*_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    before = set(os.listdir("/proc/self/fd"))
    monkeypatch.setattr(os, "posix_fallocate", full)
    with pytest.raises(AffError, match=r"no memory for a ring of .* MB \(No space left"):
        RingWriter(["time_s"], meta=RunMeta())
    assert set(os.listdir("/proc/self/fd")) == before


def test_every_page_of_the_ring_is_there_from_the_start() -> None:
    writer = RingWriter(["time_s"] * 50, meta=RunMeta())
    found = os.fstat(reader_of(writer).fileno())
    assert found.st_blocks * 512 >= found.st_size
    writer.close()
