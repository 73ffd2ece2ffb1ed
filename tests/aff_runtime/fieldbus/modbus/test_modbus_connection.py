"""When a connection is dropped, kept and made anew, in virtual time."""

from __future__ import annotations

import itertools

import pytest

from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus.byte_stream import Connecting
from tests.aff_runtime.fieldbus.fake_wire import Arrivals
from tests.aff_runtime.fieldbus.modbus_bytes import (
    exception_reply,
    function_of,
    register_reply,
    tid_of,
)
from tests.aff_runtime.fieldbus.modbus_rig import (
    MS,
    PERIOD_NS,
    READ_COUNT,
    WORDS,
    Rig,
    good,
    silence,
)


@pytest.mark.parametrize(("silence_s", "silent_ticks"), [(0.003, 2), (0.01, 3), (0.05, 11)])
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
    assert rig.outcomes(9) == [Outcome.OK] * 9  # ten replies with the first one
    rig.wire.answer = silence
    silent = rig.outcomes(11)
    assert silent == [Outcome.TIMEOUT] * 11
    again = rig.outcomes(1 + 11 + 19)
    assert again == [Outcome.NOT_CONNECTED, *[Outcome.TIMEOUT] * 11, *[Outcome.NOT_CONNECTED] * 19]
    assert rig.transport.connects == 2


def test_a_connection_that_hardly_served_is_replaced_after_the_pause() -> None:
    rig = Rig().connected()
    assert rig.outcomes(8) == [Outcome.OK] * 8  # nine replies with the first one
    rig.wire.answer = silence
    again = rig.outcomes(11 + 19)
    assert again == [*[Outcome.TIMEOUT] * 11, *[Outcome.NOT_CONNECTED] * 19]
    assert rig.transport.connects == 1


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


def test_a_replaced_connection_writes_nothing_before_a_good_reply() -> None:
    rig = Rig().connected()
    assert rig.outcomes(9) == [Outcome.OK] * 9  # replaced at once
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
