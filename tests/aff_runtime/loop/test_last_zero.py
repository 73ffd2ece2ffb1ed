"""What the cycle knows of the zero that the PLC took last, and how long it tries; virtual time."""

from __future__ import annotations

import pytest

from aff_runtime.base.signals import Outcome
from tests.aff_runtime.loop.rig import FADE_TICKS, PERIOD_NS, Rig
from tests.each_case import each_case

PATIENCE_TICKS = 10**9 // PERIOD_NS  # 1 s
SILENT = [Outcome.TIMEOUT, Outcome.NOT_CONNECTED, Outcome.BAD_REPLY, Outcome.EXCEPTION]


def ticks_to_the_end(rig: Rig) -> int:
    """Stop, and return how many ticks that takes."""
    rig.cycle.request_stop()
    for tick in range(1, 1000):
        if not rig.cycle.tick():
            return tick
    raise AssertionError("the cycle did not end")


def test_a_plc_that_answers_takes_five_zeros_and_that_is_known() -> None:
    rig = Rig().active()
    assert not rig.cycle.zero_stands
    ticks = ticks_to_the_end(rig)
    assert rig.cycle.zero_stands
    assert [command.corrections for _, command in rig.plc.commands[-5:]] == [(0.0,)] * 5
    assert ticks <= FADE_TICKS + 10


def commands_to_the_end(rig: Rig) -> int:
    """Tick until the cycle ends, 20 times at most, and return how many commands went out."""
    before = len(rig.plc.commands)
    for _ in range(20):
        if not rig.cycle.tick():
            break
    return len(rig.plc.commands) - before


@pytest.mark.parametrize("outcome", SILENT)
def test_zeros_that_nobody_answers_are_tried_for_a_second_and_are_not_called_zero(
    outcome: Outcome,
) -> None:
    rig = Rig().active()
    rig.plc.outcome = outcome
    ticks = ticks_to_the_end(rig)
    assert not rig.cycle.zero_stands
    assert PATIENCE_TICKS <= ticks <= FADE_TICKS + PATIENCE_TICKS + 5


def test_a_plc_that_comes_back_within_that_second_takes_the_five_zeros() -> None:
    rig = Rig().active()
    rig.plc.outcome = Outcome.TIMEOUT
    rig.cycle.request_stop()
    rig.run(FADE_TICKS + PATIENCE_TICKS // 2)
    rig.plc.outcome = Outcome.OK
    assert commands_to_the_end(rig) == 5
    assert rig.cycle.zero_stands


def test_one_zero_that_was_taken_is_a_zero_though_the_others_are_lost() -> None:
    rig = Rig().active()
    rig.plc.outcome = Outcome.TIMEOUT
    rig.cycle.request_stop()
    rig.run(FADE_TICKS + 20)
    rig.plc.outcome = Outcome.OK
    rig.run(1)
    rig.plc.outcome = Outcome.TIMEOUT
    while rig.cycle.tick():
        pass
    assert rig.cycle.zero_stands


def test_an_exchange_that_only_read_is_no_zero_that_the_plc_took() -> None:
    rig = Rig().active()
    rig.plc.only_reads = True
    ticks = ticks_to_the_end(rig)
    assert not rig.cycle.zero_stands
    assert PATIENCE_TICKS <= ticks <= FADE_TICKS + PATIENCE_TICKS + 5


def test_zeros_are_counted_from_the_first_that_was_sent_after_a_read() -> None:
    rig = Rig().active()
    rig.cycle.request_stop()
    rig.run(FADE_TICKS - 1)
    rig.plc.only_reads = True
    rig.run(10)
    rig.plc.only_reads = False
    assert commands_to_the_end(rig) == 5
    assert rig.cycle.zero_stands


@each_case("outcome", SILENT)
def test_where_nothing_but_zeros_went_out_the_end_is_not_waited_for(outcome: Outcome) -> None:
    never = Rig()
    never.plc.outcome = outcome
    assert ticks_to_the_end(never) <= 10
    assert never.cycle.zero_stands
    idle = Rig()
    idle.run(50)
    idle.plc.outcome = outcome
    assert ticks_to_the_end(idle) <= 10
    assert idle.cycle.zero_stands


def test_a_gateway_that_breaks_with_a_correction_out_leaves_it_unknown() -> None:
    rig = Rig().active()
    rig.plc.raises = OSError("gone")
    ticks_to_the_end(rig)
    assert not rig.cycle.zero_stands
