import numpy as np
import pytest

from sim_plant.refine.fit.gauss_newton import gauss_newton_fit, nominal_fit
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import onset_hypotheses
from sim_plant.refine.model.twin import Added, Case
from sim_plant.refine.search.events import event_candidates
from sim_plant.refine.search.placed_events import placed_anew, with_moment_refined
from tests.sim_plant.refine.small import LINE, STEP_S, formula_twin, objective_of, quiet, white

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
@pytest.mark.sweep(every=3)
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


def warm_of(case):
    """Web that is warm for a while slackens at one cell, as sharply as it becomes so."""
    both = np.zeros((2, SAMPLES))
    for added in case.effects:
        given = dict(added.parameters)
        if added.effect == "thermal_strain" and added.location == "unwind_zone":
            begin, end = given["from_s"], given["from_s"] + given["hold_s"]
            up, down = (np.clip((TIME_S - t) / given["rise_s"], 0.0, 1.0) for t in (begin, end))
            both[0] -= 1e4 * given["strain"] * (up - down)
    return both


@pytest.mark.parametrize(("hold_s", "rise_s"), [(7.6, 0.6), (13.4, 0.6), (20.7, 2.0), (13.4, 1.0)])
@pytest.mark.sweep(every=4)
def test_what_ends_again_is_found_with_its_end_and_its_rise(hold_s, rise_s):
    """A fit finds an end from a fraction of its rise, not from seconds away."""
    true = Added(
        "thermal_strain",
        "unwind_zone",
        (("strain", 5e-4), ("from_s", 31.2), ("rise_s", rise_s), ("hold_s", hold_s)),
    )
    measured = warm_of(Case(effects=(true,))) + white((2, SAMPLES), 4)
    objective = objective_of(formula_twin(warm_of, CHANNELS, SAMPLES), measured)
    best = event_candidates(objective, nominal_fit(objective, {}), (), quiet)[0]
    found = dict(zip(best.hypothesis.names, best.start, strict=True))
    assert best.hypothesis.effect.name == "thermal_strain"
    assert found["rise_s"] == pytest.approx(rise_s, abs=0.61)  # of a grid of 0.5, 1 and 2
    half_way_s = found["from_s"] + 0.5 * found["rise_s"]
    assert half_way_s == pytest.approx(31.2 + 0.5 * rise_s, abs=0.15)
    assert half_way_s + found["hold_s"] == pytest.approx(31.2 + 0.5 * rise_s + hold_s, abs=0.15)
    assert found["strain"] == pytest.approx(5e-4, rel=0.1)


def test_what_lasts_longer_than_the_filter_is_seen_by_all_of_it():
    """25 s of 0.3 noise units explain some 200; 6 s of them less than a look is worth."""
    true = Added(
        "thermal_strain",
        "unwind_zone",
        (("strain", 3e-5), ("from_s", 24.3), ("rise_s", 1.0), ("hold_s", 25.0)),
    )
    measured = warm_of(Case(effects=(true,))) + white((2, SAMPLES), 4)
    objective = objective_of(formula_twin(warm_of, CHANNELS, SAMPLES), measured)
    best = event_candidates(objective, nominal_fit(objective, {}), (), quiet, 120.0)[0]
    found = dict(zip(best.hypothesis.names, best.start, strict=True))
    assert found["from_s"] == pytest.approx(24.3, abs=1.5)
    assert found["hold_s"] == pytest.approx(25.0, abs=2.0)
    assert found["strain"] == pytest.approx(3e-5, rel=0.2)


@pytest.mark.parametrize(("share", "looked_at"), [(0.5, True), (1.0 / 0.29, False)])
def test_an_event_far_below_what_is_needed_is_not_looked_at(share, looked_at):
    """Its first look sees a step of 40 noise units over 27 s at nearly its whole size."""
    measured = white((2, SAMPLES), 4)
    measured[1] -= 2.0 * PULL_N * 0.05 * (TIME_S >= 32.8)
    objective = objective_of(formula_twin(drag_of, CHANNELS, SAMPLES), measured)
    nominal = nominal_fit(objective, {})
    explained = nominal.cost - objective.expected_cost
    found = event_candidates(objective, nominal, (), quiet, least_score=share * explained)
    assert bool(found) == looked_at


