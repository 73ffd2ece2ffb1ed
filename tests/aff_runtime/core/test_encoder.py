"""A good encoder is not ruled out by a speed channel that is off at standstill or lags a stop."""

from __future__ import annotations

import math
import random

import pytest

from aff_runtime.core.encoder import STOOD_S, TAIL_S, EncoderCheck, Trust
from aff_runtime.core.phase import PREDICT_MAX_S, Quality, RollPhase, Source
from tests.aff_runtime.core.plants import COUNT_RAD, CYCLE_S, MODULUS_RAD
from tests.aff_runtime.core.test_phase import INDEX, NAN, ROLL, encoder

RADIUS_M = 0.2
OMEGA = 5.0
CLOSE_RAD = 3.0 * COUNT_RAD


class Roll:
    """A roll that turns as told; ``shown_m_s`` is what its speed channel reads of it."""

    def __init__(self):
        self.phase = RollPhase(ROLL, INDEX)
        self.theta = 0.0
        self.sources = set()
        self.stuck_rad = None

    def turn(self, seconds, omega, shown_m_s):
        """``omega`` and ``shown_m_s`` are functions of the time since this call."""
        for k in range(round(seconds / CYCLE_S)):
            at_s = k * CYCLE_S
            self.theta += omega(at_s) * CYCLE_S
            angle = encoder(self.theta if self.stuck_rad is None else self.stuck_rad)
            self.phase.step((angle, shown_m_s(at_s), NAN, RADIUS_M), CYCLE_S, True)
            self.sources.add(self.phase.source)

    def steady(self, seconds, omega=OMEGA):
        self.turn(seconds, lambda _: omega, lambda _: omega * RADIUS_M)

    @property
    def frame_rad(self):
        """How the followed angle stands to the roll's own, whole turns apart."""
        return math.remainder(self.phase.theta_rad - self.theta, math.tau)


def stopping(seconds):
    return lambda at_s: max(0.0, OMEGA * (1.0 - at_s / seconds))


def lagging(tau_s, omega=OMEGA):
    """A speed that stopped at once, through a filter of first order."""
    return lambda at_s: omega * RADIUS_M * math.exp(-at_s / tau_s)


@pytest.mark.parametrize(("offset_m_s", "stood_s"), [(0.002, 300.0), (-0.05, 30.0)])
def test_an_offset_of_the_speed_at_standstill_leaves_the_encoder_in_service(offset_m_s, stood_s):
    roll = Roll()
    roll.steady(2.0)
    before = roll.frame_rad
    roll.turn(0.5, stopping(0.5), lambda at_s: stopping(0.5)(at_s) * RADIUS_M)
    roll.turn(stood_s, lambda _: 0.0, lambda _: offset_m_s)
    assert abs(offset_m_s / RADIUS_M * stood_s) > 2.5  # what the speed alone would have turned
    roll.steady(2.0)
    assert roll.frame_rad == pytest.approx(before, abs=CLOSE_RAD)
    assert roll.sources - {Source.NONE} <= {Source.ENCODER, Source.ROLL_SPEED}
    assert roll.phase.source is Source.ENCODER


@pytest.mark.parametrize("tau_s", [0.2, 0.5, 2.0, 4.0])
def test_a_filtered_speed_that_lags_a_stop_leaves_the_encoder_in_service(tau_s):
    roll = Roll()
    roll.steady(2.0)
    before, roll.sources = roll.frame_rad, set()
    roll.turn(10.0, lambda _: 0.0, lagging(tau_s))
    assert roll.sources == {Source.ENCODER}
    roll.steady(2.0)
    assert roll.frame_rad == pytest.approx(before, abs=CLOSE_RAD)


@pytest.mark.parametrize("late_s", [0.2, 0.4, 0.6])
def test_a_roll_that_follows_the_line_late_at_a_start_keeps_its_encoder(late_s):
    """Slack or a dancer's stroke feeds the line meanwhile: the line at 0.5 m/s2 to 1 m/s."""

    def ramp(at_s):
        return min(max(0.0, 0.5 * at_s), OMEGA * RADIUS_M)

    roll = Roll()
    roll.steady(2.0)
    before = roll.frame_rad
    for _ in range(3):
        roll.turn(0.5, stopping(0.5), lambda at_s: stopping(0.5)(at_s) * RADIUS_M)
        roll.turn(5.0, lambda _: 0.0, lambda _: 0.0)
        roll.turn(6.0, lambda at_s: ramp(at_s - late_s) / RADIUS_M, ramp)
    assert roll.phase.source is Source.ENCODER
    assert roll.frame_rad == pytest.approx(before, abs=CLOSE_RAD)


