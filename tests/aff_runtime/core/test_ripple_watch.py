"""When ripple counts as risen."""

from __future__ import annotations

import cmath
import math
import random

from aff_runtime.base.signals import Permission
from aff_runtime.core.controller import Controller
from aff_runtime.core.ripple_watch import RippleWatch
from tests.aff_runtime.core.plants import ACTUATOR, CYCLE_S, LagDelay, Line, measured, site

TURNS = 0.1
SPEED = 1.0


def watch(before: float, after: float, turns: float, *, speed: float = SPEED) -> bool:
    """Twenty turns closed at ``before``, then ``turns`` open at ``after``."""
    judge = RippleWatch()
    for _ in range(200):
        judge.step((before, before), is_open=False, speed_m_s=SPEED, turns=TURNS)
    rose = [
        judge.step((before, after), is_open=True, speed_m_s=speed, turns=TURNS)
        for _ in range(round(turns / TURNS))
    ]
    return any(rose)


def test_a_third_more_for_four_turns_has_risen() -> None:
    assert not watch(1.0, 1.29, 30.0)
    assert not watch(1.0, 1.31, 3.8)
    assert watch(1.0, 1.31, 4.2)


def test_less_ripple_never_counts() -> None:
    assert not watch(1.0, 0.02, 100.0)


def test_another_speed_asks_for_another_reference() -> None:
    assert not watch(1.0, 2.0, 60.0, speed=1.3)
    assert watch(1.0, 2.0, 60.0, speed=1.1)


def test_growth_after_a_change_of_speed_is_still_seen() -> None:
    judge = RippleWatch()
    judge.step((1.0, 1.0), is_open=True, speed_m_s=0.5, turns=TURNS)
    rose = [
        judge.step((1.0, 2.0 * 1.02**k), is_open=True, speed_m_s=SPEED, turns=TURNS)
        for k in range(200)
    ]
    assert rose.index(True) * TURNS < 20.0


def _changes_speed_while_open(at_new_speed: float) -> RippleWatch:
    """Closed at 2.0, then open and quiet; the speed changes meanwhile."""
    judge = RippleWatch()
    for _ in range(200):
        judge.step((2.0, 2.0), is_open=False, speed_m_s=SPEED, turns=TURNS)
    for before, speed in ((2.0, SPEED), (at_new_speed, 0.7)):
        for _ in range(100):
            judge.step((before, 0.3), is_open=True, speed_m_s=speed, turns=TURNS)
    return judge


def test_a_correction_that_was_quiet_at_the_new_speed_may_be_louder_than_that() -> None:
    judge = _changes_speed_while_open(1.5)
    loud = [judge.step((1.5, 1.6), is_open=True, speed_m_s=0.7, turns=TURNS) for _ in range(200)]
    assert not any(loud)
    # armed again before the ripple came back
    judge.step((1.5, 0.3), is_open=False, speed_m_s=0.7, turns=TURNS)
    assert not any(
        judge.step((1.5, 2.3), is_open=True, speed_m_s=0.7, turns=TURNS) for _ in range(200)
    )


def test_a_law_that_claims_too_much_is_believed_up_to_what_was_there_without() -> None:
    judge = _changes_speed_while_open(50.0)
    rose = [judge.step((50.0, 2.7), is_open=True, speed_m_s=0.7, turns=TURNS) for _ in range(100)]
    assert any(rose)  # 1.3 times 2.0


def test_noise_around_a_small_ripple_is_no_rise() -> None:
    scatter = random.Random(3)
    judge = RippleWatch()
    for _ in range(300):
        now = 0.06 + scatter.uniform(-0.01, 0.01)  # standard deviation 0.02 / sqrt(12)
        judge.step((now, now), is_open=False, speed_m_s=SPEED, turns=TURNS)
    edge = 0.06 + 4.0 * 0.02 / math.sqrt(12.0)
    assert edge > 1.3 * 0.06
    quiet, loud = 0.96 * edge, 1.25 * edge
    assert not any(
        judge.step((0.06, quiet), is_open=True, speed_m_s=SPEED, turns=TURNS) for _ in range(300)
    )
    assert any(
        judge.step((0.06, loud), is_open=True, speed_m_s=SPEED, turns=TURNS) for _ in range(300)
    )


def test_a_bump_that_decays_like_the_monitor_is_no_rise() -> None:
    judge = RippleWatch()
    for _ in range(100):
        judge.step((0.5, 0.5), is_open=False, speed_m_s=SPEED, turns=TURNS)
    for k in range(400):
        bump = 10.0 * math.exp(-k * TURNS / 2.0)  # the monitor averages over two turns
        assert not judge.step((0.5, 0.5 + bump), is_open=True, speed_m_s=SPEED, turns=TURNS)