@pytest.mark.long  # quick: moments and ends are found, above
def test_an_event_that_stands_seconds_off_is_placed_anew():
    """What it leaves would pass for a second event."""
    numbers = {"strain": 5e-4, "from_s": 31.2, "rise_s": 0.6, "hold_s": 15.2}
    true = Added("thermal_strain", "unwind_zone", tuple(numbers.items()))
    measured = warm_of(Case(effects=(true,))) + white((2, SAMPLES), 4)
    objective = objective_of(formula_twin(warm_of, CHANNELS, SAMPLES), measured)
    nominal = nominal_fit(objective, {})
    h = event_candidates(objective, nominal, (), quiet)[0].hypothesis
    off = numbers | {"from_s": 28.0, "hold_s": 17.0, "rise_s": 1.0}
    start = [off.get(name, was) for name, was in zip(h.names, h.start, strict=True)]
    stuck = gauss_newton_fit(objective, (h,), (start,), {}, rounds=0)
    anew = placed_anew(objective, stuck)
    assert anew.cost < stuck.cost - 1000.0
    found = dict(zip(h.names, anew.values[0], strict=True))
    assert found["from_s"] + 0.5 * found["rise_s"] == pytest.approx(31.5, abs=0.05)
    assert found["hold_s"] == pytest.approx(15.2, abs=0.1)
    assert placed_anew(objective, anew) is anew


PULLED = "control.pull_roll_draw"
"""The number of the formula line that pulls at both cells, unlike any drag."""


def pulled_of(case):
    """A drag that begins pulls at one cell, a draw that is another one from a moment on at two."""
    both = drag_of(case)
    for added in case.effects:
        if added.effect == "changed_number" and added.location == PULLED:
            given = dict(added.parameters)
            both += 1e5 * given["change"] * (given["from_s"] <= TIME_S)
    return both


def test_a_declared_number_is_found_at_the_moment_from_which_it_is_another_one():
    measured = white((2, SAMPLES), 4) + 1e5 * 2e-5 * (TIME_S >= 32.84)
    objective = objective_of(formula_twin(pulled_of, CHANNELS, SAMPLES), measured)
    best = event_candidates(objective, nominal_fit(objective, {}), (), quiet)[0]
    found = dict(zip(best.hypothesis.names, best.start, strict=True))
    assert (best.hypothesis.effect.name, best.hypothesis.location) == ("changed_number", PULLED)
    assert found["from_s"] == pytest.approx(32.84, abs=0.03)
    assert found["change"] == pytest.approx(2e-5, rel=0.05)


def test_no_declared_number_is_tried_in_a_record_in_which_nothing_begins():
    tried = set()

    def seen(case):
        tried.update(added.effect for added in case.effects)
        return pulled_of(case)

    objective = objective_of(formula_twin(seen, CHANNELS, SAMPLES), white((2, SAMPLES), 4))
    event_candidates(objective, nominal_fit(objective, {}), (), quiet)
    assert "bearing_drag" in tried
    assert "changed_number" not in tried


def test_a_fitted_moment_a_few_samples_off_is_put_where_it_explains_most():
    measured = white((2, SAMPLES), 4)
    measured[1] -= PULL_N * 0.05 * (TIME_S >= 30.0)
    objective = objective_of(formula_twin(drag_of, CHANNELS, SAMPLES), measured)
    (h,) = (h for h in onset_hypotheses(LINE, 0) if h.key == EffectAt("bearing_drag", "R4"))
    stopped = gauss_newton_fit(objective, [h], [(0.05, 30.12)], {}, rounds=0)
    (found,) = with_moment_refined(objective, stopped).values
    assert found[h.names.index("from_s")] == pytest.approx(30.0, abs=0.025)  # a step of the grid
