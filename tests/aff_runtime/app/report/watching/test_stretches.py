"""Steady stretches of a record: rows from a formula, with what may happen to them."""

from pathlib import Path

import numpy as np
import pytest

from aff_runtime.app.report.watching.stretches import LONGEST_S, is_correcting, steady
from aff_runtime.base.runs.table import RunTable
from aff_runtime.base.runs.window import RunWindow
from aff_runtime.base.signals import Outcome, StateBits, Status
from aff_runtime.base.yaml_section import Section
from tests.each_case import each_case

CYCLE_S = 0.05
TIME_S = np.arange(round(200.0 / CYCLE_S)) * CYCLE_S + 1000.0
SINCE_S = TIME_S - 1000.0
SPEED = "line_speed_m_s"


def table(keep=slice(None), **columns):
    """Return 200 s at 1 m/s, AFF off, but for ``columns``."""
    rows = {"time_s": TIME_S, SPEED: np.ones(TIME_S.size), "correction_unwind_m_s": 0.0 * TIME_S}
    rows |= columns
    return RunTable(
        window=RunWindow(folder=Path("run")),
        about=Section(),
        columns={name: values[keep] for name, values in rows.items()},
        site_text="",
        events=(),
        lost=(),
    )


def between(from_s, to_s, value, otherwise=0.0):
    """Return a column that is ``value`` from ... to, s from the start."""
    inside = (from_s <= SINCE_S) & (to_s > SINCE_S)
    return np.where(inside, value, otherwise)


def span(window):
    """Return the stretch, s from the start."""
    return window.time_s[0] - 1000.0, window.time_s[-1] - 1000.0 + CYCLE_S


def test_a_steady_record_gives_as_much_as_is_taken_of_one():
    assert span(steady(table(), SPEED)) == pytest.approx((0.0, LONGEST_S), abs=2.0 * CYCLE_S)
    assert steady(table(keep=slice(0, 370)), SPEED) is None  # 18.5 s
    assert steady(table(), "another_speed_m_s") is None


@each_case(
    "what",
    [
        {"status": between(50.0, 50.1, float(Status.SPLICE_ACTIVE))},
        {"state_bits": between(50.0, 50.1, float(StateBits.SATURATED))},
        {"probe.stage": between(50.0, 50.1, 2.0)},
        {SPEED: between(50.0, 50.1, 0.0, otherwise=1.0)},
        {"correction_unwind_m_s": between(50.0, 50.1, 0.01)},
    ],
)
def test_what_disturbs_is_in_no_stretch(what):
    assert span(steady(table(**what), SPEED)) == pytest.approx((51.0, 171.0), abs=2.0 * CYCLE_S)


def test_readings_of_the_speed_that_lack_are_no_standstill_and_a_second_of_none_is_one():
    lacks = np.where(np.arange(TIME_S.size) % 31 < 4, np.nan, 1.0)
    assert span(steady(table(**{SPEED: lacks}), SPEED)) == pytest.approx((0.0, LONGEST_S), abs=0.1)
    lacks[(SINCE_S >= 50.0) & (SINCE_S < 51.0)] = np.nan
    assert span(steady(table(**{SPEED: lacks}), SPEED)) == pytest.approx((51.0, 171.0), abs=0.1)


def test_of_two_speeds_the_longer_is_taken_and_a_slow_ramp_is_none():
    two = table(**{SPEED: between(0.0, 90.0, 1.0, otherwise=1.02)})
    assert span(steady(two, SPEED)) == pytest.approx((90.0, 200.0), abs=2.0 * CYCLE_S)
    ramp = table(**{SPEED: 1.0 + 0.002 * SINCE_S})  # 1 % in 5 s
    assert steady(ramp, SPEED) is None


def test_a_stretch_is_corrected_all_along_or_not_at_all():
    window = steady(table(correction_unwind_m_s=between(95.0, 200.0, 0.01)), SPEED)
    assert span(window) == pytest.approx((95.0, 200.0), abs=2.0 * CYCLE_S)
    assert is_correcting(window)
    assert not is_correcting(steady(table(), SPEED))


def test_a_hole_ends_a_stretch():
    keep = (SINCE_S < 30.0) | (SINCE_S >= 80.0)
    assert span(steady(table(keep=keep), SPEED)) == pytest.approx((80.0, 200.0), abs=1.0)


def test_a_line_that_stands_still_has_no_stretch():
    assert steady(table(**{SPEED: 0.0 * TIME_S}), SPEED) is None


def test_a_stretch_whose_rows_show_no_readings_is_none():
    outcome = between(10.0, 200.0, np.nan, otherwise=float(Outcome.OK))
    assert steady(table(outcome=outcome), SPEED) is None
    assert steady(table(outcome=np.full(TIME_S.size, float(Outcome.OK))), SPEED) is not None
