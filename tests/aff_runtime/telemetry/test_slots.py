"""Properties of one ring: order, wrap, counting, torn copies."""

from __future__ import annotations

import mmap
import multiprocessing
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aff_runtime.telemetry.slots import SlotReader, SlotWriter, ring_bytes

LAYOUT = {"offset_bytes": 16, "n_values": 3, "capacity": 8}


def pair() -> tuple[SlotWriter, SlotReader, bytearray]:
    memory = bytearray(16 + ring_bytes(3, 8))
    return (
        SlotWriter(memoryview(memory), **LAYOUT),
        SlotReader(memoryview(memory), **LAYOUT),
        memory,
    )


Reading = Callable[[SlotReader], Sequence[Sequence[float]]]
BOTH = pytest.mark.parametrize("read", [SlotReader.read_new, SlotReader.read_rows])


@BOTH
@settings(max_examples=60, deadline=None)
@given(bursts=st.lists(st.integers(min_value=0, max_value=20), max_size=12))
def test_every_record_is_either_read_in_order_or_counted(read: Reading, bursts: list[int]) -> None:
    writer, reader, _ = pair()
    written = 0
    got: list[float] = []
    for burst in bursts:
        for _ in range(burst):
            writer.write((written, -written, 0.5))
            written += 1
        before = reader.overrun_count
        new = [record[0] for record in read(reader)]
        lost = reader.overrun_count - before
        assert len(new) + lost == burst
        assert new == list(range(written - len(new), written))
        got += new
    assert len(got) + reader.overrun_count == written


@BOTH
def test_at_most_one_less_than_the_capacity_is_readable_after_a_long_gap(read: Reading) -> None:
    writer, reader, _ = pair()
    for k in range(100):
        writer.write((k, k, k))
    assert [record[0] for record in read(reader)] == list(range(93, 100))
    assert reader.overrun_count == 93


def test_the_latest_record_needs_no_history_and_moves_nothing() -> None:
    writer, reader, _ = pair()
    assert reader.latest() is None
    for k in range(20):
        writer.write((k, 0.0, 0.0))
        assert reader.latest() == (k, 0.0, 0.0)
    assert len(reader.read_new()) == 7


@BOTH
def test_a_record_in_the_making_is_counted_and_never_returned(read: Reading) -> None:
    writer, reader, memory = pair()
    for k in range(3):
        writer.write((k, k, k))
    slot_word = 2 + 1 + 1 * 4  # offset 16 bytes, head word, slot 1
    memoryview(memory).cast("Q")[slot_word] = 2 * 1 + 1
    assert [record[0] for record in read(reader)] == [0, 2]
    assert reader.overrun_count == 1


class Overtaken:
    """What a reader copies by; the writer comes around the ring while it does."""

    def __init__(self, copy: Any, overtake: Callable[[], None]) -> None:
        self._copy, self._overtake = copy, overtake

    def unpack_from(self, *place: Any) -> Any:
        self._overtake()
        return self._copy.unpack_from(*place)

    def __getitem__(self, place: Any) -> Any:
        self._overtake()
        return self._copy[place]


@BOTH
def test_a_record_that_is_overwritten_while_it_is_copied_is_counted_and_never_returned(
    read: Reading,
) -> None:
    writer, reader, _ = pair()
    writer.write((0.0,) * 3)

    later = iter(range(1, 9))

    def overtake() -> None:
        for k in later:
            writer.write((float(k),) * 3)

    for name in ("_unpacker", "_values"):
        setattr(reader, name, Overtaken(getattr(reader, name), overtake))
    assert 0.0 not in [record[0] for record in read(reader)]
    assert reader.overrun_count >= 1


def _map(path: Path) -> memoryview:
    with path.open("r+b") as file:
        return memoryview(mmap.mmap(file.fileno(), 0))


def _write_fast(path: Path, count: int) -> None:
    writer = SlotWriter(_map(path), offset_bytes=0, n_values=40, capacity=4)
    for k in range(count):
        writer.write((float(k),) * 40)


# quick, where one record is overtaken: above
@pytest.mark.long
@BOTH
def test_no_torn_record_is_returned_while_another_process_overwrites(
    read: Reading, tmp_path: Path
) -> None:
    count = 15_000
    path = tmp_path / "ring"
    path.write_bytes(bytes(ring_bytes(40, 4)))
    reader = SlotReader(_map(path), offset_bytes=0, n_values=40, capacity=4)
    process = multiprocessing.get_context("spawn").Process(target=_write_fast, args=(path, count))
    process.start()
    seen = 0
    last = -1.0
    while process.is_alive() or reader.written_count() > seen + reader.overrun_count:
        for record in read(reader):
            assert set(record) == {record[0]}
            assert record[0] > last
            last = record[0]
            seen += 1
    process.join()
    assert process.exitcode == 0
    assert seen > 0
    assert seen + reader.overrun_count == count
