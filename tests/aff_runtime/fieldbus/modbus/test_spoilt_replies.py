"""One spoilt or lost frame of a serial wire costs its tick or two, at every cycle."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from aff_runtime.base.signals import Outcome, State
from tests.aff_runtime.fieldbus.modbus_bench import Bench, Spoil

TIMES = {10: 80, 12: 80, 20: 80, 60: 180}  # cycle_ms: fault_after_ms, the default where it may be
SERIAL = ("modbus_rtu", "modbus_rtu_tcp")
REPLY_BYTES = 3 + 2 * 18 + 2  # of the site's read block


@pytest.fixture(params=[(wire, cycle) for wire in SERIAL for cycle in TIMES], ids=str)
def bench(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Bench]:
    wire, cycle_ms = request.param
    running = Bench(wire, cycle_ms, TIMES[cycle_ms], tmp_path, monkeypatch)
    yield running
    running.runtime.gateway.close()


def flipped(place: int, mask: int) -> Spoil:
    return lambda reply: reply[:place] + bytes([reply[place] ^ mask]) + reply[place + 1 :]


def without(place: int) -> Spoil:
    return lambda reply: reply[:place] + reply[place + 1 :]


def doubled(place: int) -> Spoil:
    return lambda reply: reply[: place + 1] + reply[place:]


@pytest.mark.sweep(every=3)
def test_one_spoilt_byte_anywhere_in_a_reply_never_reaches_the_fault(bench: Bench) -> None:
    """Of the cycles of a wire two take the even bytes, two the odd ones."""
    runtime = bench.runtime
    runtime.run(2)
    for place in range(list(TIMES).index(bench.cycle_ms) % 2, REPLY_BYTES, 2):
        for spoil in (flipped(place, 0x01), flipped(place, 0x80), without(place), doubled(place)):
            bench.spoil = spoil
            heard = bench.plc.heartbeat
            runtime.run(5)
            assert bench.plc.heartbeat == heard + 5, "asked in every tick"
            assert runtime.guard.state is State.ACTIVE, f"byte {place}: {runtime.outside.reasons}"
    assert runtime.is_working
    assert bench.drops == 0
    assert runtime.gateway.troubles == ()


def test_a_line_that_spoils_every_reply_goes_to_zero_and_says_why(bench: Bench) -> None:
    for _ in range(30):
        bench.spoil = flipped(5, 0x10)
        bench.runtime.run(1)
    assert bench.runtime.guard.state is State.FAULT
    assert bench.runtime.is_zero
    assert "wrong CRC or length" in bench.runtime.gateway.troubles[0]


@pytest.mark.sweep(every=3)
def test_a_frame_that_is_lost_whole_is_asked_for_anew(bench: Bench) -> None:
    runtime = bench.runtime
    for _ in range(5):
        bench.lost = True
        asked = len(bench.line.requests)
        runtime.run(3)  # lost; waited for; a read, heard within three cycles of the reading before
        sent = bench.line.requests[asked:]
        assert [request[1] for request in sent] == [23, 3], "nothing is written before it is heard"
        runtime.run(10)
        assert runtime.guard.state is State.ACTIVE, runtime.outside.reasons
    assert bench.drops == 0
    assert runtime.gateway.troubles == ()


def test_at_the_end_only_a_zero_that_reached_the_plc_counts(bench: Bench) -> None:
    runtime = bench.runtime
    runtime.cycle.request_stop()
    while runtime.cycle.tick():  # every write is lost, and the read after it comes through
        bench.lost = runtime.is_zero and runtime.now("outcome") == Outcome.OK
        holds_zero = bench.plc.words[3] == bench.plc.words[8] == 0
        assert holds_zero or not runtime.cycle.zero_stands
    assert bench.plc.words[3] != 0
