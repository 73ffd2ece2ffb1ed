"""Ripple under other settings against what it was before: a sine of known size."""

import math

import pytest

from aff_runtime.app.supervisor.settings.ripple_rise import NOW_S, SETTLE_S, RippleRise

STEP_S = 0.005
F_HZ = 0.83


def hear(rise, start_s, seconds, amplitude, offset=89.0):
    """Feed a sine; return when it was first said to have risen, s; None when it was not."""
    for k in range(round(seconds / STEP_S)):
        time_s = start_s + k * STEP_S
        value = offset + amplitude * math.sin(math.tau * F_HZ * time_s)
        rise.take(time_s, {"unwind_tension_N": value})
        if k % 20 == 0 and rise.risen():
            return time_s
    return None


@pytest.mark.parametrize(
    ("factor", "rose"), [(0.3, False), (1.0, False), (1.2, False), (1.6, True)]
)
def test_ripple_rose_when_it_is_a_third_larger_than_before(factor, rose):
    rise = RippleRise()
    hear(rise, 0.0, 20.0, 1.0)
    rise.begin()
    when = hear(rise, 20.0, 20.0, factor)
    assert (when is not None) is rose
    if when is not None:
        assert SETTLE_S + NOW_S <= when - 20.0 <= SETTLE_S + NOW_S + 1.0


def test_what_was_heard_while_settings_came_in_does_not_count():
    rise = RippleRise()
    hear(rise, 0.0, 20.0, 1.0)
    rise.begin()
    assert hear(rise, 20.0, SETTLE_S - 0.5, 9.0) is None
    assert hear(rise, 20.0 + SETTLE_S, 20.0, 0.5) is None


def test_a_mean_that_is_another_one_is_no_ripple():
    rise = RippleRise()
    hear(rise, 0.0, 20.0, 1.0)
    rise.begin()
    assert hear(rise, 20.0, 20.0, 1.0, offset=95.0) is None


def test_without_ripple_before_nothing_is_judged():
    rise = RippleRise()
    hear(rise, 0.0, 2.0, 1.0)
    rise.begin()
    assert hear(rise, 2.0, 20.0, 50.0) is None


def test_readings_that_are_none_count_for_nothing():
    rise = RippleRise()
    hear(rise, 0.0, 20.0, 1.0)
    rise.begin()
    for k in range(4000):
        rise.take(20.0 + k * STEP_S, {"unwind_tension_N": math.nan})
    assert rise.risen() == ""


def test_the_words_name_signal_and_sizes():
    rise = RippleRise()
    hear(rise, 0.0, 20.0, 1.0)
    rise.begin()
    hear(rise, 20.0, 12.0, 3.0)
    assert rise.risen().startswith("ripple of unwind_tension_N rose from 0.7")


@pytest.mark.parametrize("tried_s", [3.0, 6.5])
def test_a_try_right_after_a_bad_one_is_judged_by_what_was_before_both(tried_s):
    rise = RippleRise()
    hear(rise, 0.0, 20.0, 1.0)
    rise.begin()
    hear(rise, 20.0, tried_s, 5.0)  # somebody undoes it before 7 s are over
    rise.end()
    hear(rise, 20.0 + tried_s, 1.0, 1.0)
    rise.begin()
    assert hear(rise, 21.0 + tried_s, 20.0, 3.0) is not None


def test_five_seconds_after_a_try_what_was_heard_since_is_what_was_before():
    rise = RippleRise()
    hear(rise, 0.0, 20.0, 1.0)
    rise.begin()
    hear(rise, 20.0, 6.0, 1.0)
    rise.end()
    hear(rise, 26.0, 10.0, 4.0)  # the line runs rougher now, with the former settings
    rise.begin()
    assert hear(rise, 36.0, 20.0, 4.0) is None
