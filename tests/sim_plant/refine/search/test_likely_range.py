"""The ends of an interval where the cost does not grow with the square of the distance."""

import math

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.fit.gauss_newton import gauss_newton_fit, jacobian
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.model.twin import Case
from sim_plant.refine.search.likely_range import end_of, likely_range
from tests.sim_plant.refine.small import LINE, formula_twin, objective_of, white

CHANNELS, SAMPLES = ("unwind_tension_N", "rewind_tension_N"), 6000
SPEED = np.linspace(0.5, 1.5, SAMPLES)


def counted(rise):
    looks = []

    def counting(far):
        looks.append(far)
        return rise(far)

    return counting, looks


def test_where_the_cost_grows_as_expected_one_look_is_enough():
    rise, looks = counted(lambda far: (far / 2.0) ** 2 * 4.0)
    assert end_of(rise, 2.0, furthest=100.0, limit=4.0) == pytest.approx(2.0)
    assert len(looks) == 1


@pytest.mark.parametrize("slack", [0.5, 3.0, 11.0])
def test_a_number_that_does_not_show_at_first_reaches_as_far_as_it_does_not(slack):
    rise, _ = counted(lambda far: max(0.0, far - slack) ** 2 * 4.0)
    assert end_of(rise, 1.0, furthest=100.0, limit=4.0) == pytest.approx(slack + 1.0, rel=0.2)


def test_an_end_nearer_than_expected_is_found():
    assert end_of(lambda far: (far / 0.1) ** 2, 2.0, furthest=9.0, limit=4.0) == pytest.approx(
        0.2, rel=0.2
    )


def test_what_never_shows_ends_at_its_bound():
    assert end_of(lambda _far: 0.0, 1.0, furthest=7.0, limit=4.0) == 7.0
    assert end_of(lambda _far: 0.0, 1.0, furthest=0.0, limit=4.0) == 0.0


def test_a_line_that_does_not_run_there_is_no_place_for_a_number():
    rise, _ = counted(lambda far: math.inf if far > 1.0 else far)
    assert 0.7 < end_of(rise, 3.0, furthest=9.0, limit=4.0) <= 1.0


def slipping(case):
    """Return two tensions that fall with the speed above a threshold."""
    found = np.zeros((2, SAMPLES))
    for effect in case.effects:
        size = dict(effect.parameters)
        beyond = np.maximum(0.0, SPEED - size["threshold_m_s"])
        found += np.outer([1e4, -5e3], size["slope_s_m"] * beyond)
    return found


def test_beside_a_number_that_is_held_all_others_are_fitted_again():
    """A response a (v - t) above t, a free: as in a linear fit, the rise is that of t with a."""
    h = hypothesis(BY_NAME["slip"], "swrap", (), ("slope_s_m", "threshold_m_s"), LINE)
    with_it = slipping(Case(effects=(h.added((0.002, 0.9)),)))
    objective = objective_of(
        formula_twin(slipping, CHANNELS, SAMPLES), with_it + white((2, SAMPLES), 4)
    )
    fit = gauss_newton_fit(objective, [h], [(0.0019, 0.85)], {})
    columns = jacobian(objective, [h], fit.values, fit.shifts)
    sd = np.sqrt(np.diag(objective.projector.linear_fit(fit.residual, columns).covariance))
    found = likely_range(objective, fit, columns, 1, width=2.0 * sd[1], rise=4.0)
    value = fit.values[0][1]
    assert found.high - value == pytest.approx(2.0 * sd[1], rel=0.25)
    assert value - found.low == pytest.approx(2.0 * sd[1], rel=0.25)
    assert found.low < 0.9 < found.high
    # a higher threshold goes with a steeper slope
    assert found.highest[0] > fit.values[0][0] > found.lowest[0]
