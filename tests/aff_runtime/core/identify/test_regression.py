"""The noise of a factor against the covariance of least squares, over white noise."""

import math

import numpy as np
import pytest

from aff_runtime.core.identify.regression import SIDES, Regression

TIME_S = np.arange(800) * 0.01
SD = np.array([0.5, 2.0])


def columns(tones_Hz):
    turns = [math.tau * f * TIME_S for f in tones_Hz]
    return np.column_stack([part for t in turns for part in (np.cos(t), -np.sin(t))])


def signals(seed):
    return SD * np.random.default_rng(seed).standard_normal((TIME_S.size, 2))


@pytest.mark.parametrize("apart", [6.0, 2.0, 1.2])
def test_noise_is_that_of_least_squares_however_close_the_columns_stand(apart):
    """E|n|^2 of cos and sin together: sd^2 trace of their part of (X^T X)^-1."""
    tones_Hz = 1.0 + apart / 8.0 * np.arange(20)
    design = columns(tones_Hz)
    regression = Regression(TIME_S, design)
    at = 18
    share = np.linalg.inv(design.T @ design)[at : at + 2, at : at + 2].trace()
    found = []
    for seed in range(40):
        _, residual = regression.solve(signals(seed))
        noise, places = regression.noise(residual, math.tau * tones_Hz[at // 2], at)
        assert places == SIDES
        found.append(np.diag(noise).real)
    assert np.mean(found, axis=0) == pytest.approx(SD**2 * share, rel=0.15)


def test_factors_are_those_of_least_squares_and_what_is_left_is_orthogonal():
    design = columns([1.0, 2.3, 4.0])
    solution, residual = Regression(TIME_S, design).solve(signals(1))
    assert solution == pytest.approx(np.linalg.lstsq(design, signals(1), rcond=None)[0])
    assert np.abs(design.T @ residual).max() < 1e-9


def test_where_no_place_is_clear_some_noise_is_told_all_the_same():
    """As many columns as the record has turns: nothing beside the tone is left."""
    regression = Regression(TIME_S, columns(np.arange(1, 399) / 8.0))
    _, residual = regression.solve(signals(1))
    noise, places = regression.noise(residual, math.tau * 20.0, 318)
    assert places < SIDES
    assert noise[0, 0].real > 0.0
