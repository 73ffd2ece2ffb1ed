"""The iterative block: by formula on a plant of known response, and on the whole line."""

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest

from aff_runtime.app.wiring.site_to_law import site_params
from aff_runtime.config.loader import load_site
from aff_runtime.core.blocks.block import HarmonicBlock
from aff_runtime.core.laws.iterative import IterativeBlock
from sim_plant.base.order_tracking import order_amplitudes, reduction_dB
from tests.aff_runtime.core.plants import CYCLE_S, LagDelay
from tests.each_case import each_case
from tests.lockstep.bench import SITE, Bench, Setup
from tests.lockstep.fault_table import assert_never_above_limit
from tests.lockstep.known_response import known_responses
from tests.lockstep.silent import SKIPPED_S, silent_rows, watched

TURN_S = 1.0
TURN = round(TURN_S / CYCLE_S)
RIPPLE = 3.0 * cmath.exp(0.7j)
GAIN, DELAY = 50.0, 9
ASKED = 2.0 * TURN_S  # time of a pass


def played(block, turns, *, wrong=1.0, other=0j, after=0.0):
    """Return a block's weight at every sample of some turns, and the response it cancels over."""
    plant = LagDelay(GAIN, delay=DELAY)
    response = plant.at(block.order / TURN_S)
    rate = block.adaptation_rate(0.0)
    u, weights = 0.0, []
    for k in range(round(after * TURN), round((after + turns) * TURN)):
        theta = math.tau * k / TURN
        carrier = cmath.exp(1j * theta)
        y = plant.step(u) + (RIPPLE * carrier**block.order + other * carrier**3).real
        block.turn(theta)
        block.adapt(error=-y, response=response * wrong, scale=1.0, rate_1_s=rate, dt_s=CYCLE_S)
        weights.append(block.weight)
        u = block.output(1.0)
    return np.array(weights), response


def left(weights, response, passes):
    """Return the share of the ripple left once the move of each pass has been made."""
    ends = [round((2.0 * n + 1.0) * TURN) for n in range(passes + 1)]
    return [(RIPPLE + response * weights[end]) / RIPPLE for end in ends]


@each_case("settle_s", [8.0, 20.0])
@each_case("order", [1, 2])
def test_a_pass_leaves_what_settle_s_asks_for(settle_s, order):
    weights, response = played(IterativeBlock(order, settle_s, 1e9), 9.0)
    wanted = [math.exp(-4.0 * ASKED * n / settle_s) for n in range(4)]
    assert left(weights, response, 3) == pytest.approx(wanted, abs=0.01)


@each_case(("gain", "degrees"), [(1.0, 50.0), (1.0, -50.0), (0.6, 20.0), (2.0, 0.0)])
def test_with_a_wrong_response_a_pass_leaves_what_the_formula_says(gain, degrees):
    wrong = gain * cmath.exp(1j * math.radians(degrees))
    mu = 1.0 - math.exp(-4.0 * ASKED / 8.0)
    weights, response = played(IterativeBlock(1, 8.0, 1e9), 9.0, wrong=wrong)
    wanted = [(1.0 - mu / wrong) ** n for n in range(4)]
    assert abs(np.array(left(weights, response, 3)) - wanted).max() < 0.02


@pytest.mark.parametrize(("degrees", "converges"), [(60.0, True), (-60.0, True), (100.0, False)])
def test_it_converges_while_the_phase_of_the_response_is_right(degrees, converges):
    wrong = cmath.exp(1j * math.radians(degrees))
    weights, response = played(IterativeBlock(1, 20.0, 1e9), 31.5, wrong=wrong)
    shares = np.abs(left(weights, response, 15))
    assert (shares[-1] < 0.5 * shares[1]) if converges else (shares[-1] > shares[1])


