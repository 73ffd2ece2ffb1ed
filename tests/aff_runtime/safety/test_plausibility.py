from __future__ import annotations

from math import inf, nan

import pytest

from aff_runtime.safety.params import ChannelParams, RadiusParams
from aff_runtime.safety.plausibility import ChannelCheck, RadiusCheck
from tests.each_case import each_case


def channel(**settings: float) -> ChannelCheck:
    return ChannelCheck(ChannelParams(channel=0, name="tension_N", **settings))  # type: ignore[arg-type]


@each_case("value", [nan, inf, -inf])
@each_case("running", [False, True])
def test_a_number_that_is_none_is_never_plausible(value: float, running: bool) -> None:
    assert not channel().is_plausible(value, 0.005, running)


@each_case(("value", "plausible"), [(1.0, True), (0.999, False), (400.0, True), (400.001, False)])
def test_range_counts_while_running(value: float, plausible: bool) -> None:
    judge = channel(minimum=1.0, maximum=400.0)
    assert judge.is_plausible(value, 0.005, running=True) is plausible
    assert judge.is_plausible(value, 0.005, running=False)


def test_a_value_without_any_change_is_stuck_after_the_time() -> None:
    judge = channel(stuck_after_s=0.1)
    verdicts = [judge.is_plausible(90.0, 0.01, running=True) for _ in range(12)]
    assert verdicts == [True] * 10 + [False] * 2
    assert judge.is_plausible(90.001, 0.01, running=True)


def test_standing_still_is_not_being_stuck() -> None:
    judge = channel(stuck_after_s=0.1)
    assert all(judge.is_plausible(90.0, 0.01, running=False) for _ in range(100))
    assert judge.is_plausible(90.0, 0.01, running=True)


def test_a_jump_faster_than_the_rate_is_implausible() -> None:
    judge = channel(rate_max=100.0)
    assert judge.is_plausible(90.0, 0.01, running=True)
    assert judge.is_plausible(90.99, 0.01, running=True)
    assert not judge.is_plausible(92.0, 0.01, running=True)
    assert judge.is_plausible(92.0, 0.01, running=True)


@pytest.mark.parametrize("shrinks", [True, False])
def test_a_roll_goes_one_way_within_tolerance_until_the_next_roll(shrinks: bool) -> None:
    judge = RadiusCheck(RadiusParams(channel=0, name="r", tolerance_m=0.005, shrinks=shrinks))
    way = -1.0 if shrinks else 1.0
    assert all(judge.is_plausible(0.2 + way * 0.001 * (step // 5)) for step in range(250))
    assert judge.is_plausible(0.2 + way * 0.0445)  # noise against the direction
    assert not judge.is_plausible(0.2 + way * 0.0435)
    judge.forget()
    assert judge.is_plausible(0.2)


@each_case("radius_m", [nan, inf, 0.0, -0.1, 0.19, 0.21])
def test_a_jump_or_no_radius_at_all_is_implausible(radius_m: float) -> None:
    judge = RadiusCheck(RadiusParams(channel=0, name="r", tolerance_m=0.005))
    assert judge.is_plausible(0.2)
    assert not judge.is_plausible(radius_m)


@each_case("shrinks", [True, False])
@each_case("wrong", [1, 2])
def test_a_wrong_radius_just_within_the_tolerance_condemns_no_right_one(
    shrinks: bool, wrong: int
) -> None:
    judge = RadiusCheck(RadiusParams(channel=0, name="r", tolerance_m=0.005, shrinks=shrinks))
    sense = 1.0 if shrinks else -1.0
    off_mm = [0.0, 0.2, 0.1, 0.2, *[-4.9] * wrong, 0.0, 0.2, 0.0, 0.2, 0.1, 0.2, 0.0, 0.2]
    assert all(judge.is_plausible(0.3 + sense * 1e-3 * off) for off in off_mm)


@pytest.mark.parametrize("shrinks", [True, False])
def test_a_radius_that_goes_its_way_is_followed_and_may_not_come_back(shrinks: bool) -> None:
    judge = RadiusCheck(RadiusParams(channel=0, name="r", tolerance_m=0.005, shrinks=shrinks))
    sense = -1.0 if shrinks else 1.0
    # 0.5 mm a reading: the median is two readings behind the last one
    assert all(judge.is_plausible(0.3 + sense * 5e-4 * k) for k in range(100))
    extreme_m = 0.3 + sense * 5e-4 * 97
    assert judge.is_plausible(extreme_m - sense * 0.0049)
    assert not judge.is_plausible(extreme_m - sense * 0.0051)
