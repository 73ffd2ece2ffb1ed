"""Angles of rolls through wraps, glitches, losses and standstill."""

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aff_runtime.core.params import RollParams
from aff_runtime.core.phase import Quality, RollPhase, Source
from tests.aff_runtime.core.plants import COUNT_RAD, CYCLE_S, MODULUS_RAD
from tests.each_case import each_case

INDEX = {"angle": 0, "speed": 1, "line": 2, "radius": 3}
ROLL = RollParams(
    name="unwind",
    angle="angle",
    angle_modulus_rad=MODULUS_RAD,
    speed="speed",
    line_speed="line",
    radius="radius",
    radius_min_m=0.05,
    radius_max_m=0.5,
)
NAN = math.nan


def encoder(theta):
    counts = round(theta / COUNT_RAD)
    return ((counts + 2**31) % 2**32 - 2**31) * COUNT_RAD


def run(phase, omega, seconds, *, start=0.0, angle=encoder, speed=None, line=NAN, radius=0.2):
    """Turn at constant omega; return the true angle at the end and the largest step taken."""
    largest, theta, last = 0.0, start, phase.theta_rad
    for _ in range(round(seconds / CYCLE_S)):
        theta += omega * CYCLE_S
        surface = omega * radius if speed is None else speed
        phase.step((angle(theta), surface, line, radius), CYCLE_S, True)
        largest = max(largest, abs(phase.theta_rad - last))
        last = phase.theta_rad
    return theta, largest


@pytest.mark.parametrize("omega", [5.0, -5.0])
def test_encoder_wrap_of_32_bit_counts_is_unfolded(omega):
    phase = RollPhase(ROLL, INDEX)
    start = math.copysign(MODULUS_RAD / 2 - 4.0, omega)
    theta, _ = run(phase, omega, 0.2, start=start)
    offset = phase.theta_rad - theta
    theta, largest = run(phase, omega, 2.0, start=theta)
    assert abs(theta) > MODULUS_RAD / 2
    assert phase.theta_rad - theta == pytest.approx(offset, abs=2 * COUNT_RAD)
    assert largest < abs(omega) * CYCLE_S + 2 * COUNT_RAD
    assert phase.omega_rad_s == pytest.approx(omega, rel=0.01)
    assert phase.source is Source.ENCODER


def test_one_torn_word_is_predicted_over():
    phase = RollPhase(ROLL, INDEX)
    theta, _ = run(phase, 5.0, 0.5)
    offset = phase.theta_rad - theta
    theta, largest = run(
        phase, 5.0, CYCLE_S, start=theta, angle=lambda a: encoder(a) + 65536 * COUNT_RAD
    )
    assert phase.quality is Quality.PREDICTED
    assert largest == pytest.approx(5.0 * CYCLE_S, rel=0.05)
    theta, _ = run(phase, 5.0, 0.1, start=theta)
    assert phase.quality is Quality.GOOD
    assert phase.theta_rad - theta == pytest.approx(offset, abs=2 * COUNT_RAD)


def test_encoder_reset_keeps_the_phase_without_a_jump():
    phase = RollPhase(ROLL, INDEX)
    theta, _ = run(phase, 5.0, 0.5, start=1000.0)
    offset = phase.theta_rad - theta
    theta, largest = run(phase, 5.0, 1.0, start=theta, angle=lambda a: encoder(a - 1000.0))
    assert largest < 0.05
    assert phase.theta_rad - theta == pytest.approx(offset, abs=0.02)
    assert phase.source is Source.ENCODER


@pytest.mark.parametrize("loss", [lambda a: NAN, lambda a: 1.5])
def test_lost_encoder_falls_back_to_roll_speed_and_returns_without_jump(loss):
    phase = RollPhase(ROLL, INDEX)
    theta, _ = run(phase, 5.0, 1.0)
    offset = phase.theta_rad - theta
    theta, largest = run(phase, 5.0, 3.0, start=theta, angle=loss)
    assert phase.source is Source.ROLL_SPEED
    assert largest < 0.08
    assert phase.omega_rad_s == pytest.approx(5.0, rel=0.01)
    # a frozen encoder is noticed within half a radian or so; a missing one costs nothing
    assert phase.theta_rad - theta == pytest.approx(offset, abs=0.9)
    held = phase.theta_rad - theta
    theta, largest = run(phase, 5.0, 1.0, start=theta)
    assert phase.source is Source.ENCODER
    assert largest < 0.08
    assert phase.theta_rad - theta == pytest.approx(held, abs=0.3)


def test_line_speed_over_the_shrinking_radius_is_the_last_resort():
    phase = RollPhase(replace(ROLL, angle=None, speed=None), INDEX)
    expected, last = 0.0, None
    for k in range(2000):
        radius = 0.3 - 1e-4 * k * CYCLE_S
        phase.step((NAN, NAN, 1.0, radius), CYCLE_S, True)
        expected += 0.0 if last is None else CYCLE_S * 0.5 * (1 / radius + 1 / last)
        last = radius
    assert phase.source is Source.LINE_SPEED
    assert phase.theta_rad == pytest.approx(expected, abs=0.02)
    assert phase.omega_rad_s == pytest.approx(1 / radius, rel=1e-3)


