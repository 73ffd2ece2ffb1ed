"""An event where an effect that was found begins to act has to be more than that one's error."""

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import gauss_newton_fit
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import hypothesis, onset_hypotheses
from sim_plant.refine.search.candidate import fitted_candidate
from sim_plant.refine.search.own_moments import (
    begun_power,
    more_than_model_errors,
    response_powers,
)
from tests.sim_plant.refine.small import LINE, STEP_S, formula_twin, objective_of, white

CHANNELS = ("unwind_tension_N", "r3_tension_N")
SAMPLES, SEED = 4800, 7
TIME_S = STEP_S * np.arange(SAMPLES)
ACTS_S = 30.0
FILTER = hypothesis(BY_NAME["load_cell_filter"], "all")
STRONG = 30.0  # height of what the filter does, in noise
LATER_SCORE = CRITERIA.search.acceptance.later_score  # what any later effect needs, at most


def decaying(begins_s):
    later_s = TIME_S - begins_s
    return np.where(later_s >= 0.0, np.exp(-np.maximum(later_s, 0.0)), 0.0)


def response(case):
    """A filter acts where the reference steps, the same in both; a drag shows in the first."""
    found = np.zeros((2, SAMPLES))
    for effect in case.effects:
        given = dict(effect.parameters)
        if effect.effect == "load_cell_filter":
            found += STRONG * given["lag_s"] / FILTER.start[0] * decaying(ACTS_S)
        else:
            found[0] += given["constant_N_m"] * decaying(given["from_s"])
    return found


def judged(*, wrong, event, at_s):
    """Return an event's candidate beside the filter, and what is kept of it.

    ``wrong``: share by which the filter does more in the first channel, less in the second.
    """
    acts = STRONG * decaying(ACTS_S)
    measured = np.stack([(1.0 + wrong) * acts, (1.0 - wrong) * acts]) + white((2, SAMPLES), SEED)
    measured[0] += event * decaying(at_s)
    objective = objective_of(formula_twin(response, CHANNELS, SAMPLES), measured)
    (drag,) = (h for h in onset_hypotheses(LINE, 0) if h.key == EffectAt("bearing_drag", "R4"))
    size = wrong * STRONG + event
    base = gauss_newton_fit(objective, [FILTER], [FILTER.start], {}, rounds=0)
    both = gauss_newton_fit(objective, [FILTER, drag], [FILTER.start, (size, at_s)], {}, rounds=0)
    candidate = fitted_candidate(objective, base, both)
    return candidate, more_than_model_errors(objective, base, [candidate], lambda _: None)


def test_what_a_model_has_wrong_where_it_acts_is_no_event():
    candidate, kept = judged(wrong=0.18, event=0.0, at_s=ACTS_S)
    assert candidate.chi2_reduction > LATER_SCORE
    assert kept == []


@pytest.mark.parametrize(
    ("event", "at_s"), [(6.0, 37.0), (20.0, ACTS_S)], ids=["elsewhere", "there, and large"]
)
def test_what_is_no_model_error_stays(event, at_s):
    candidate, kept = judged(wrong=0.0, event=event, at_s=at_s)
    assert candidate.chi2_reduction > LATER_SCORE
    assert kept == [candidate]


def test_power_begun_is_what_there_is_more_of_than_before():
    power = np.concatenate([np.full(50, 2.0), np.full(50, 5.0)])
    assert begun_power(power, 50, 20) == pytest.approx(20 * (5.0 - 2.0))
    assert begun_power(power[::-1], 50, 20) == 0.0
    assert begun_power(power, 10, 30) == pytest.approx(30 * 2.0 - 10 * 2.0)


def test_a_response_counts_by_its_chi_square_and_of_effects_without_a_line_alone():
    twin = formula_twin(response, CHANNELS, SAMPLES)
    objective = objective_of(twin, white((2, SAMPLES), SEED))
    fit = gauss_newton_fit(objective, [FILTER], [FILTER.start], {}, rounds=0)
    (power,) = response_powers(objective, fit)
    assert power.sum() == pytest.approx(2.0 * STRONG**2 * np.sum(decaying(ACTS_S) ** 2), rel=0.1)
    assert response_powers(objective, gauss_newton_fit(objective, [], [], {}, rounds=0)) == []