def test_an_encoder_that_a_late_speed_put_out_is_right_after_the_stop():
    roll = Roll()
    roll.steady(2.0)
    before, roll.sources = roll.frame_rad, set()
    late_s = 0.4  # the channel goes on for two radians at full speed
    roll.turn(
        late_s + STOOD_S + 0.1,
        lambda _: 0.0,
        lambda at_s: OMEGA * RADIUS_M if at_s < late_s else 0.0,
    )
    assert Source.ROLL_SPEED in roll.sources
    assert roll.phase.source is Source.ENCODER
    roll.steady(2.0)
    assert roll.frame_rad == pytest.approx(before, abs=CLOSE_RAD)


def test_an_encoder_that_was_out_long_before_the_stop_stays_out():
    roll = Roll()
    roll.steady(2.0)
    roll.stuck_rad = roll.theta
    roll.steady(TAIL_S + 1.0)
    assert roll.phase.source is Source.ROLL_SPEED
    roll.turn(0.5, stopping(0.5), lambda at_s: stopping(0.5)(at_s) * RADIUS_M)
    roll.turn(3.0 * STOOD_S, lambda _: 0.0, lambda _: 0.0)
    assert roll.phase.source is Source.ROLL_SPEED


@pytest.mark.parametrize("omega", [OMEGA, -OMEGA, 1.0])
def test_a_stuck_encoder_on_a_moving_line_is_out_within_half_a_radian(omega):
    roll = Roll()
    roll.steady(4.0, omega)
    roll.stuck_rad, before = roll.theta, roll.frame_rad
    roll.steady(1.2 / abs(omega), omega)
    assert roll.phase.source is Source.ROLL_SPEED
    assert roll.frame_rad == pytest.approx(before, abs=0.9)


def test_an_encoder_that_sticks_while_the_line_slows_is_out_once_it_goes_on():
    roll = Roll()
    roll.steady(2.0)
    roll.stuck_rad, roll.sources = roll.theta, set()
    roll.turn(1.0, stopping(2.0), lambda at_s: stopping(2.0)(at_s) * RADIUS_M)
    roll.steady(1.2 / 2.5, 2.5)
    assert roll.phase.source is Source.ROLL_SPEED


def test_the_ratio_of_a_turn_counts_no_standing():
    check = EncoderCheck()
    step_rad = OMEGA * CYCLE_S
    for _ in range(round(math.pi / step_rad)):
        check.judge(step_rad, OMEGA, CYCLE_S, 0.5)
    for _ in range(10_000):
        assert check.judge(0.0, 0.1, CYCLE_S, 0.5) is Trust.BELIEVED
    for _ in range(round(math.pi / step_rad) + 2):
        check.judge(step_rad, OMEGA, CYCLE_S, 0.5)
    assert check.ratio == pytest.approx(1.0)


def test_without_a_radius_nobody_knows_when_the_roll_stands():
    check = EncoderCheck()
    found = [check.judge(0.0, 0.1, CYCLE_S, NAN) for _ in range(2000)]
    assert found[-1] is Trust.OUT


@pytest.mark.parametrize("omega", [OMEGA, 0.9 * OMEGA])
def test_the_speed_channel_takes_the_place_of_an_encoder_that_reads_junk(omega):
    rng = random.Random(5)
    roll = Roll()
    roll.steady(2.0)
    before, qualities = roll.frame_rad, set()
    for _ in range(round(6.0 / CYCLE_S)):
        roll.theta += omega * CYCLE_S
        junk = rng.uniform(-0.5, 0.5) * MODULUS_RAD
        roll.phase.step((junk, omega * RADIUS_M, NAN, RADIUS_M), CYCLE_S, True)
        qualities.add(roll.phase.quality)
    assert roll.phase.source is Source.ROLL_SPEED
    assert Quality.LOST not in qualities
    assert roll.phase.omega_rad_s == pytest.approx(omega)
    # predicted at the former speed for half a second, and by the speed channel from there on
    assert roll.frame_rad - before == pytest.approx((OMEGA - omega) * PREDICT_MAX_S, abs=0.03)
    held = roll.frame_rad
    roll.steady(1.0, omega)
    assert roll.phase.source is Source.ENCODER
    assert roll.frame_rad == pytest.approx(held, abs=0.03)


def test_junk_without_a_speed_channel_is_lost():
    roll = Roll()
    roll.steady(2.0)
    for k in range(200):
        roll.phase.step((1000.0 * (-1) ** k, NAN, NAN, RADIUS_M), CYCLE_S, True)
    assert roll.phase.quality is Quality.LOST