def test_absurd_radius_is_ignored():
    phase = RollPhase(replace(ROLL, angle=None, speed=None), INDEX)
    phase.step((NAN, NAN, 1.0, 0.25), CYCLE_S, True)
    for bad in (0.0, -1.0, NAN, 7.0):
        phase.step((NAN, NAN, 1.0, bad), CYCLE_S, True)
        assert phase.radius_m == 0.25
        assert phase.omega_rad_s == pytest.approx(4.0)


@pytest.mark.parametrize(
    "sources",
    [{}, {"angle": None}, {"angle": None, "speed": None}],
    ids=["angle", "speed", "line"],
)
@pytest.mark.parametrize(
    ("reading", "where"),
    [(0.0499, "below radius_min_m 0.05 m"), (0.0, "below"), (0.5001, "above radius_max_m 0.5 m")],
)
def test_a_radius_outside_its_range_is_told_as_long_as_it_stands(sources, reading, where):
    phase = RollPhase(replace(ROLL, **sources), INDEX)
    phase.step((0.0, 1.0, 1.0, reading), CYCLE_S, True)
    assert "no radius is known" in phase.radius_note()
    phase.step((0.0, 1.0, 1.0, 0.25), CYCLE_S, True)
    assert phase.radius_note() == ""
    for _ in range(3):
        phase.step((0.0, 1.0, 1.0, reading), CYCLE_S, True)
        assert f"unwind: radius is {where}" in phase.radius_note()
        assert "the last one within, 0.25 m, stays" in phase.radius_note()
    for bound in (0.05, 0.5, NAN):  # the ends belong to the range; NaN is nobody's reading
        phase.step((0.0, 1.0, 1.0, bound), CYCLE_S, True)
        assert phase.radius_note() == ""


def test_a_fixed_radius_has_no_range():
    phase = RollPhase(replace(ROLL, radius=None, radius_m=0.2), INDEX)
    phase.step((0.0, 1.0, 1.0, 7.0), CYCLE_S, True)
    assert phase.radius_note() == ""


def test_stale_samples_are_predicted_then_given_up():
    phase = RollPhase(ROLL, INDEX)
    _ = run(phase, 5.0, 0.5)
    before = phase.theta_rad
    for _ in range(20):
        phase.step((NAN,) * 4, CYCLE_S, False)
    assert phase.theta_rad - before == pytest.approx(0.5, rel=0.01)
    assert phase.quality is Quality.PREDICTED
    for _ in range(100):
        phase.step((NAN,) * 4, CYCLE_S, False)
    assert phase.quality is Quality.LOST


def test_short_gap_ends_at_the_true_angle():
    phase = RollPhase(ROLL, INDEX)
    theta, _ = run(phase, 5.0, 0.5)
    offset = phase.theta_rad - theta
    for _ in range(6):
        theta += 5.2 * CYCLE_S
        phase.step((NAN,) * 4, CYCLE_S, False)
    theta, _ = run(phase, 5.2, CYCLE_S, start=theta)
    assert phase.theta_rad - theta == pytest.approx(offset, abs=2 * COUNT_RAD)


def test_lead_is_speed_times_time():
    phase = RollPhase(ROLL, INDEX)
    run(phase, 5.0, 1.0)
    assert phase.lead(0.02) - phase.theta_rad == pytest.approx(0.1, rel=0.01)


def test_standing_line_stays_finite():
    phase = RollPhase(ROLL, INDEX)
    run(phase, 5.0, 0.5)
    run(phase, 0.0, 2.0, radius=0.0)
    assert phase.omega_rad_s == pytest.approx(0.0, abs=1e-3)
    assert math.isfinite(phase.theta_rad)


NUMBERS = st.sampled_from([NAN, math.inf, -math.inf, 1e300, 0.0]) | st.floats(-1e7, 1e7)


@settings(max_examples=100, deadline=None)
@given(st.lists(st.tuples(NUMBERS, NUMBERS, NUMBERS, NUMBERS, st.booleans()), max_size=40))
def test_angle_is_finite_and_moves_plausibly_whatever_comes(samples):
    phase = RollPhase(ROLL, INDEX)
    run(phase, 5.0, 0.2)
    for *values, fresh in samples:
        before, gap = phase.theta_rad, phase._gap_s
        phase.step(values, CYCLE_S, fresh)
        assert math.isfinite(phase.theta_rad)
        assert math.isfinite(phase.omega_rad_s)
        assert abs(phase.theta_rad - before) <= ROLL.max_omega_rad_s * (gap + 2 * CYCLE_S) + 0.4


@each_case(
    ("factor", "said"),
    [
        (-1.0, "counts against"),
        (2.0, "2.00 times"),
        (0.5, "0.50 times"),
        (4096 / 1024, "4.00 times"),
    ],
)
def test_an_encoder_with_another_scale_or_sense_is_told_by_the_speed(factor, said):
    phase = RollPhase(ROLL, INDEX)
    run(phase, 5.0, 3.0, angle=lambda a: encoder(factor * a))
    assert said in phase.objection()


@pytest.mark.parametrize("omega", [5.0, -5.0])
def test_a_radius_that_is_a_fifth_off_or_a_standing_encoder_is_no_wrong_scale(omega):
    for kw in (
        {"speed": 1.2 * omega * 0.2},
        {"speed": 0.8 * omega * 0.2},
        {"angle": lambda a: 1.0},
    ):
        phase = RollPhase(ROLL, INDEX)
        run(phase, omega, 5.0, **kw)
        assert phase.objection() == ""
