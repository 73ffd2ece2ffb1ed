"""What a record says of a declared number by itself, whatever tolerance it was given."""

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.fit.gauss_newton import gauss_newton_fit
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.outside_prior import told_by_record
from tests.sim_plant.refine.small import fit_of, formula_twin, line_with, objective_of, white

SAMPLES, JUDGED = 6000, 4500
MODULUS = hypothesis(BY_NAME["web_modulus"], "web")
RIPPLE = hypothesis(BY_NAME["torque_ripple"], "unwind")
WAVE = np.sign(np.sin(2.0 * np.pi * np.arange(SAMPLES) / 300.0))
NEWTON = 40.0
"""Of tension per relative change of the modulus: 10 % is 4 standard deviations of noise."""


def response(case):
    """Return one tension: what the modulus does, as an effect or as a shifted number."""
    change = sum(shift for name, shift in case.shifts if name == "web.EA_N")
    change += sum(
        dict(e.parameters)["factor"] - 1.0 for e in case.effects if e.effect == "web_modulus"
    )
    return NEWTON * change * WAVE[None, :]


@pytest.mark.parametrize("tolerance", [0.002, 0.02])
def test_the_record_says_as_much_whatever_the_tolerance(tolerance):
    line = line_with({"*": 0.0, "web.EA_N": tolerance})
    twin = formula_twin(response, ["unwind_tension_N"], SAMPLES, line=line)
    objective = objective_of(twin, NEWTON * 0.1 * WAVE[None, :] + white((1, SAMPLES)))
    fit = gauss_newton_fit(objective, (MODULUS,), (MODULUS.start,), {})
    assert fit.values[0][0] == pytest.approx(1.1, abs=0.002)
    whole = objective.whitened([NEWTON * 0.1 * WAVE[None, :]])  # no other number answers alike
    assert told_by_record(objective, fit) == pytest.approx(float(whole @ whole), rel=0.05)
    assert whole @ whole > 0.5 * JUDGED * (NEWTON * 0.1) ** 2  # noise takes up some of the wave


def test_of_an_effect_that_is_no_declared_number_nothing_is_told():
    twin = formula_twin(response, ["unwind_tension_N"], SAMPLES)
    objective = objective_of(twin, white((1, SAMPLES)))
    assert told_by_record(objective, fit_of(RIPPLE)) == 0.0
