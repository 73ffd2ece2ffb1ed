import numpy as np
import pytest

from sim_plant.refine.fit.gauss_newton import nominal_fit
from sim_plant.refine.search.events import event_candidates
from tests.sim_plant.refine.small import STEP_S, formula_twin, objective_of, white

CHANNELS = ("unwind_tension_N", "r3_tension_N")
SAMPLES = 6000
TIME_S = STEP_S * np.arange(SAMPLES)
PULL_N = 20.0
"""Tension that one newton metre of drag takes, at R5 twice as much as elsewhere."""


def drag_of(case):
    """Drag from a moment on pulls at one cell; nothing else does anything."""
    both = np.zeros((2, SAMPLES))
    for added in case.effects:
        if added.effect == "bearing_drag":
            given = dict(added.parameters)
            size = (2.0 if added.location == "R5" else 1.0) * PULL_N * given["constant_N_m"]
            both[1] -= size * (given.get("from_s", -1.0) <= TIME_S)
    return both


@pytest.mark.parametrize("moment_s", [21.3, 32.8, 47.1])
def test_drag_that_begins_and_stays_is_found_at_its_moment(moment_s):
    measured = white((2, SAMPLES), 4)
    measured[1] -= 2.0 * PULL_N * 0.05 * (moment_s <= TIME_S)
    objective = objective_of(formula_twin(drag_of, CHANNELS, SAMPLES), measured)
    said = []
    best = event_candidates(objective, nominal_fit(objective, {}), (), said.append)[0]
    found = dict(zip(best.hypothesis.names, best.start, strict=True))
    assert best.hypothesis.effect.name == "bearing_drag"
    assert found["from_s"] == pytest.approx(moment_s, abs=0.1)
    size = 2.0 if best.hypothesis.location == "R5" else 1.0
    assert size * found["constant_N_m"] == pytest.approx(0.1, rel=0.1)
    assert said
