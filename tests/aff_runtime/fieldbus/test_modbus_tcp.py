"""The transport's rules in virtual time; the same faults over a socket are in test_wire_faults."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aff_runtime.base.clock import VirtualClock
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus_frames import ModbusFrames, WireFunction
from aff_runtime.fieldbus.modbus_tcp import ModbusTcpTransport
from aff_runtime.fieldbus.tcp_wire import Connecting
from tests.aff_runtime.fieldbus.fake_wire import Arrivals, FakeWire
from tests.aff_runtime.fieldbus.modbus_bytes import (
    exception_reply,
    function_of,
    register_reply,
    tid_of,
    write_reply,
    written_words,
)

MS = 1_000_000
DEADLINE_NS = 3 * MS
PERIOD_NS = 5 * MS
WORDS = [11, 12]
READ_COUNT = 3


def good(request: bytes) -> bytes:
    """A reply whose words name the request they answer."""
    if function_of(request) == 16:
        return write_reply(request)
    return register_reply(request, [tid_of(request)] * READ_COUNT)


class Rig:
    """A transport on a fake wire, ticked every 5 ms with 3 ms for the wire."""

    def __init__(
        self, function: WireFunction = WireFunction.FC23, silence_s: float = 0.05
    ) -> None:
        self.clock = VirtualClock(start_ns=10**9)
        self.wire = FakeWire(self.clock, lambda request: [(MS, good(request))])
        frames = ModbusFrames(
            device_id=1, read_start=0, read_count=READ_COUNT, write_start=100, write_count=2
        )
        self.transport = ModbusTcpTransport(
            frames=frames, wire=self.wire, clock=self.clock, function=function,
            silence_before_reconnect_s=silence_s,
        )  # fmt: skip
        self.waited_ns = 0

    def tick(self, words: list[int] | None = None) -> tuple[Outcome, list[int]]:
        start_ns = self.clock.now_ns()
        result = self.transport.transact(words or WORDS, start_ns + DEADLINE_NS)
        self.waited_ns = self.clock.now_ns() - start_ns
        self.clock.sleep_until_ns(start_ns + PERIOD_NS)
        return result

    def outcomes(self, ticks: int) -> list[Outcome]:
        return [self.tick()[0] for _ in range(ticks)]

    def connected(self) -> Rig:
        assert self.outcomes(2) == [Outcome.NOT_CONNECTED, Outcome.OK]
        return self


def silence(_request: bytes) -> Arrivals:
    return []


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
    assert rig.transport.discarded_replies == 1


@pytest.mark.parametrize(("silence_s", "silent_ticks"), [(0.003, 1), (0.01, 3), (0.05, 11)])
def test_a_silence_drops_the_connection_with_a_reset(silence_s: float, silent_ticks: int) -> None:
    rig = Rig(silence_s=silence_s).connected()
    rig.wire.answer = silence
    expected = [*[Outcome.TIMEOUT] * silent_ticks, Outcome.NOT_CONNECTED]
    assert rig.outcomes(silent_ticks + 1) == expected
    assert rig.wire.aborted == [True]


def test_our_own_lateness_does_not_drop_the_connection() -> None:
    rig = Rig().connected()
    for _ in range(40):
        assert rig.transport.transact(WORDS, rig.clock.now_ns())[0] is Outcome.TIMEOUT
        rig.clock.sleep_until_ns(rig.clock.now_ns() + PERIOD_NS)
    assert (rig.wire.aborted, rig.tick()[0]) == ([], Outcome.OK)


def test_a_plc_that_pauses_for_40_ms_is_waited_for() -> None:
    rig = Rig().connected()
    rig.wire.answer = lambda request: [(40 * MS, good(request))]
    assert rig.outcomes(8) == [Outcome.TIMEOUT] * 8
    rig.wire.answer = lambda request: [(MS, good(request))]
    assert (rig.tick()[0], rig.wire.aborted) == (Outcome.OK, [])


def test_a_connection_that_served_is_replaced_at_once_but_only_once() -> None:
    rig = Rig().connected()
    assert rig.outcomes(400) == [Outcome.OK] * 400  # 2 s, the longest back-off
    rig.wire.answer = silence
    silent = rig.outcomes(11)
    assert silent == [Outcome.TIMEOUT] * 11
    again = rig.outcomes(1 + 11 + 19)
    assert again == [
        Outcome.NOT_CONNECTED, *[Outcome.TIMEOUT] * 11, *[Outcome.NOT_CONNECTED] * 19
    ]  # fmt: skip
    assert rig.transport.connects == 2


def test_an_answer_between_misses_keeps_the_connection() -> None:
    rig = Rig().connected()
    for _ in range(3):
        rig.wire.answer = lambda request: [(4 * MS, good(request))]
        assert rig.tick()[0] is Outcome.TIMEOUT
        rig.wire.answer = lambda request: [(MS, good(request))]
        assert rig.tick()[0] is Outcome.OK
    assert rig.wire.aborted == []


def test_an_exception_is_reported_and_keeps_the_connection() -> None:
    rig = Rig().connected()
    rig.wire.answer = lambda request: [(MS, exception_reply(request, 6))]
    assert rig.outcomes(5) == [Outcome.EXCEPTION] * 5
    assert (rig.transport.last_exception_code, rig.transport.connects) == (6, 1)


def test_a_request_the_socket_does_not_take_drops_the_connection() -> None:
    rig = Rig().connected()
    rig.wire.takes_bytes = False
    assert rig.tick()[0] is Outcome.NOT_CONNECTED
    assert rig.wire.aborted == [True]


def test_half_a_reply_is_finished_in_a_later_tick_and_never_returned() -> None:
    rig = Rig().connected()
    rig.wire.answer = lambda request: [(MS, good(request)[:9]), (6 * MS, good(request)[9:])]
    assert rig.outcomes(2) == [Outcome.TIMEOUT, Outcome.TIMEOUT]
    rig.wire.answer = lambda request: [(MS, good(request))]
    assert rig.tick() == (Outcome.OK, [tid_of(rig.wire.requests[-1])] * READ_COUNT)
    assert len(rig.wire.requests) == 3


def test_half_a_reply_does_not_survive_a_reconnect() -> None:
    rig = Rig().connected()
    rig.wire.answer = lambda request: [(MS, good(request)[:9])]
    assert rig.outcomes(11) == [Outcome.TIMEOUT] * 11
    rig.wire.answer = lambda request: [(MS, good(request))]
    results = [rig.tick() for _ in range(40)]
    answered = [words for outcome, words in results if outcome is Outcome.OK]
    sent = [tid_of(request) for request in rig.wire.requests[2:]]
    assert answered == [[tid] * READ_COUNT for tid in sent]
    assert Outcome.BAD_REPLY not in [outcome for outcome, _ in results]


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


def test_every_attempt_to_connect_costs_a_visible_tick() -> None:
    rig = Rig().connected()
    rig.wire.answer = lambda _request: [(MS, None)]
    assert rig.tick()[0] is Outcome.NOT_CONNECTED
    rig.wire.answer = lambda request: [(MS, good(request))]
    rig.clock.advance_ns(10**9)
    assert rig.outcomes(2) == [Outcome.NOT_CONNECTED, Outcome.OK]


def test_the_pause_between_attempts_doubles_to_two_seconds_and_starts_over_after_success() -> None:
    rig = Rig()
    rig.wire.refuses = True
    rig.outcomes(2000)
    steps_s = [
        round((later - earlier) * 1e-9, 6)
        for earlier, later in itertools.pairwise(rig.wire.attempts_ns)
    ]
    assert steps_s[:7] == [0.1, 0.2, 0.4, 0.8, 1.6, 2.0, 2.0]
    rig.wire.refuses = False
    while rig.tick()[0] is not Outcome.OK:
        pass
    rig.wire.refuses = True
    rig.wire.answer = lambda _request: [(0, None)]
    lost_ns = rig.clock.now_ns()
    rig.outcomes(30)
    assert rig.wire.attempts_ns[-1] - lost_ns == 100 * MS


def test_connecting_without_an_answer_to_it_keeps_backing_off() -> None:
    rig = Rig()
    rig.wire.answer = silence
    rig.outcomes(2000)
    last, before = rig.wire.attempts_ns[-1], rig.wire.attempts_ns[-2]
    assert last - before >= 2000 * MS


def test_an_attempt_that_never_ends_is_given_up_after_a_second() -> None:
    rig = Rig()
    rig.wire.state = Connecting.PENDING
    assert set(rig.outcomes(240)) == {Outcome.NOT_CONNECTED}
    first, second = rig.wire.attempts_ns
    assert second - first == 1100 * MS


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


def test_a_closed_transport_may_be_used_again_and_knows_nothing_of_before() -> None:
    rig = Rig().connected()
    rig.wire.answer = lambda request: [(MS, good(request)[:9])]
    rig.tick()
    rig.transport.close()
    rig.wire.answer = lambda request: [(MS, good(request))]
    assert rig.outcomes(2) == [Outcome.NOT_CONNECTED, Outcome.OK]


def test_an_id_of_the_connection_before_is_foreign_to_the_new_one() -> None:
    rig = Rig().connected()
    rig.transport.close()
    rig.wire.answer = lambda request: [
        (MS, register_reply(request, [0] * READ_COUNT, tid=tid_of(request) - 1))
    ]
    assert rig.outcomes(2) == [Outcome.NOT_CONNECTED, Outcome.BAD_REPLY]


def test_close_with_a_reply_outstanding_resets_and_else_says_goodbye() -> None:
    quiet = Rig().connected()
    quiet.transport.close()
    waiting = Rig().connected()
    waiting.wire.answer = silence
    waiting.tick()
    waiting.transport.close()
    assert (quiet.wire.aborted, waiting.wire.aborted) == ([False], [True])


@pytest.mark.parametrize(
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
        ModbusTcpTransport(frames=frames, wire=FakeWire(clock, silence), clock=clock, **bad)  # type: ignore[arg-type]


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


@settings(max_examples=400, deadline=None)
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


def test_a_replaced_connection_writes_nothing_before_a_good_reply() -> None:
    rig = Rig().connected()
    assert rig.outcomes(400) == [Outcome.OK] * 400  # 2 s, the longest back-off
    asked: list[int] = []

    def half(request: bytes) -> Arrivals:
        asked.append(function_of(request))
        return [(MS, good(request)[:8])]

    def whole(request: bytes) -> Arrivals:
        asked.append(function_of(request))
        return [(MS, good(request))]

    rig.wire.answer = half
    rig.outcomes(200)
    assert len(asked) > 3
    assert asked[0] == 23
    assert set(asked[1:]) == {3}
    asked.clear()
    rig.wire.answer = whole
    while Outcome.OK not in rig.outcomes(1):
        pass
    assert asked == [3]
    assert rig.outcomes(2) == [Outcome.OK] * 2
    assert asked == [3, 23, 23]
