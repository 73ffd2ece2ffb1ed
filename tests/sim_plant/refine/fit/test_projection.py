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


def test_a_precision_counts_as_a_row_that_says_how_large_a_nuisance_may_be(setting):
    nuisances, effect, residual = setting
    sd = np.array([0.3, 2.0])
    known = Projector(nuisances, np.array([*sd**-2.0, 0.0]))
    prior = np.zeros((2, 3))
    prior[:, :2] = np.diag(1.0 / sd)
    rows = Projector(np.vstack([nuisances, prior]))
    longer, below = np.append(residual, [0.0, 0.0]), np.vstack([effect, np.zeros((2, 2))])
    assert known.cost(residual) == pytest.approx(rows.cost(longer), rel=1e-8)
    np.testing.assert_allclose(known.estimate(residual), rows.estimate(longer), rtol=1e-6)
    found, asked = known.linear_fit(residual, effect), rows.linear_fit(longer, below)
    np.testing.assert_allclose(found.values, asked.values, rtol=1e-6)
    np.testing.assert_allclose(found.covariance, asked.covariance, rtol=1e-6)


def test_sizes_of_nuisances_are_those_of_their_first_rows(setting):
    nuisances, _, _ = setting
    projector = Projector(nuisances)
    for rows in (len(nuisances) - 1, 7):
        expected = np.linalg.norm(nuisances[:rows], axis=0)
        assert projector.sizes(rows) == pytest.approx(expected, rel=1e-12)


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


def test_numbers_and_nuisances_are_estimated_together_as_by_least_squares(setting):
    nuisances, effect, residual = setting
    found = Projector(nuisances).joint_estimate(residual, effect)
    both = np.linalg.lstsq(np.column_stack([nuisances, effect]), residual, rcond=None)[0]
    np.testing.assert_allclose(found, both, rtol=1e-6)


def test_the_least_cost_is_what_least_squares_leaves(setting):
    nuisances, _, residual = setting
    left = np.linalg.lstsq(nuisances, residual, rcond=None)[1][0]
    projector = Projector(nuisances)
    assert projector.cost(residual) == pytest.approx(left, rel=1e-9)
    assert residual @ projector.project(residual) == pytest.approx(left, rel=1e-9)


def test_groups_of_columns_are_weighed_as_each_alone(setting):
    nuisances, effect, residual = setting
    rng = np.random.default_rng(6)
    groups = [effect, effect[:, :1], *rng.standard_normal((70, 400, 1))]
    projector = Projector(nuisances)
    for columns, inner in zip(groups, projector.inners(residual, groups), strict=True):
        cut = projector.project(columns)
        np.testing.assert_allclose(inner.gram, columns.T @ cut, rtol=1e-9)
        np.testing.assert_allclose(inner.against, cut.T @ residual, rtol=1e-9)
        alone = projector.linear_fit(residual, columns)
        assert inner.fit().chi2_reduction == pytest.approx(alone.chi2_reduction, rel=1e-9)


def test_single_columns_explain_what_a_fit_of_each_explains(setting):
    nuisances, effect, residual = setting
    projector = Projector(nuisances)
    columns = np.column_stack([effect, nuisances[:, 0], np.full(400, np.nan)])
    found = projector.explained(residual, columns)
    for k in range(2):
        alone = projector.linear_fit(residual, effect[:, k : k + 1]).chi2_reduction
        assert found[k] == pytest.approx(alone, rel=1e-9)
    assert found[2] == 0.0
    assert found[3] == 0.0


def test_a_nuisance_that_is_held_explains_nothing(setting):
    nuisances, _, residual = setting
    left = np.linalg.lstsq(nuisances[:, 1:], residual, rcond=None)[1][0]
    assert Projector(nuisances).cost_with_fixed(residual, [0]) == pytest.approx(left, rel=1e-6)


def test_a_run_that_broke_down_costs_infinitely_much(setting):
    nuisances, _, residual = setting
    residual[3] = np.nan
    assert Projector(nuisances).cost(residual) == float("inf")


def test_sizes_move_with_a_nuisance_that_is_held_elsewhere_as_by_least_squares(setting):
    nuisances, effect, residual = setting
    free = np.linalg.lstsq(np.column_stack([nuisances, effect]), residual, rcond=None)[0]
    rest = residual - nuisances[:, [1]] @ (free[[1]] + 0.7)
    held = np.linalg.lstsq(np.column_stack([nuisances[:, [0, 2]], effect]), rest, rcond=None)[0]
    moved = Projector(nuisances).moved_by_held(effect, [1], np.array([0.7]))
    np.testing.assert_allclose(moved, held[2:] - free[3:], rtol=1e-6)


def test_no_size_moves_where_no_nuisance_is_held(setting):
    nuisances, effect, _ = setting
    assert not Projector(nuisances).moved_by_held(effect, [], np.zeros(0)).any()
