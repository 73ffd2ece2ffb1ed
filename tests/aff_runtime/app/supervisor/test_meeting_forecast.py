"""The next meeting of two rolls' orders, against the geometry of a winding roll."""

from __future__ import annotations

import math
import re

import pytest

from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.app.supervisor.meeting_forecast import MeetingForecast
from aff_runtime.config.loader import load_site
from tests.lockstep.known_response import ROOT
from tests.parameter_records import record_of

SITE = load_site(ROOT / "config" / "euclid.yaml")
RECORD = record_of(SITE)
WEB_M = 0.05e-3
MEETS_M = 0.15367  # both first orders: the fixed radius of the follower
STEP_M = 0.02e-3  # of the radius word


class Roll:
    """A roll that winds off (thickness > 0) or on, told to a forecast once a second."""

    def __init__(self, radius_m: float, thickness_m: float = WEB_M) -> None:
        self.square, self.thickness_m, self.time_s = radius_m**2, thickness_m, 0.0
        self.forecast = MeetingForecast()

    def run(self, seconds: int, speed_m_s: float) -> None:
        for _ in range(seconds):
            self.time_s += 1.0
            self.square -= self.thickness_m * speed_m_s / math.pi
            read_m = STEP_M * round(math.sqrt(self.square) / STEP_M)
            row = {"time_s": self.time_s, "fresh": 1.0, "line_speed_m_s": speed_m_s}
            row["unwind_radius_m"] = read_m
            self.forecast.step(RECORD, TickRow(row))

    def expected_s(self, speed_m_s: float) -> float:
        return (self.square - MEETS_M**2) * math.pi / (self.thickness_m * speed_m_s)

    def told_min(self) -> float:
        (text,) = self.forecast.sentences()
        meets = r"unwind 1x meets swrap_follower 1x at radius 0\.1537 m"
        found = re.fullmatch(rf"unwind: in about (\d+) min {meets}", text)
        assert found is not None, text
        return float(found[1])


@pytest.mark.parametrize("speed_m_s", [0.5, 1.0, 1.5])
def test_the_time_to_a_meeting_is_that_of_the_winding_roll(speed_m_s):
    roll = Roll(0.17)
    roll.run(60, 1.0)
    roll.run(2, speed_m_s)
    assert roll.told_min() == pytest.approx(roll.expected_s(speed_m_s) / 60.0, abs=0.6, rel=0.05)


def test_a_roll_that_runs_backwards_grows_and_meets_what_lies_above_it():
    roll = Roll(0.140)
    roll.run(40, -1.0)
    assert roll.told_min() == pytest.approx(roll.expected_s(-1.0) / 60.0, rel=0.1, abs=0.6)


def test_a_meeting_that_is_near_is_told_in_seconds():
    roll = Roll(0.157)
    while not roll.time_s or roll.expected_s(1.0) > 42.0:
        roll.run(1, 1.0)
    assert roll.forecast.sentences()[0].startswith("unwind: in about 40 s unwind 1x")


def test_what_lies_behind_is_no_forecast_and_on_a_roll_that_grows_it_lies_ahead():
    off, on = Roll(0.150), Roll(0.140, -WEB_M)
    off.run(40, 1.0)
    on.run(40, 1.0)
    assert off.forecast.sentences() == []
    assert on.told_min() == pytest.approx(on.expected_s(1.0) / 60.0, rel=0.1, abs=0.6)


def test_nothing_is_foretold_at_standstill_from_little_or_after_another_roll():
    roll = Roll(0.17)
    roll.run(5, 1.0)
    assert roll.forecast.sentences() == []
    roll.run(55, 1.0)
    assert roll.forecast.sentences()
    roll.run(1, 0.0)
    assert roll.forecast.sentences() == []
    roll.square = 0.19**2
    roll.run(5, 1.0)
    assert roll.forecast.sentences() == []
    roll.run(60, 1.0)
    assert roll.told_min() == pytest.approx(roll.expected_s(1.0) / 60.0, rel=0.05, abs=0.6)


def test_a_control_process_that_starts_anew_does_not_end_the_forecast():
    roll = Roll(0.17)
    roll.run(60, 1.0)
    roll.time_s = 0.0
    roll.run(3, 1.0)
    assert roll.forecast.sentences() == []
    roll.run(60, 1.0)
    assert roll.forecast.sentences()


def test_readings_that_are_none_are_left_out():
    roll = Roll(0.17)
    roll.run(60, 1.0)
    odd = {"time_s": 61.0, "fresh": 0.0, "unwind_radius_m": 0.2, "line_speed_m_s": 1.0}
    before = roll.forecast.sentences()
    roll.forecast.step(RECORD, TickRow(odd))
    assert roll.forecast.sentences() == before
    odd.update(fresh=1.0, unwind_radius_m=math.nan, line_speed_m_s=math.nan)
    roll.forecast.step(RECORD, TickRow(odd))
    assert roll.forecast.sentences() == []
    roll.forecast.step(RECORD, None)
    roll.time_s = 61.0
    roll.run(60, 1.0)
    assert roll.forecast.sentences()
