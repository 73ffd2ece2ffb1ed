"""Reading a PLC's words: refused ranges are halved, nothing is written, silence is an error."""

from __future__ import annotations

import struct
from collections.abc import Callable

import pytest

from aff_runtime.app.setup.words.reading import WordBlock, WordReader
from aff_runtime.base.errors import WireError
from aff_runtime.fieldbus.modbus.byte_stream import Connecting
from tests.doubles.virtual_clock import VirtualClock

Refuses = Callable[[int, int], int]


class ScriptedPlc:
    """A byte stream that answers FC3 at once: the word at n is n; ``refuses`` gives exceptions."""

    lossy = False
    why_closed = "unplugged"

    def __init__(self, refuses: Refuses) -> None:
        self.refuses = refuses
        self.functions: list[int] = []
        self.plugged = True
        self._waiting = b""

    def start_connect(self) -> bool:
        return self.plugged

    def connecting(self) -> Connecting:
        return Connecting.UP if self.plugged else Connecting.FAILED

    def send(self, frame: bytes) -> bool:
        tid, _, _, unit, function, start, count = struct.unpack(">HHHBBHH", frame)
        self.functions.append(function)
        code = self.refuses(start, count)
        words = struct.pack(f">{count}H", *range(start, start + count))
        body = bytes([function | 0x80, code]) if code else bytes([function, 2 * count]) + words
        self._waiting += struct.pack(">HHHB", tid, 0, len(body) + 1, unit) + body
        return self.plugged

    def receive(self, into: memoryview, wait_ns: int) -> int:
        if not self.plugged:
            return -1
        part = self._waiting[: len(into)]
        self._waiting = self._waiting[len(part) :]
        into[: len(part)] = part
        return len(part)

    def close(self, *, abort: bool) -> None:
        self._waiting = b""


def reader(plc: ScriptedPlc) -> WordReader:
    return WordReader(plc, device_id=1, clock=VirtualClock(), where="plc:502")


def outside(*given: range) -> Refuses:
    """Return what refuses every request that one of the runs does not hold whole."""
    return lambda start, count: (
        0 if any(start in run and start + count - 1 in run for run in given) else 2
    )


@pytest.mark.parametrize("given", [(range(18),), (range(3, 9), range(40, 41)), (range(99, 100),)])
def test_every_word_that_is_given_is_found_and_no_other(given: tuple[range, ...]) -> None:
    plc = ScriptedPlc(outside(*given))
    found = reader(plc).survey(0, 100)
    words = [word for block in found for word in range(block.start, block.start + block.count)]
    assert words == [word for run in given for word in run]
    assert set(plc.functions) == {3}


def test_a_window_longer_than_a_frame_and_a_device_that_gives_few_at_once() -> None:
    blocks = reader(ScriptedPlc(lambda _start, count: 3 if count > 32 else 0)).survey(100, 300)
    assert sum(block.count for block in blocks) == 300
    assert max(block.count for block in blocks) <= 32


def test_watching_keeps_every_reading_with_its_time() -> None:
    seen = reader(ScriptedPlc(outside(range(18)))).watch(
        [WordBlock(start=0, count=4), WordBlock(start=8, count=2)], 1.0
    )
    assert sorted(seen.words) == [0, 1, 2, 3, 8, 9]
    assert seen.words[9] == (9,) * len(seen.times_s)
    assert seen.duration_s == pytest.approx(1.0, abs=0.05)


def test_watching_ends_when_it_was_enough() -> None:
    one = reader(ScriptedPlc(outside(range(18))))
    seen = one.watch([WordBlock(start=0, count=4)], 60.0, lambda seen: seen.duration_s > 2.0)
    assert 2.0 < seen.duration_s < 3.0


def test_a_plc_that_is_unplugged_is_named_with_what_to_do() -> None:
    plc = ScriptedPlc(outside(range(18)))
    one = reader(plc)
    assert one.read(0, 2) == [0, 1]
    plc.plugged = False
    with pytest.raises(WireError, match=r"plc:502: unplugged\. Check cable"):
        one.watch([WordBlock(start=0, count=2)], 5.0)


def test_a_plc_that_knows_no_holding_registers_is_told_so() -> None:
    with pytest.raises(WireError, match="does not know function 3"):
        reader(ScriptedPlc(lambda _start, _count: 1)).survey(0, 10)


def test_a_busy_plc_is_asked_again() -> None:
    answers = iter([6, 6, 0])
    assert reader(ScriptedPlc(lambda _start, _count: next(answers))).read(5, 1) == [5]
