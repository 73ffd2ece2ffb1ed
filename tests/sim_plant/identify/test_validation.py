"""Norms from their definitions; the distortion test finds drifts and rejects wrong models."""

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.identify.validation import model_distortion, norms

TIME = 0.01 * np.arange(1000)
NOISE = 0.01


def model(drift: Array) -> Array:
    # gain on a ramp, piecewise constant drift
    gain = np.repeat(2.0 * (1.0 + drift[:, 0]), TIME.size // drift.shape[0])
    return gain * (1.0 + TIME)


def record(drift: Array, seed: int = 0) -> Array:
    return model(drift) + NOISE * np.random.default_rng(seed).standard_normal(TIME.size)


def test_norms_of_a_known_error() -> None:
    error = np.array([0.0, -3.0, 1.0, 0.0])
    found = norms(error, np.zeros(4), 0.5)
    assert (found.l1, found.l2, found.linf) == (2.0, 5.0, 3.0)


def test_norms_refuse_records_of_unlike_length() -> None:
    with pytest.raises(PlantError, match="do not compare"):
        norms(np.zeros(3), np.zeros(4), 0.1)


def test_a_true_model_needs_no_drift_beyond_its_noise() -> None:
    found = model_distortion(
        record(np.zeros((4, 1))), model, np.array([0.05]), segments=4, noise_sd=NOISE
    )
    assert found.accepted
    assert found.rms_drift[0] < 1e-3


def test_a_known_drift_is_found() -> None:
    truth = np.array([[0.0], [0.03], [-0.02], [0.0]])
    found = model_distortion(record(truth), model, np.array([0.05]), segments=4, noise_sd=NOISE)
    np.testing.assert_allclose(found.drift, truth, atol=2e-3)
    assert found.accepted


def test_a_drift_beyond_tolerance_fails_the_model() -> None:
    found = model_distortion(
        record(np.full((4, 1), 0.2)), model, np.array([0.05]), segments=4, noise_sd=NOISE
    )
    assert found.explained
    assert not found.accepted


def test_what_no_drift_explains_is_said() -> None:
    wave = record(np.zeros((4, 1))) + 0.5 * np.sin(40.0 * TIME)
    found = model_distortion(wave, model, np.array([0.05]), segments=4, noise_sd=NOISE)
    assert not found.explained
    assert found.misfit > 10.0


def test_the_drift_found_is_the_smallest_that_explains() -> None:
    truth = np.array([[0.03], [0.03]])
    measured = record(truth)
    found = model_distortion(measured, model, np.array([0.05]), segments=2, noise_sd=NOISE)
    shrunk = model(0.9 * found.drift)
    assert np.sqrt(np.mean((measured - shrunk) ** 2)) > NOISE
