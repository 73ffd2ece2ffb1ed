import numpy as np
import pytest

from sim_plant.refine.fit.projection import Projector


@pytest.fixture
def setting():
    rng = np.random.default_rng(5)
    nuisances = rng.standard_normal((400, 3))
    effect = rng.standard_normal((400, 2))
    residual = nuisances @ [1.0, -2.0, 0.5] + effect @ [0.4, -0.2] + rng.standard_normal(400)
    return nuisances, effect, residual


def test_gain_is_what_least_squares_saves(setting):
    nuisances, effect, residual = setting
    found = Projector(nuisances).linear_fit(residual, effect)
    both = np.column_stack([nuisances, effect])
    alone = np.linalg.lstsq(nuisances, residual, rcond=None)
    joint = np.linalg.lstsq(both, residual, rcond=None)
    assert found.chi2_reduction == pytest.approx(alone[1][0] - joint[1][0], rel=1e-6)
    np.testing.assert_allclose(found.values, joint[0][3:], rtol=1e-6)
    inverse = np.linalg.inv(both.T @ both)[3:, 3:]
    np.testing.assert_allclose(found.covariance, inverse, rtol=1e-6)


def test_what_tolerances_imitate_is_not_seen(setting):
    nuisances, _, residual = setting
    found = Projector(nuisances).linear_fit(residual, nuisances[:, :1] * 2.0)
    assert found.distinct_share < 1e-6


def test_a_tight_tolerance_lets_the_effect_be_claimed(setting):
    _, effect, _ = setting
    shape = effect[:, :1]
    for sd, share in ((1e-3, 0.99), (1e3, 0.01)):
        prior = np.vstack([shape, [[1.0 / sd]]])
        truth = np.append(5.0 * shape[:, 0], 0.0)
        chi2_reduction = (
            Projector(prior).linear_fit(truth, np.vstack([shape, [[0.0]]])).chi2_reduction
        )
        assert (chi2_reduction > share * (truth @ truth)) == (sd < 1.0)


def test_further_free_columns_are_projected_as_well(setting):
    nuisances, effect, residual = setting
    wide = Projector(nuisances).with_columns(effect)
    np.testing.assert_allclose(wide.project(residual) @ effect, 0.0, atol=1e-6)


def test_a_run_that_broke_down_costs_infinitely_much(setting):
    nuisances, _, residual = setting
    residual[3] = np.nan
    assert Projector(nuisances).cost(residual) == float("inf")