def test_what_is_unknown_is_not_judged() -> None:
    assert not watch(math.nan, math.nan, 50.0)
    assert not watch(1.0, math.nan, 50.0)


def test_after_closing_the_reference_is_taken_anew() -> None:
    judge = RippleWatch()
    for _ in range(100):
        judge.step((1.0, 1.0), is_open=False, speed_m_s=SPEED, turns=TURNS)
    while not judge.step((1.0, 3.0), is_open=True, speed_m_s=SPEED, turns=TURNS):
        pass
    for _ in range(200):
        judge.step((2.0, 2.0), is_open=False, speed_m_s=SPEED, turns=TURNS)
    assert not any(
        judge.step((2.0, 2.5), is_open=True, speed_m_s=SPEED, turns=TURNS) for _ in range(300)
    )


OMEGA = 5.0
RIPPLE = {("unwind", 1): 2.0 + 0j, ("unwind", 2): 1.0j}
CLOSED = Permission(adapt=False, applied_ratio=(0.0,), limit_ratio=(1.0,))
PLANT_GAIN = -300.0


def lockstep(sign: float, seconds: float) -> tuple[RippleWatch, bool, float]:
    """Run the law in a loop whose measured response is the true one times ``sign``."""
    true = LagDelay(PLANT_GAIN, delay=4, lag=0.9)
    response = measured(lambda f: sign * true.at(f), [0.3, 0.8, 1.6, 3.0])
    noise = random.Random(1)
    line = Line(true, RIPPLE, omega=OMEGA, seed_noise=lambda: noise.gauss(0.0, 0.3))
    law = Controller(site(ACTUATOR), {"unwind": response})
    judge = RippleWatch()
    every_s = 20 * CYCLE_S
    turns = every_s * OMEGA / math.tau
    line.plant.gain = 0.0  # the output is closed: nothing that the law says arrives
    for _ in range(100):
        line.run(law, every_s, CLOSED)
        judge.step(law.ripple()[0], is_open=False, speed_m_s=SPEED, turns=turns)
    line.plant.gain = PLANT_GAIN
    for k in range(round(seconds / every_s)):
        line.run(law, every_s)
        if judge.step(law.ripple()[0], is_open=True, speed_m_s=SPEED, turns=turns):
            return judge, True, k * every_s
    return judge, False, seconds


def test_a_response_of_the_wrong_sign_is_found_within_some_turns() -> None:
    judge, rose, after_s = lockstep(-1.0, 30.0)
    assert rose
    assert after_s < 15.0 * math.tau / OMEGA
    rms = math.sqrt(sum(abs(c) ** 2 for c in RIPPLE.values()))
    assert abs(judge.reference / rms - 1.0) < 0.1


def test_a_response_of_the_right_sign_is_left_alone() -> None:
    _, rose, _ = lockstep(1.0, 25.0)
    assert not rose


def test_a_response_sixty_degrees_off_is_left_alone() -> None:
    _, rose, _ = lockstep(cmath.rect(1.0, math.radians(60.0)), 25.0)  # type: ignore[arg-type]
    assert not rose


def reopened(closed_turns: float) -> RippleWatch:
    """Ripple 1 closed, 0.02 open, closed again for a while in which it has not come back yet."""
    judge = RippleWatch()
    for ripple, is_open, turns in ((1.0, False, 20.0), (0.02, True, 30.0)):
        for _ in range(round(turns / TURNS)):
            judge.step((1.0, ripple), is_open=is_open, speed_m_s=SPEED, turns=TURNS)
    for _ in range(round(closed_turns / TURNS)):
        judge.step((0.02, 0.02), is_open=False, speed_m_s=SPEED, turns=TURNS)
    return judge


def test_a_short_closing_keeps_the_reference() -> None:
    judge = reopened(0.2)
    for _ in range(300):
        assert not judge.step((0.02, 0.5), is_open=True, speed_m_s=SPEED, turns=TURNS)
    rose = [
        judge.step((0.02, 1.4), is_open=True, speed_m_s=SPEED, turns=TURNS) for _ in range(100)
    ]
    assert any(rose)


def test_a_long_closing_takes_a_new_reference() -> None:
    judge = reopened(20.0)
    rose = [
        judge.step((0.02, 0.5), is_open=True, speed_m_s=SPEED, turns=TURNS) for _ in range(100)
    ]
    assert any(rose)
