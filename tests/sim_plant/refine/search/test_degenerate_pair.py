"""When the same effect at two other places says as much as one place."""

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.degenerate_pair import better_pair
from sim_plant.refine.search.screening import linear_candidate, sensitivities
from tests.sim_plant.refine.small import (
    axes_at,
    fit_of,
    formula_twin,
    line_with,
    objective_of,
    white,
)

RADII_M = {"R1": 0.04, "R2": 0.04, "R3": 0.04, "R4": 0.05}
SAMPLES, JUDGED = 4000, 3000
LINE = line_with(
    rollers=tuple(
        r.model_copy(update={"radius_m": RADII_M.get(r.name, r.radius_m)})
        for r in line_with().rollers
    )
)
UNIT = hypothesis(BY_NAME["unbalanced_roller"], "R1").start[0]
WAVES = np.linalg.qr(np.random.default_rng(5).standard_normal((SAMPLES, 4)))[0].T / UNIT
ANSWERS = {  # R2 answers nearly as the mean of R1 and R3, R4 as R1
    "R1": WAVES[:2],
    "R3": WAVES[2:],
    "R2": 0.5 * (WAVES[:2] + WAVES[2:]),
    "R4": WAVES[:2],
}
UNBALANCED = {place: hypothesis(BY_NAME["unbalanced_roller"], place) for place in RADII_M}


def response(case):
    """Return one tension (1, samples): every unbalance by its two components, in proportion."""
    found = np.zeros(SAMPLES)
    for effect in case.effects:
        values = dict(effect.parameters)
        pair = [values[name] for name in UNBALANCED["R1"].names]
        found += np.array(pair) @ ANSWERS[effect.location]
    return found[None, :]


def record(seed=1, **sizes):
    """Return a record of these unbalances, in typical sizes."""
    found = white(SAMPLES, seed)
    for place, pair in sizes.items():
        found += UNIT * np.array(pair) @ ANSWERS[place]
    return found[None, :]


def instead(measured, chosen="R2", places=("R1", "R2", "R3", "R4")):
    twin = formula_twin(response, ["unwind_tension_N"], SAMPLES, line=LINE)
    objective = objective_of(twin, measured)
    fit = fit_of()
    hypotheses = [UNBALANCED[place] for place in places]
    residual = objective.residual(objective.pool.one(fit.case))
    columns = sensitivities(objective, fit, hypotheses)
    found = [
        linear_candidate(objective, h, objective.projector.inner(residual, c))
        for h, c in zip(hypotheses, columns, strict=True)
    ]
    found.sort(key=lambda c: -c.score)
    axes = axes_at(np.ones(SAMPLES), LINE)
    return better_pair(objective, fit, axes, UNBALANCED[chosen], found)


def test_two_of_one_radius_that_explain_more_are_named():
    found = instead(record(R1=(25.0, 3.0), R3=(15.0, 9.0)))
    assert set(found) == {EffectAt("unbalanced_roller", "R1"), EffectAt("unbalanced_roller", "R3")}


@pytest.mark.parametrize("seed", range(10))
def test_two_that_imitate_one_do_not_pay_for_their_numbers(seed):
    assert instead(record(seed, R2=(40.0, 12.0))) == ()


def test_a_roller_of_another_radius_is_no_alternative():
    assert instead(record(R1=(25.0, 3.0), R3=(15.0, 9.0)), places=("R2", "R3", "R4")) == ()


def test_an_effect_that_came_by_another_way_has_no_alternative():
    assert instead(record(R1=(25.0, 3.0), R3=(15.0, 9.0)), places=("R1", "R3")) == ()
