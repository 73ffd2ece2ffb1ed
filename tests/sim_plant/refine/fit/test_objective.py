from dataclasses import replace

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.linearisation import changes_by_nuisances
from sim_plant.refine.fit.objective import conditioned_on, relinearised_at, with_free_shapes
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.model.nuisances import Nuisance
from sim_plant.refine.model.twin import Case
from tests.sim_plant.refine.small import formula_twin, line_with, objective_of, pool_of, white

SAMPLES = 2000
CHANNELS = ("unwind_tension_N", "rewind_tension_N")
NUISANCES = [
    Nuisance(name="web.EA_N", tolerance=500.0),
    Nuisance(name="web.width_m", tolerance=0.01),
]
WAVE = np.sin(0.05 * np.arange(SAMPLES))


def changes(formula):
    twin = formula_twin(formula, ["unwind_tension_N"], 5)
    return changes_by_nuisances(pool_of(twin), NUISANCES, Case(), (np.zeros((1, 5)),))


def test_a_tolerance_at_whose_end_the_line_does_not_run_is_refused_by_name():
    def formula(case):
        broken = dict(case.shifts).get("web.EA_N", 0.0) > 1.0
        return np.full((1, 5), np.nan if broken else 0.0)

    with pytest.raises(PlantError, match=r"tolerances: web\.EA_N may be 500 off.*a smaller one"):
        changes(formula)


def test_what_a_unit_changes_is_the_slope_over_the_tolerance():
    found = changes(lambda case: np.full((1, 5), 3.0 * sum(dict(case.shifts).values())))
    np.testing.assert_allclose(found, 3.0)


def two_channels(case):
    """A modulus moves the first channel, a filter the second, a ripple of the unwind both."""
    shift = dict(case.shifts).get("web.EA_N", 0.0)
    lag = sum(dict(e.parameters).get("lag_s", 0.0) for e in case.effects)
    ripple = sum(1e5 * (c + 2.0 * s) for _, _, c, s in case.ripples)
    gain = 1.0 + 10.0 * lag  # what is on the line changes what a number does
    return np.stack([gain * 100.0 * shift * WAVE + ripple * WAVE, 50.0 * lag * WAVE])


@pytest.fixture
def objective():
    return objective_of(formula_twin(two_channels, CHANNELS, SAMPLES), white((2, SAMPLES), 3))


def snapshot(objective):
    return (
        objective.linearisation,
        objective.whitening,
        objective.expected_cost,
        objective.projector.nuisances.copy(),
    )


def filtered(lag_s):
    h = hypothesis(BY_NAME["load_cell_filter"], "R9", fitted=("lag_s",))
    return Case(effects=(h.added([lag_s]),))


@pytest.mark.parametrize(
    "change",
    [
        lambda o: relinearised_at(o, filtered(0.02)),
        lambda o: with_free_shapes(o, [0]),
        lambda o: conditioned_on(o, [np.full((1500, 1), 1500**-0.5)]),
    ],
)
def test_an_objective_stays_as_it_is_when_another_is_made_of_it(objective, change):
    linearisation, whitening, expected, nuisances = snapshot(objective)
    other = change(objective)
    assert other.projector.nuisances.shape != nuisances.shape or not np.array_equal(
        other.projector.nuisances, nuisances
    )
    assert objective.linearisation is linearisation
    assert objective.whitening is whitening
    assert objective.expected_cost == expected
    assert np.array_equal(objective.projector.nuisances, nuisances)


def test_responses_to_declared_numbers_are_those_at_the_anchor(objective):
    case = filtered(0.02)
    near = relinearised_at(objective, case)
    kept = relinearised_at(objective, case, keep_nuisance_changes=True)
    before, after = objective.linearisation, near.linearisation
    np.testing.assert_allclose(after.nuisance_changes[0][0][0], 120.0 * WAVE, atol=1e-9)
    np.testing.assert_allclose(before.nuisance_changes[0][0][0], 100.0 * WAVE, atol=1e-9)
    assert kept.linearisation.nuisance_changes is before.nuisance_changes


