"""Amplitudes over turns: expected are the sizes that were put in, and what chance does to them."""

import math

import numpy as np
import pytest
from scipy import stats

from aff_runtime.app.report.comparison.page import change_text
from aff_runtime.app.report.comparison.turns import (
    Estimate,
    change,
    estimate,
    estimate_of_parts,
    order_per_turn,
    student_t,
)
from tests.each_case import each_case

STEP_S, SECONDS = 0.005, 120.0
FEW_AND_MANY = pytest.mark.parametrize("windows", [80, pytest.param(200, marks=pytest.mark.long)])
TIME_S = np.arange(round(SECONDS / STEP_S)) * STEP_S
ANGLE = 2.0 * np.pi * (0.8 * TIME_S + 0.0004 * TIME_S**2)  # a shrinking roll turns ever faster
GOOD = np.ones(TIME_S.size, dtype=bool)


def signal(size=1.0, order=1, angle=ANGLE, phase=0.7, noise=0.0, seed=1):
    """Return a ripple on a tension that has a mean, another roll's ripple, a drift and noise."""
    rng = np.random.default_rng(seed)
    other = 0.4 * np.cos(2.0 * np.pi * 1.317 * TIME_S) + 0.01 * TIME_S
    return (
        90.0
        + size * np.cos(order * angle + phase)
        + other
        + noise * rng.standard_normal(TIME_S.size)
    )


def found(values, order=1, encoder=True, good=GOOD, angle=ANGLE):
    turns, _ = order_per_turn(angle, values, good, [order])
    return estimate(turns[:, 0], encoder=encoder)


@each_case("order", [1, 2, 7, 16])
def test_an_order_has_the_size_that_was_put_in(order):
    result = found(signal(order=order), order)
    assert result.amplitude == pytest.approx(1.0, abs=0.02)
    assert result.low <= result.amplitude <= result.high
    assert result.turns == math.floor(ANGLE[-1] / (2.0 * np.pi)) - 1  # the first is left out too


def test_an_order_that_is_not_there_is_in_the_noise():
    assert not found(signal(noise=0.5), order=3).stands_out


@FEW_AND_MANY
def test_the_interval_holds_the_true_size_in_about_95_of_100_windows(windows):
    hits = 0
    for seed in range(windows):
        result = found(signal(size=0.2, noise=0.5, seed=seed))
        hits += result.low <= 0.2 <= result.high
    assert 0.90 <= hits / windows <= 0.99


@FEW_AND_MANY
def test_noise_alone_exceeds_the_floor_about_once_in_20_windows(windows):
    beyond = 0
    for seed in range(windows):
        rng = np.random.default_rng(seed)
        beyond += found(90.0 + rng.standard_normal(TIME_S.size)).stands_out
    assert beyond / windows <= 0.11


def test_without_an_encoder_the_size_survives_a_wandering_zero():
    wandering = (
        ANGLE + 2.0 * np.pi * 0.008 * TIME_S
    )  # a radius 1 % off: almost a whole turn in two minutes
    values = signal(noise=0.2, angle=wandering)
    assert found(values, encoder=False).amplitude == pytest.approx(1.0, abs=0.12)
    assert found(values).amplitude < 0.4  # the mean of the phasors is not the size any more


def test_turns_with_a_hole_are_left_out():
    values, good = signal(), GOOD.copy()
    values[4000:4200] = 0.0
    good[4000:4200] = False
    result = found(values, good=good)
    assert result.amplitude == pytest.approx(1.0, abs=0.03)
    assert result.turns < found(signal()).turns


def test_few_turns_have_no_interval():
    part = slice(0, round(6.0 / STEP_S))
    turns, _ = order_per_turn(ANGLE[part], signal()[part], GOOD[part], [1])
    result = estimate(turns[:, 0], encoder=True)
    assert 0 < result.turns < 8
    assert math.isnan(result.low)
    assert not result.stands_out


@each_case(("freedom", "point"), [(4, 2.776), (9, 2.262), (19, 2.093), (1000, 1.962)])
def test_students_points_are_those_of_the_tables(freedom, point):
    assert student_t(freedom) == pytest.approx(point, rel=0.005)


def size(amplitude, half=0.0, floor=0.01):
    low, high = amplitude - half, amplitude + half
    return Estimate(amplitude=amplitude, low=low, high=high, floor=floor, turns=100)


def test_a_change_is_20_log_of_the_ratio_and_its_interval_that_of_both():
    result = change(size(2.0, 0.02), size(0.2, 0.02))
    assert result.value_dB == pytest.approx(-20.0)
    half = 20.0 / math.log(10.0) * math.hypot(0.01, 0.1)
    assert (result.low_dB, result.high_dB) == pytest.approx((-20.0 - half, -20.0 + half))
    assert result.bound == ""


