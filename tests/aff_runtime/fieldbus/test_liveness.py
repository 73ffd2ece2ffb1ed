from __future__ import annotations

import pytest

from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.liveness import HeartbeatOrder, Liveness

MS = 1_000_000


def test_a_moved_heartbeat_is_fresh_and_a_repeated_one_is_not() -> None:
    live = Liveness(0, lost=False)
    assert [live.judge(Outcome.OK, beat, k * MS) for k, beat in enumerate((5, 6, 6))] == [
        Outcome.OK
    ] * 3
    assert not live.fresh
    assert live.age_s(11 * MS) == pytest.approx(0.010)


@pytest.mark.parametrize("outcome", [Outcome.TIMEOUT, Outcome.BAD_REPLY, Outcome.EXCEPTION])
def test_what_is_no_good_set_is_neither_fresh_nor_a_loss(outcome: Outcome) -> None:
    live = Liveness(0, lost=False)
    live.judge(Outcome.OK, 5, MS)
    live.judge(Outcome.OK, 6, 2 * MS)
    assert live.judge(outcome, 99, 3 * MS) is outcome
    assert (live.fresh, live.heartbeat, live.lost) == (False, 6, False)
    assert live.age_s(7 * MS) == pytest.approx(0.005)


def test_the_first_good_set_after_a_loss_counts_as_the_loss() -> None:
    live = Liveness(0, lost=False)
    for beat in (5, 6):
        live.judge(Outcome.OK, beat, MS)
    live.judge(Outcome.NOT_CONNECTED, 0, 2 * MS)
    assert live.lost
    assert live.judge(Outcome.OK, 900, 3 * MS) is Outcome.NOT_CONNECTED
    assert (live.fresh, live.heartbeat) == (False, 900)
    assert live.age_s(4 * MS) == pytest.approx(0.003)
    assert live.judge(Outcome.OK, 901, 4 * MS) is Outcome.OK
    assert live.fresh


def test_a_wire_that_starts_lost_believes_its_second_set() -> None:
    live = Liveness(0, lost=True)
    assert live.judge(Outcome.OK, 1, MS) is Outcome.NOT_CONNECTED
    assert live.judge(Outcome.OK, 1, 2 * MS) is Outcome.OK
    assert not live.fresh


def test_age_is_counted_from_the_arrival_and_not_from_the_taking() -> None:
    live = Liveness(0, lost=False)
    live.judge(Outcome.OK, 1, 0)
    live.judge(Outcome.OK, 2, 6 * MS)
    assert live.age_s(10 * MS) == pytest.approx(0.004)


def taken(order: HeartbeatOrder, beats: list[int]) -> list[bool]:
    last: int | None = None
    verdicts = []
    for beat in beats:
        verdicts.append(order.takes(beat, last))
        last = beat if verdicts[-1] else last
    return verdicts


def test_two_old_heartbeats_by_turns_never_move() -> None:
    assert taken(HeartbeatOrder(0xFFFF), [9, 10, 9, 10, 9, 10]) == [
        True,
        True,
        False,
        True,
        False,
        True,
    ]


@pytest.mark.parametrize("step", [1, 5, 100])
def test_a_program_that_began_again_is_taken_from_its_second_heartbeat_on(step: int) -> None:
    assert taken(HeartbeatOrder(0xFFFF), [20000, 0, step, 2 * step]) == [True, False, True, True]


def test_a_start_over_is_a_step_forward_and_a_jump_back_by_half_is_none() -> None:
    assert taken(HeartbeatOrder(0xFF), [250, 4]) == [True, True]
    assert taken(HeartbeatOrder(0xFF), [250, 250 - 0x80 + 1]) == [True, False]
    assert taken(HeartbeatOrder(0xFF), [250, 160, 240]) == [True, False, False]


def test_nothing_is_out_of_order_after_a_loss() -> None:
    order = HeartbeatOrder(0xFFFF)
    assert not order.takes(5, 9)
    order.forget()
    assert not order.takes(6, 9)
    assert order.takes(0, None)
