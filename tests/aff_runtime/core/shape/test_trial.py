"""Whether a shape from elsewhere is that of the roll: known answers from made-up ripple."""

from __future__ import annotations

import math

import numpy as np
import pytest

from aff_runtime.core.shape.trial import ShapeTrial
from tests.aff_runtime.core.plants import CYCLE_S

ORDERS = (1, 2, 3, 4)
OMEGA = 5.0
TURN_S = math.tau / OMEGA
P_N_PER_M = np.array([800.0, 600.0, 500.0, 300.0]) * np.exp(1j * np.array([0.3, -1.0, 2.0, 0.5]))
SHAPE_M = 1e-3 * np.array([0.9, 0.8, 0.6, 0.5]) * np.exp(1j * np.array([0.1, 1.2, -2.0, 0.7]))


def listened(true_m, *, noise_N=0.25, roll_of=("unwind",) * 4, order=ORDERS):
    """Return a trial that has heard the ripple of a roll of shape ``true_m``, output closed."""
    trial = ShapeTrial(roll_of, order, 0.6)
    rng = np.random.default_rng(1)
    number = np.array(order)
    theta = 0.0
    while not trial.done:
        phi = P_N_PER_M[: number.size] * np.exp(1j * number * theta)
        # what a correction of W would add, with the other sign: it is what W cancels
        error = -float((true_m * phi).real.sum()) + 3.0 + noise_N * rng.standard_normal()
        trial.step(error, phi, np.full(number.size, TURN_S), CYCLE_S)
        theta += OMEGA * CYCLE_S
    return trial


NOTHING = np.zeros(4, dtype=complex)


def test_the_rolls_own_shape_fits_as_it_is():
    fit = listened(SHAPE_M).fit("unwind", SHAPE_M, NOTHING)
    assert fit.fits
    assert fit.turned_rad == 0.0
    assert fit.agreement > 0.98
    assert fit.ratio == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("angle", [-2.5, -0.5, 0.7, 3.0])
def test_an_encoder_origin_that_moved_is_found(angle):
    n = np.array(ORDERS)
    moved = SHAPE_M * np.exp(1j * n * angle)  # what is saved, seen from the new origin
    fit = listened(SHAPE_M).fit("unwind", moved, NOTHING)
    assert fit.fits
    found = moved * np.exp(-1j * n * fit.turned_rad)
    assert np.abs(found - SHAPE_M).max() < 0.05 * np.abs(SHAPE_M).max()


def test_another_roll_does_not_fit():
    other = SHAPE_M * np.exp(1j * np.array([0.0, 2.5, -1.5, 3.0]))
    fit = listened(SHAPE_M).fit("unwind", other, NOTHING)
    assert not fit.fits
    assert fit.agreement < 0.9


@pytest.mark.parametrize("factor", [0.2, 5.0])
def test_a_roll_of_the_same_form_but_another_size_does_not_fit(factor):
    fit = listened(SHAPE_M).fit("unwind", factor * SHAPE_M, NOTHING)
    assert not fit.fits


def test_one_order_alone_is_never_turned():
    trial = listened(SHAPE_M[:1], roll_of=("swrap",), order=(1,))
    fit = trial.fit("swrap", SHAPE_M[:1] * np.exp(2j), NOTHING[:1])
    assert not fit.fits
    assert fit.turned_rad == 0.0


def test_a_learned_correction_of_the_loop_counts():
    wrong_loop = listened(0.5 * SHAPE_M)  # the true loop has half the gain that P says
    fit = wrong_loop.fit("unwind", SHAPE_M, np.full(4, -0.5 + 0j))
    assert fit.fits
    assert fit.ratio == pytest.approx(1.0, abs=0.1)


def test_a_round_roll_and_a_round_shape_fit_and_say_that_nothing_was_tried():
    fit = listened(NOTHING).fit("unwind", NOTHING, NOTHING)
    assert fit.fits
    assert math.isnan(fit.agreement)


def test_a_round_roll_refuses_a_shape():
    assert not listened(NOTHING).fit("unwind", SHAPE_M, NOTHING).fits