def test_a_strong_order_beside_it_moves_its_weight_no_more():
    other, settle_s = 30.0, 8.0
    block = IterativeBlock(1, settle_s, 1e9)
    weights, response = played(block, 31.0, other=other)
    still = weights[-2 * TURN :]
    assert abs(RIPPLE + response * still).max() < 0.01 * other
    # the plain block: w' = (2 lam / |P|) e e^{-j psi}, e of order 3 has lines at 2 and -4 omega
    omega, lam = math.tau / TURN_S, 4.0 / settle_s
    swings = lam * other / abs(response) * (1.0 / (2.0 * omega) + 1.0 / (4.0 * omega))
    plain, _ = played(HarmonicBlock(1, settle_s, 1e9), 31.0, other=other)
    assert abs(plain[-TURN:] - plain[-TURN:].mean()).max() == pytest.approx(swings, rel=0.15)
    assert abs(still - still.mean()).max() < 0.02 * swings


def test_its_weight_stands_still_while_it_is_measured_and_moves_evenly_at_the_rate_it_tells():
    block = IterativeBlock(1, 8.0, 1e9)
    weights, response = played(block, 4.0)
    steps = np.abs(np.diff(weights))
    assert steps[: 2 * TURN - 2].max() == 0.0
    moving = steps[2 * TURN + 1 : round(2.5 * TURN) - 1]
    mu = 1.0 - math.exp(-4.0 * ASKED / 8.0)
    assert moving == pytest.approx(mu * abs(RIPPLE / response) / (0.5 * TURN), rel=0.02)
    assert steps[round(2.5 * TURN) + 1 : 4 * TURN - 2].max() == 0.0


def test_it_tells_the_rate_of_every_step_and_none_while_it_stands():
    block, before = IterativeBlock(1, 8.0, 1e9), 0j
    for k in range(5 * TURN):
        block.turn(math.tau * k / TURN)
        block.adapt(
            error=-math.cos(math.tau * k / TURN),
            response=50.0 + 0j,
            scale=1.0,
            rate_1_s=0.5,
            dt_s=CYCLE_S,
        )
        assert block.weight_speed * CYCLE_S == pytest.approx(abs(block.weight - before), abs=1e-12)
        before = block.weight


def test_a_change_from_elsewhere_or_a_gap_begins_the_measurement_anew():
    def moves(spoil, gap=0.0):
        block = IterativeBlock(1, 8.0, 1e9)
        played(block, 3.6)  # in its second pass, the move made
        spoil(block)
        then = block.weight
        weights, _ = played(block, 1.9, after=3.6 + gap)
        return abs(weights - then).max() > 0.0

    assert moves(lambda block: None)
    assert not moves(lambda block: block.scale_weights(0.5))
    assert not moves(lambda block: block.hold())
    assert not moves(lambda block: None, gap=0.25)


@pytest.mark.parametrize("response", [0j, complex(math.nan, 0.0), complex(math.inf, 0.0)])
def test_a_response_that_is_none_moves_nothing(response):
    block = IterativeBlock(1, 8.0, 1e9)
    weights, _ = played(block, 6.0, wrong=response)
    assert abs(weights).max() == 0.0


@pytest.mark.long  # quick, on a small line: test_catalogue.py
def test_on_the_line_its_orders_fall_by_30_dB_or_to_the_noise_within_the_limits():
    params = site_params(load_site(SITE))
    law = replace(params, actuators=tuple(replace(a, law="iterative") for a in params.actuators))
    bench = Bench(Setup(responses=known_responses(), soft_start_s=1.5, law=law))
    seen = watched(bench)
    bench.run(SKIPPED_S)
    bench.arm(35.0)
    seen.clear()
    bench.run(20.0)
    assert_never_above_limit(bench.applied)
    floor_N = 3.0 * 0.25 * (2.0 * 0.005 / 20.0) ** 0.5

    def ripple(rows):
        unwind_N, _, unwind_rad, follower_rad = np.array(rows).T
        return np.abs(order_amplitudes(unwind_N, unwind_rad, (1, 2), {"f": follower_rad}))

    for before_N, after_N in zip(ripple(silent_rows()), ripple(seen), strict=True):
        assert reduction_dB(before_N, after_N) >= 30.0 or after_N < floor_N
