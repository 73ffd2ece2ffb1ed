"""How far a size moves where what is left is noise, and where the model is wrong in one part."""

import dataclasses

import numpy as np
import pytest

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.real_covariance import block_covariance, blocks, realised_covariance
from tests.sim_plant.refine.small import STEP_S, formula_twin, objective_of, white

CHANNELS, SAMPLES = ("unwind_tension_N", "rewind_tension_N"), 6000
BLOCK = round(CRITERIA.report.block_s / STEP_S)


def quiet_objective():
    still = np.zeros((2, SAMPLES))
    twin = formula_twin(lambda _case: still, CHANNELS, SAMPLES)
    return objective_of(twin, white((2, SAMPLES), 3))


def rows_of(objective, channels):
    """Return innovations (channels, judged samples) as a vector, nothing in tolerances' rows."""
    whole = np.zeros(objective.projector.nuisances.shape[0])
    whole[: objective.rows] = channels.ravel()
    return whole


def test_of_noise_it_is_the_covariance_of_noise():
    objective = quiet_objective()
    judged = objective.rows // 2
    fast = np.sin(0.7 * np.arange(judged))
    column = rows_of(objective, np.stack([fast, -fast]))[:, None]
    expected = objective.projector.linear_fit(column[:, 0], column).covariance[0, 0]
    found = [
        block_covariance(objective, column, rows_of(objective, white((2, judged), seed)))[0, 0]
        for seed in range(20)
    ]
    # 22 blocks each: the mean of 20 is known to sqrt(2 / 440) = 7 %
    assert np.mean(found) == pytest.approx(expected, rel=0.2)


def test_what_pulls_one_way_in_one_part_and_back_in_another_widens_it():
    """Equation: of a column c and what is left, +- b c in two blocks, g = +- b |c|^2 there."""
    objective = quiet_objective()
    judged = objective.rows // 2
    fast = np.sin(0.7 * np.arange(judged))
    sign = np.zeros(judged)
    sign[BLOCK : 2 * BLOCK], sign[5 * BLOCK : 6 * BLOCK] = 1.0, -1.0
    column = rows_of(objective, np.stack([fast, -fast]))[:, None]
    left = rows_of(objective, 3.0 * np.stack([fast, -fast]) * sign)
    found = block_covariance(objective, column, left)[0, 0]
    power = float(column[:, 0] @ column[:, 0])
    pulled = 3.0 * power * BLOCK / judged
    assert found == pytest.approx(2.0 * pulled**2 / power**2, rel=0.05)


def test_blocks_hold_all_rows_once():
    objective = quiet_objective()
    rows = np.ones((objective.projector.nuisances.shape[0], 1))
    sums = blocks(objective, rows)[:, 0]
    assert sums.sum() == objective.rows
    assert sums[0] == 2 * BLOCK


def test_noise_that_moves_two_channels_together_moves_a_number_by_more():
    """The variance of a sum is twice that of two that move on their own."""
    judged = SAMPLES - 1500
    fast = np.sin(0.7 * np.arange(judged))
    found, plain = [], []
    for shared in (False, True):
        objective = quiet_objective()
        column = rows_of(objective, np.stack([fast, fast]))[:, None]
        noise = white((12, 2, SAMPLES), 8)
        noise[:, 1] = noise[:, 0] if shared else noise[:, 1]
        whitening = dataclasses.replace(objective.whitening, realisations=(noise,))
        objective = dataclasses.replace(objective, whitening=whitening)
        found.append(realised_covariance(objective, column)[0, 0])
        plain.append(objective.projector.linear_fit(column[:, 0], column).covariance[0, 0])
    # of 12 runs a variance is known to sqrt(2 / 12) = 0.4
    assert found[0] == pytest.approx(plain[0], rel=1.0)
    assert 1.2 < found[1] / found[0] < 3.5
