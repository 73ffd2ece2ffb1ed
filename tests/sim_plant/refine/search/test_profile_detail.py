from dataclasses import replace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.fit.gauss_newton import gauss_newton_fit
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.model.twin import Case
from sim_plant.refine.search.profile_detail import improves_cross_validation, with_later_numbers
from tests.sim_plant.refine.small import formula_twin, objective_of, white

ROWS = 400
TIME = np.linspace(0.0, 1.0, ROWS)
SIZE, GROWTH = np.sin(40.0 * TIME), TIME * np.sin(40.0 * TIME)
HALVES = (np.arange(ROWS) < ROWS // 2, np.arange(ROWS) >= ROWS // 2)


def noise():
    return np.random.default_rng(3).standard_normal(ROWS)


def improves(detail, residual):
    """Return whether a detail predicts across halves beside the size of a profile."""
    return improves_cross_validation(np.stack([SIZE, detail], axis=1), residual, [0], HALVES)


def test_a_detail_that_either_half_foretells_is_kept():
    assert improves(GROWTH, noise() + 2.0 * SIZE - 4.0 * GROWTH)


def test_a_detail_that_fits_one_half_only_is_not():
    fluke = np.where(TIME < 0.5, 1.0, -1.0) * np.sin(70.0 * TIME)
    residual = noise() + 2.0 * np.abs(TIME < 0.5) * fluke - 1.0 * (TIME >= 0.5) * fluke * 0.5
    residual = np.where(TIME < 0.5, residual, noise() - 2.0 * fluke)
    assert not improves(fluke, residual)


MASS_KG, UNBALANCE_KG_M = 30.0, 0.04
BOUNCE = hypothesis(
    BY_NAME["roll_bounce"], "unwind", (("mass_kg", 20.0), ("order", 2.0)), ("cosn_kg_m",)
)
BOUNCE_S = np.linspace(0.0, 60.0, 6000)
"""A record of 60 s; the steps of tension come every 6 s."""


def bouncing(steps):
    """Return two channels that a roll moves: unbalance over mass, and steps of pull over mass."""

    def formula(case):
        found = np.zeros((2, BOUNCE_S.size))
        for effect in case.effects:
            put = dict(effect.parameters)
            found[0] += 3e4 * put["cosn_kg_m"] / put["mass_kg"] * np.sin(20.0 * BOUNCE_S)
            found[1] += 300.0 * steps / put["mass_kg"] * np.sign(np.sin(np.pi * BOUNCE_S / 3.0))
        return found

    return formula


@pytest.mark.parametrize(("steps", "told"), [(1.0, True), (0.0, False)])
def test_a_number_that_the_library_sets_is_fitted_where_the_record_tells_it(steps, told):
    formula = bouncing(steps)
    line = formula_twin(formula, ("unwind_tension_N", "rewind_tension_N"), BOUNCE_S.size)
    put = {"cosn_kg_m": UNBALANCE_KG_M, "mass_kg": MASS_KG}
    there = Case(effects=(replace(BOUNCE.added(BOUNCE.start), parameters=tuple(put.items())),))
    objective = objective_of(line, formula(there) + white((2, BOUNCE_S.size), 4))
    first = gauss_newton_fit(objective, (BOUNCE,), (BOUNCE.start,), {})
    assert first.values[0][0] / 20.0 == pytest.approx(UNBALANCE_KG_M / MASS_KG, rel=0.01)
    fit = with_later_numbers(objective, first)
    if not told:
        assert fit is first
        return
    found = dict(zip(fit.hypotheses[0].names, fit.values[0], strict=True))
    assert found["mass_kg"] == pytest.approx(MASS_KG, rel=0.02)
    assert found["cosn_kg_m"] == pytest.approx(UNBALANCE_KG_M, rel=0.02)
    assert "mass_kg" not in dict(fit.hypotheses[0].fixed)
