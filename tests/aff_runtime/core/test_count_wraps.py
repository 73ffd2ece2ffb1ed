"""A count that starts over before its word ends is told, with what its word lacks."""

import math
from dataclasses import replace

import pytest

from aff_runtime.core.count_wraps import CountWraps
from aff_runtime.core.phase import RollPhase
from tests.aff_runtime.core.test_phase import INDEX, ROLL, run

WORD, TURN = 65536, 4096
SIZE_RAD = math.tau / TURN
NARROW = replace(ROLL, angle_modulus_rad=WORD * SIZE_RAD, angle_counts=WORD)


def counts(after):
    return lambda theta: math.floor(theta / SIZE_RAD) % after * SIZE_RAD


@pytest.mark.parametrize("omega", [20.0, -20.0])
@pytest.mark.parametrize("after", [2 * TURN, 7000])
def test_an_early_restart_is_told_from_the_third_time_on(after, omega):
    phase = RollPhase(NARROW, INDEX)
    one_s = after * SIZE_RAD / abs(omega)
    theta, _ = run(phase, omega, 2.2 * one_s, start=0.5 * after * SIZE_RAD, angle=counts(after))
    assert phase.wraps.note() == ""
    run(phase, omega, one_s, start=theta, angle=counts(after))
    note = phase.wraps.note()
    assert note.startswith("unwind: angle: its count starts over after ")
    assert "(seen 3 times), not after 65536" in note
    told = int(note.rpartition(" ")[2])
    assert told == (after if after % TURN == 0 else pytest.approx(after, abs=3))


def test_a_count_that_keeps_its_word_or_is_set_anew_now_and_then_is_not_told():
    right = RollPhase(NARROW, INDEX)
    run(right, 20.0, 5.5 * WORD * SIZE_RAD / 20.0, angle=counts(WORD))
    assert right.wraps.note() == ""
    theta, anew = 0.0, RollPhase(NARROW, INDEX)
    for set_at in (0.0, 3.1, 9.2, 40.0, 55.5):
        theta, _ = run(
            anew, 20.0, 1.0, start=theta, angle=lambda a, by=set_at: counts(WORD)(a + by)
        )
    assert anew.wraps.note() == ""


def test_jumps_of_one_size_that_do_not_come_after_as_many_counts_are_none():
    watch = CountWraps(NARROW)
    for at_rad in (0.0, 10.0, 14.0, 29.0):
        watch.begin(0.1 - 4 * math.tau, 0.1, at_rad)
        watch.confirm()
    assert watch.found() is None