def test_a_true_model_costs_what_is_expected_to_within_chance(objective):
    cost = objective.projector.cost(objective.residual(objective.pool.one(Case())))
    assert objective.rows == 2 * 1500
    assert cost == pytest.approx(objective.expected_cost, abs=4.0 * np.sqrt(2.0 * 3000))
    assert objective.cost_standard_deviation == pytest.approx(
        np.sqrt(2.0 * objective.expected_cost)
    )


def test_free_terms_take_their_wave_out_of_every_channel(objective):
    wave = WAVE[500:] / np.linalg.norm(WAVE[500:])
    beside = conditioned_on(objective, [wave[:, None]])
    loud = [100.0 * np.stack([WAVE, -WAVE])]
    left = beside.split(beside.whitening.vector(loud))[0]
    whole = objective.split(objective.whitening.vector(loud))[0]
    assert np.linalg.norm(left) < 0.1 * np.linalg.norm(whole)
    assert objective.expected_cost - beside.expected_cost == 2  # one term in two channels


def test_a_free_shape_explains_what_its_ripples_do(objective):
    loose = with_free_shapes(objective, [0, 0])
    orders = CRITERIA.fit.free_orders
    assert loose.linearisation.free_bodies == (0,)
    assert objective.expected_cost - loose.expected_cost == 2 * orders
    bump = objective.residual([np.stack([-100.0 * WAVE, 0.0 * WAVE])])
    assert loose.projector.cost(bump) < objective.projector.cost(bump) - 1000.0


def test_the_zero_of_an_angle_is_free():
    line = line_with()
    twin = formula_twin(lambda _: np.zeros((1, SAMPLES)), ["unwind_angle_rad"], SAMPLES, line=line)
    objective = objective_of(twin, white((1, SAMPLES)))
    shifted = objective.residual([np.full((1, SAMPLES), 7.0)])
    plain = objective.residual([np.zeros((1, SAMPLES))])
    assert objective.projector.cost(shifted) == pytest.approx(
        objective.projector.cost(plain), rel=1e-6
    )


def test_beyond_noise_a_channel_of_coarse_words_counts_above_its_doubt_only(objective):
    """Twice the expected power in both channels: half of it is doubt in the coarse one."""
    rows = objective.rows
    residual = np.full(rows + len(objective.nuisances), np.sqrt(2.0))
    residual[rows:] = 0.0
    cost = float(residual @ residual)
    plain = objective.excess(cost, residual)
    assert plain == pytest.approx(cost - objective.expected_cost)
    (noise,) = objective.whitening.noise
    coarse = replace(noise, filters=(np.ones(1), np.array([1.0, 0.0])))
    worded = replace(objective, whitening=replace(objective.whitening, noise=(coarse,)))
    by_steps = 0.5 * np.minimum(1.0, (noise.floor[0] / noise.sd[0]) ** 2) * (rows / 2)
    assert worded.excess(cost, residual) == pytest.approx(
        cost - worded.expected_cost - by_steps, rel=1e-9
    )


def remembering(case):
    """The first channel forgets what drives held at the start, with 600 samples."""
    held = sum(offset.tension_N for offset in case.start if offset.of == "drive")
    first = held * np.exp(-np.arange(SAMPLES) / 600.0)
    return two_channels(case) + np.stack([first, 0.0 * first])


@pytest.mark.parametrize("rested", [False, True])
def test_how_a_run_s_line_began_costs_nothing_and_moves_no_number(rested):
    twin = replace(formula_twin(remembering, CHANNELS, SAMPLES), rested=rested)
    noise = white((2, SAMPLES), 3)
    began = 20.0 * np.stack([np.exp(-np.arange(SAMPLES) / 600.0), np.zeros(SAMPLES)])
    plain, run = objective_of(twin, noise), objective_of(twin, noise + began)
    costs = [o.projector.cost(o.residual(o.pool.one(Case()))) for o in (plain, run)]
    if rested:
        assert costs[1] > costs[0] + 5000.0
    else:
        assert costs[1] == pytest.approx(costs[0], rel=0.02)
