from dataclasses import replace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.completeness import explains_own_spectral_lines, leaves_much
from tests.sim_plant.refine.small import (
    axes_at,
    fit_of,
    formula_twin,
    objective_of,
    one_peak,
    white,
)

DELAY = hypothesis(BY_NAME["loop_delay"], "unwind")
CHANNELS = [f"{name}_tension_N" for name in ("unwind", "pullroll", "r3", "rewind")]
SAMPLES = 22_000
OBJECTIVE = objective_of(
    formula_twin(lambda _: np.zeros((4, SAMPLES)), CHANNELS, SAMPLES), white((4, SAMPLES))
)
NOISE = OBJECTIVE.expected_cost
"""About 80 000: four channels of 20 000 judged rows."""


def claimed(before, after, line=0.0):
    base, fit = (
        replace(f, residual=np.full(4 * 20_000 + 1, np.sqrt(f.cost / (4 * 20_000))))
        for f in (fit_of(cost=before), fit_of(DELAY, cost=after))
    )
    return explains_own_spectral_lines(OBJECTIVE, base, one_peak(line), [axes_at(np.ones(9))], fit)


@pytest.mark.parametrize("share", [0.05, 0.2])
def test_an_effect_that_explains_little_of_much_is_an_imitation(share):
    assert not claimed(NOISE + 20_000.0, NOISE + (1.0 - share) * 20_000.0)


@pytest.mark.parametrize("share", [0.4, 1.0])
def test_the_largest_of_some_true_effects_is_taken(share):
    assert claimed(NOISE + 20_000.0, NOISE + (1.0 - share) * 20_000.0)


def test_a_small_effect_in_a_record_that_is_else_at_its_floor_is_taken():
    assert claimed(NOISE + 500.0, NOISE + 400.0)


def test_an_effect_that_is_no_line_does_not_stand_beside_a_strong_line():
    assert not claimed(NOISE + 20_000.0, NOISE + 12_000.0, line=15_000.0)


@pytest.mark.parametrize(("left", "much"), [(0.04, True), (0.005, False)])
def test_two_of_one_effect_that_leave_a_share_of_their_line_imitate_it(left, much):
    """Four numbers at one line answer most of any; true ones leave what the model has wrong."""
    explained = 100_000.0
    residual = np.full(4 * 20_000 + 1, np.sqrt((NOISE + left * explained) / (4 * 20_000)))
    fit = replace(fit_of(cost=NOISE + left * explained), residual=residual)
    base = fit_of(cost=NOISE + (1.0 + left) * explained)
    assert leaves_much(OBJECTIVE, base, fit) is much
