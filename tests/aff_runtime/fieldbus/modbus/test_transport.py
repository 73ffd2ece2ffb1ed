"""The transport's rules in virtual time; the same faults over a socket are in test_wire_faults."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus.frames import ModbusFrames, WireFunction
from aff_runtime.fieldbus.modbus.transport import ModbusTransport
from tests.aff_runtime.fieldbus.fake_wire import Arrivals, FakeWire
from tests.aff_runtime.fieldbus.modbus_bytes import (
    exception_reply,
    function_of,
    register_reply,
    tid_of,
    written_words,
)
from tests.aff_runtime.fieldbus.modbus_rig import (
    DEADLINE_NS,
    MS,
    READ_COUNT,
    WORDS,
    Rig,
    good,
    silence,
)
from tests.doubles.virtual_clock import VirtualClock
from tests.drawn import drawn
from tests.each_case import each_case


def test_fc23_is_one_request_per_tick() -> None:
    rig = Rig().connected()
    rig.tick([0xFFFF, 7])
    request = rig.wire.requests[-1]
    assert len(rig.wire.requests) == 2
    assert (function_of(request), written_words(request)) == (23, [0xFFFF, 7])


def test_without_fc23_the_write_goes_first_and_the_read_sees_it() -> None:
    rig = Rig(WireFunction.FC3_FC16).connected()
    outcome, words = rig.tick([5, 6])
    write, read = rig.wire.requests[-2:]
    assert (function_of(write), written_words(write), function_of(read)) == (16, [5, 6], 3)
    assert (outcome, words) == (Outcome.OK, [tid_of(read)] * READ_COUNT)


def test_fc3_alone_writes_nothing() -> None:
    rig = Rig(WireFunction.FC3).connected()
    rig.tick()
    assert {function_of(request) for request in rig.wire.requests} == {3}


def test_write_and_read_share_one_deadline() -> None:
    rig = Rig(WireFunction.FC3_FC16).connected()
    rig.wire.answer = lambda request: [(2 * MS, good(request))]
    assert rig.tick()[0] is Outcome.TIMEOUT
    assert rig.waited_ns == DEADLINE_NS


def test_a_refused_write_is_not_followed_by_a_read() -> None:
    rig = Rig(WireFunction.FC3_FC16).connected()
    before = len(rig.wire.requests)
    rig.wire.answer = lambda request: [(MS, exception_reply(request, 2))]
    assert rig.tick()[0] is Outcome.EXCEPTION
    assert len(rig.wire.requests) == before + 1


def test_a_passed_deadline_sends_nothing() -> None:
    rig = Rig().connected()
    before = len(rig.wire.requests)
    assert rig.transport.transact(WORDS, rig.clock.now_ns())[0] is Outcome.TIMEOUT
    assert len(rig.wire.requests) == before


def test_a_write_block_of_the_wrong_size_is_never_sent() -> None:
    rig = Rig().connected()
    before = len(rig.wire.requests)
    assert rig.tick([1, 2, 3])[0] is Outcome.BAD_REPLY
    assert len(rig.wire.requests) == before


def test_nothing_is_sent_while_a_reply_is_outstanding() -> None:
    rig = Rig().connected()
    rig.wire.answer = lambda request: [(7 * MS, good(request))]
    before = len(rig.wire.requests)
    assert rig.outcomes(2) == [Outcome.TIMEOUT, Outcome.TIMEOUT]
    assert len(rig.wire.requests) == before + 1


def test_a_late_reply_is_thrown_away_and_the_next_answer_is_its_own() -> None:
    rig = Rig().connected()
    rig.wire.answer = lambda request: [(4 * MS, good(request))]
    assert rig.tick()[0] is Outcome.TIMEOUT
    rig.wire.answer = lambda request: [(MS, good(request))]
    assert rig.tick() == (Outcome.OK, [tid_of(rig.wire.requests[-1])] * READ_COUNT)


def test_half_a_reply_is_finished_in_a_later_tick_and_never_returned() -> None:
    rig = Rig().connected()
    rig.wire.answer = lambda request: [(MS, good(request)[:9]), (6 * MS, good(request)[9:])]
    assert rig.outcomes(2) == [Outcome.TIMEOUT, Outcome.TIMEOUT]
    rig.wire.answer = lambda request: [(MS, good(request))]
    assert rig.tick() == (Outcome.OK, [tid_of(rig.wire.requests[-1])] * READ_COUNT)
    assert len(rig.wire.requests) == 3


def test_an_endless_stream_of_old_replies_ends_at_the_deadline() -> None:
    rig = Rig().connected()
    old = register_reply(rig.wire.requests[0], [9] * READ_COUNT)
    rig.wire.answer = lambda _request: [(n * MS // 8, old) for n in range(100)]
    assert rig.tick()[0] is Outcome.TIMEOUT
    assert rig.waited_ns == DEADLINE_NS


def test_a_flood_that_is_no_frame_fills_no_memory() -> None:
    rig = Rig().connected()
    junk = bytes.fromhex("0001 0000 00FE") + bytes(200)
    rig.wire.answer = lambda _request: [(n, junk) for n in range(20)]
    assert rig.tick()[0] is Outcome.BAD_REPLY


def test_transaction_ids_run_past_their_range_without_zero() -> None:
    rig = Rig().connected()
    rig.transport._tid = 0xFFFE
    assert rig.outcomes(4) == [Outcome.OK] * 4
    assert [tid_of(request) for request in rig.wire.requests[-4:]] == [0xFFFF, 1, 2, 3]


def test_a_late_reply_from_before_the_id_wrapped_is_still_known() -> None:
    rig = Rig().connected()
    rig.transport._tid = 0xFFFE
    rig.wire.answer = lambda request: [(4 * MS, good(request))]
    assert rig.tick()[0] is Outcome.TIMEOUT
    rig.wire.answer = lambda request: [(MS, good(request))]
    assert rig.tick() == (Outcome.OK, [1] * READ_COUNT)


def test_id_zero_is_never_ours_even_after_a_wrap() -> None:
    rig = Rig().connected()
    rig.transport._tid = 0xFFFE
    assert rig.outcomes(1) == [Outcome.OK]
    rig.wire.answer = lambda request: [(MS, register_reply(request, [0] * READ_COUNT, tid=0))]
    assert rig.tick()[0] is Outcome.BAD_REPLY


@each_case(
    "bad",
    [
        {"silence_before_reconnect_s": 0.0},
        {"backoff_min_s": 0.0},
        {"backoff_min_s": 3.0},
        {"connect_timeout_s": 0.0},
    ],
)
def test_numbers_without_sense_are_refused(bad: dict[str, float]) -> None:
    clock = VirtualClock()
    frames = ModbusFrames(device_id=1, read_start=0, read_count=1)
    with pytest.raises(ConfigError):
        ModbusTransport(frames=frames, wire=FakeWire(clock, silence), clock=clock, **bad)  # type: ignore[arg-type]


HABITS = st.sampled_from(
    ("good", "late", "halves", "late half", "twice", "silent", "old", "closed", "lie", "junk")
)


def misbehave(habit: str, delay_ns: int, cut: int, request: bytes) -> Arrivals:
    reply = good(request)
    earlier = tid_of(request) - 1 or 0xFFFF
    return {
        "good": [(delay_ns, reply)],
        "late": [(delay_ns + DEADLINE_NS, reply)],
        "halves": [(0, reply[:cut]), (delay_ns, reply[cut:])],
        "late half": [(0, reply[:cut]), (delay_ns + DEADLINE_NS, reply[cut:])],
        "twice": [(delay_ns, reply + reply)],
        "silent": [],
        "old": [(0, register_reply(request, [0] * READ_COUNT, tid=earlier)), (delay_ns, reply)],
        "closed": [(delay_ns, None)],
        "lie": [(delay_ns, register_reply(request, [0] * (READ_COUNT + 1)))],
        "junk": [(delay_ns, bytes(cut))],
    }[habit]


@drawn(quick=40, long=300)
@given(
    st.sampled_from(WireFunction),
    st.lists(st.tuples(HABITS, st.integers(0, 4 * MS), st.integers(1, 11)), max_size=25),
)
def test_no_server_delays_a_tick_past_its_deadline_or_passes_off_an_old_answer(
    function: WireFunction, habits: list[tuple[str, int, int]]
) -> None:
    rig = Rig(function)
    pending = iter(habits)
    rig.wire.answer = lambda request: misbehave(*next(pending, ("good", 0, 1)), request)
    for _ in range(10 + 13 * len(habits)):
        outcome, words = rig.tick()
        assert rig.waited_ns <= DEADLINE_NS
        if outcome is Outcome.OK:
            assert words == [tid_of(rig.wire.requests[-1])] * READ_COUNT
        else:
            assert words == []
        if outcome is Outcome.NOT_CONNECTED:
            rig.clock.advance_ns(2000 * MS)  # past any pause
    assert rig.tick()[0] is Outcome.OK  # and it recovers from whatever that was


# --- a wire that may lose frames --------------------------------------------------------------


def lossy() -> Rig:
    rig = Rig()
    rig.wire.lossy = True
    return rig.connected()


def test_a_lost_frame_costs_its_tick_alone() -> None:
    rig = lossy()
    rig.wire.answer = silence
    assert rig.tick()[0] is Outcome.TIMEOUT
    rig.wire.answer = lambda request: [(MS, good(request))]
    assert rig.tick() == (Outcome.OK, [tid_of(rig.wire.requests[-1])] * READ_COUNT)
    assert rig.transport.connects == 1


def test_a_reply_that_comes_a_tick_late_is_not_the_next_answer() -> None:
    rig = lossy()
    rig.wire.answer = lambda request: [(6 * MS, good(request))]
    assert rig.tick()[0] is Outcome.TIMEOUT
    rig.wire.answer = lambda request: [(2 * MS, good(request))]
    assert rig.tick() == (Outcome.OK, [tid_of(rig.wire.requests[-1])] * READ_COUNT)


def test_a_reply_that_nobody_asked_for_ends_nothing() -> None:
    rig = lossy()
    rig.wire.answer = lambda request: [
        (MS, register_reply(request, [9] * READ_COUNT, tid=tid_of(request) + 1000)),
        (MS, register_reply(request, [9] * READ_COUNT, tid=0)),
        (2 * MS, good(request)),
    ]
    assert rig.outcomes(3) == [Outcome.OK] * 3
    assert rig.transport.connects == 1


def test_a_doubled_reply_is_taken_once() -> None:
    rig = lossy()
    rig.wire.answer = lambda request: [(MS, good(request)), (MS, good(request))]
    for _ in range(3):
        assert rig.tick() == (Outcome.OK, [tid_of(rig.wire.requests[-1])] * READ_COUNT)


def test_silence_counts_from_the_first_request_without_an_answer() -> None:
    rig = lossy()
    rig.wire.answer = silence
    assert rig.outcomes(11) == [Outcome.TIMEOUT] * 11  # 50 ms and the last deadline
    assert rig.tick()[0] is Outcome.NOT_CONNECTED
    assert rig.transport.trouble == "no reply within 0.05 s"


def test_after_a_silence_it_only_reads_until_it_was_answered() -> None:
    rig = lossy()
    rig.wire.answer = silence
    rig.outcomes(11)
    asked = len(rig.wire.requests)
    rig.outcomes(40)  # back-off, then asking again
    again = rig.wire.requests[asked:]
    assert again
    assert {function_of(request) for request in again} == {3}
    rig.wire.answer = lambda request: [(MS, good(request))]
    while rig.tick()[0] is not Outcome.OK:
        pass
    assert rig.transport.trouble == ""
    rig.tick()
    assert function_of(rig.wire.requests[-1]) == 23


def test_a_trouble_stands_until_a_good_reply() -> None:
    rig = Rig().connected()
    rig.wire.answer = silence
    rig.outcomes(40)
    assert rig.transport.trouble == "no reply within 0.05 s"
    rig.wire.answer = lambda request: [(MS, exception_reply(request, 2))]
    while rig.tick()[0] is not Outcome.EXCEPTION:
        pass
    assert "exception 2" in rig.transport.trouble
    rig.wire.answer = lambda request: [(MS, good(request))]
    rig.tick()
    assert rig.transport.trouble == ""


# MODBUS Application Protocol V1.1b3, section 7: every code and its name there
@each_case(
    ("code", "name"),
    [
        (2, "illegal data address"),
        (3, "illegal data value"),
        (4, "server device failure"),
        (5, "acknowledge"),
        (6, "server device busy"),
        (8, "memory parity error"),
        (10, "gateway path unavailable"),
        (11, "gateway target does not respond"),
        (77, "not in the standard"),
    ],
)
def test_an_exception_is_named_with_its_code_until_a_good_reply(code: int, name: str) -> None:
    rig = Rig().connected()
    rig.wire.answer = lambda request: [(MS, exception_reply(request, code))]
    assert rig.tick()[0] is Outcome.EXCEPTION
    assert f"refuses function 23 with exception {code} ({name}" in rig.transport.trouble
    rig.wire.answer = lambda request: [(MS, good(request))]
    rig.tick()
    assert rig.transport.trouble == ""


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (WireFunction.FC23, "function 23 (exception 1): write function: fc3_fc16 into"),
        (WireFunction.FC3_FC16, "function 16 (exception 1)"),
        (WireFunction.FC3, "function 3 (exception 1)"),
    ],
)
def test_a_function_that_the_plc_lacks_is_named(function: WireFunction, said: str) -> None:
    rig = Rig(function).connected()
    rig.wire.answer = lambda request: [(MS, exception_reply(request, 1))]
    rig.tick()
    assert said in rig.transport.trouble
