"""How far a size moves where what is left is noise, and where the model is wrong in one part."""

import dataclasses
import math

import numpy as np
import pytest

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.robust_covariance import block_sums, robust_covariance
from tests.sim_plant.refine.small import STEP_S, formula_twin, objective_of, white

CHANNELS, SAMPLES = ("unwind_tension_N", "rewind_tension_N"), 6000
INTERVAL = round(CRITERIA.report.block_s / STEP_S)


def quiet_objective():
    still = np.zeros((2, SAMPLES))
    twin = formula_twin(lambda _case: still, CHANNELS, SAMPLES)
    return objective_of(twin, white((2, SAMPLES), 3))


def rows_of(objective, channels):
    """Return innovations (channels, judged samples) as a vector, nothing in tolerances' rows."""
    whole = np.zeros(objective.projector.nuisances.shape[0])
    whole[: objective.rows] = channels.ravel()
    return whole


def with_runs(objective, noise):
    """Return the objective with the noise of its seeded runs (runs, channels, samples)."""
    whitening = dataclasses.replace(objective.whitening, realisations=(noise,))
    return dataclasses.replace(objective, whitening=whitening)


def test_of_noise_as_it_is_weighed_it_is_the_covariance_of_noise_and_tolerances():
    objective = with_runs(quiet_objective(), 0.5 * white((12, 2, SAMPLES), 8))
    judged = objective.rows // 2
    fast = np.sin(0.7 * np.arange(judged))
    column = rows_of(objective, np.stack([fast, -fast]))[:, None]
    expected = objective.projector.linear_fit(column[:, 0], column).covariance[0, 0]
    found = [
        robust_covariance(objective, column, rows_of(objective, white((2, judged), seed)))
        for seed in range(20)
    ]
    assert found[0].noise[0, 0] + found[0].tolerances[0, 0] == pytest.approx(expected, rel=1e-6)
    # blocks are larger by chance in one record of twenty
    plain = [robust for robust in found if robust.degrees_of_freedom[0] == math.inf]
    assert len(plain) >= 17
    assert all(robust.variance[0] == pytest.approx(robust.noise[0, 0]) for robust in plain)


def test_what_pulls_one_way_in_one_part_and_back_in_another_widens_it():
    """Equation: of a column c and what is left, +- b c in two blocks, g = +- b |c|^2 there."""
    objective = quiet_objective()
    judged = objective.rows // 2
    fast = np.sin(0.7 * np.arange(judged))
    sign = np.zeros(judged)
    sign[INTERVAL : 2 * INTERVAL], sign[5 * INTERVAL : 6 * INTERVAL] = 1.0, -1.0
    column = rows_of(objective, np.stack([fast, -fast]))[:, None]
    left = rows_of(objective, 3.0 * np.stack([fast, -fast]) * sign)
    found = robust_covariance(objective, column, left)
    power = float(column[:, 0] @ column[:, 0])
    pulled = 3.0 * power * INTERVAL / judged
    assert found.variance[0] == pytest.approx(2.0 * pulled**2 / power**2, rel=0.05)
    assert found.degrees_of_freedom[0] == len(block_sums(objective, column)) - 1


def test_blocks_hold_all_rows_once():
    objective = quiet_objective()
    rows = np.ones((objective.projector.nuisances.shape[0], 1))
    sums = block_sums(objective, rows)[:, 0]
    assert sums.sum() == objective.rows
    assert sums[0] == 2 * INTERVAL


def moved_together(noise):
    """Return the real covariance of what moves two channels alike, and its column."""
    objective = with_runs(quiet_objective(), noise)
    fast = np.sin(0.7 * np.arange(objective.rows // 2))
    column = rows_of(objective, np.stack([fast, fast]))[:, None]
    return robust_covariance(objective, column, np.zeros(column.shape[0])), column[:, 0]


def test_noise_that_moves_two_channels_together_moves_a_number_by_more():
    """The variance of a sum is twice that of two that move on their own."""
    noise = white((12, 2, SAMPLES), 8)
    noise[:, 1] = noise[:, 0]
    found, _ = moved_together(noise)
    # of 12 runs a variance is known to sqrt(2 / 11) = 0.43
    assert 1.2 < found.variance[0] / found.noise[0, 0] < 3.5
    assert found.degrees_of_freedom[0] == 11.0


def test_what_all_seeded_runs_share_is_no_noise():
    """The steps of a word on a body that turns alike: one offset, and no spread about it."""
    shared = np.broadcast_to(white((1, 2, SAMPLES), 9), (12, 2, SAMPLES))
    own = 0.1 * white((12, 2, SAMPLES), 8)
    shape = np.sin(0.7 * (np.arange(SAMPLES) - 1500))
    found, _ = moved_together(shared + own + 3.0 * shape)
    assert found.variance[0] == pytest.approx(found.noise[0, 0])
    assert found.degrees_of_freedom[0] == math.inf