@pytest.mark.parametrize(
    ("before", "after", "bound", "value_dB"),
    [(1.0, 0.001, "at_most", -40.0), (0.001, 1.0, "at_least", 40.0), (0.001, 0.002, "none", None)],
)
def test_what_is_in_the_noise_gives_a_bound_and_no_figure(before, after, bound, value_dB):
    result = change(size(before), size(after))
    assert result.bound == bound
    if value_dB is None:
        assert math.isnan(result.value_dB)
    else:
        assert result.value_dB == pytest.approx(value_dB)


@pytest.mark.parametrize("other", [1.0, 0.001, math.nan])
def test_of_too_few_turns_for_a_noise_no_change_is_known(other):
    few = size(1.0, floor=math.nan)
    for result in (change(few, size(other)), change(size(other), few)):
        assert (result.bound, math.isnan(result.value_dB)) == ("unknown", True)
        assert change_text(result) == "change not known"


def test_a_bound_is_that_of_the_ends_which_make_it_hold():
    rise = change(size(0.008, 0.012), size(1.0, 0.2))
    assert rise.value_dB == rise.low_dB == pytest.approx(20.0 * math.log10(0.8 / 0.02))
    fall = change(size(1.0, 0.2), size(0.001))  # its upper end is below the floor of 0.01
    assert fall.value_dB == fall.high_dB == pytest.approx(20.0 * math.log10(0.01 / 0.8))
    assert math.isnan(rise.high_dB)
    assert math.isnan(fall.low_dB)
    assert change(size(0.02, 0.02), size(0.001)).bound == "unknown"


@pytest.mark.parametrize("of_floor", [0.5, 1.0, 1.3, 1.7])
def test_a_bound_of_the_change_is_wrong_in_fewer_than_5_of_100_pairs_of_windows(of_floor):
    """An order near the floor, which is found below it by chance, beside one of 8 floors."""
    rng, floor, wrong = np.random.default_rng(5), 1.73 * math.sqrt(2.0 / 40), 0
    for _ in range(200):
        noise = rng.standard_normal((2, 40, 2)) @ [1.0, 1.0j]
        hidden, seen = (
            estimate(a * floor + n, encoder=True)
            for a, n in zip((of_floor, 8.0), noise, strict=True)
        )
        found = change(hidden, seen)
        wrong += found.bound == "at_least" and found.value_dB > 20.0 * math.log10(8.0 / of_floor)
    assert wrong < 10


def parts(size, noise, seed, lengths=(30, 47, 12, 90)):
    """Return turns of a size in noise, each stretch of them with a phase of its own."""
    rng = np.random.default_rng(seed)
    off = [rng.standard_normal((n, 2)) @ [1.0, 1.0j] for n in lengths]
    return [size * np.exp(1j * k * 2.1) + noise * one for k, one in enumerate(off)]


def test_stretches_without_a_common_phase_are_joined_by_their_size():
    result = estimate_of_parts(parts(1.0, 0.1, 1), encoder=True)
    together = estimate(np.concatenate(parts(1.0, 0.1, 1)), encoder=True)
    assert result.amplitude == pytest.approx(1.0, abs=0.03)
    assert together.amplitude < 0.9  # what one mean over all of them makes of it
    assert result.turns == 30 + 47 + 12 + 90
    one = parts(1.0, 0.1, 1)[:1]
    assert estimate_of_parts(one, encoder=True) == estimate(one[0], encoder=True)


def test_the_interval_of_joined_stretches_holds_the_true_size_in_about_95_of_100():
    hits = 0
    for seed in range(400):
        result = estimate_of_parts(parts(0.3, 0.5, seed), encoder=True)
        hits += result.low <= 0.3 <= result.high
    assert 0.90 <= hits / 400 <= 0.99


def test_noise_alone_exceeds_the_floor_of_joined_stretches_about_once_in_20():
    beyond = sum(
        estimate_of_parts(parts(0.0, 0.5, seed), encoder=True).stands_out for seed in range(600)
    )
    assert 0.025 <= beyond / 600 <= 0.085


def test_a_turn_with_two_samples_far_apart_is_left_out():
    """Of a turn that lacks a third of its samples the trapezoid rule makes another size."""
    keep = np.abs(np.mod(ANGLE, 5.0 * 2.0 * np.pi) - 2.1) > 1.1
    turns, _ = order_per_turn(ANGLE[keep], signal()[keep], GOOD[keep], [1])
    assert abs(turns[:, 0].mean()) == pytest.approx(1.0, abs=0.02)
    assert len(turns) == pytest.approx(0.8 * ANGLE[-1] / (2.0 * np.pi), abs=2)


@each_case("freedom", [6, 8, 12, 40])
@each_case(("normal", "within"), [(1.959963985, 0.002), (4.0, 0.045)])
def test_the_points_of_students_distribution_are_near_those_of_scipy(freedom, normal, within):
    exact = stats.t.isf(stats.norm.sf(normal), freedom)
    assert student_t(freedom, normal) == pytest.approx(exact, rel=within)
