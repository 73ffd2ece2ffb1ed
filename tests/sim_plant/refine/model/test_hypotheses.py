import itertools
import math
from pathlib import Path

import pytest

from sim_plant.base.effects import Demand
from sim_plant.effects.catalogue import BY_NAME, CATALOGUE
from sim_plant.line.load import load_declaration
from sim_plant.refine.model.hypotheses import hypothesis, library, onset_library, turned

LINE = load_declaration(Path(__file__).parents[4] / "config/lines/euclid.yaml")


def test_every_effect_is_tried_and_one_can_be_left_out():
    names = {h.effect.name for h in library(LINE)}
    assert names == {effect.name for effect in CATALOGUE if effect.fitted}
    assert "slip" not in {h.effect.name for h in library(LINE, ["slip"])}


def test_what_begins_at_a_moment_is_tried_in_every_form_and_in_one_record_only():
    found = onset_library(LINE, 1)
    assert {h.effect.name for h in found} == {e.name for e in CATALOGUE if e.onset is not None}
    assert {h.record for h in found} == {1}
    assert all(h.moment in h.names for h in found)
    assert not [h for h in onset_library(LINE, 0, ["splice"]) if h.effect.name == "splice"]


def test_every_idler_may_be_eccentric():
    places = {h.location for h in library(LINE) if h.effect.name == "eccentric_roller"}
    assert {r.name for r in LINE.rollers if r.kind != "roll"} == places


def test_a_form_is_tried_only_where_it_can_be():
    forms = {
        (h.location, limits)
        for h in library(LINE)
        if h.effect.name == "rate_limit"
        for limits in [dict(h.fixed)["limits"]]
    }
    trimmed = {loop.acts_on for loop in LINE.control.tension_pi}
    assert {place for place, limits in forms if limits == "loop"} == trimmed
    drives = {drive.roller for drive in LINE.control.drives}
    assert {place for place, limits in forms if limits == "reference"} == drives


def just_below_a_ramp(rate_m_s2: float) -> list:
    """Return what is tried of the pull roll only because records ramp at this rate."""
    found = library(LINE, demand=Demand(fastest_ramp_m_s2=rate_m_s2))
    return [h for h in found if h.acts_below and h.location == "pull_roll"]


def test_a_limit_of_the_reference_is_looked_for_just_below_the_fastest_ramp():
    """What is drawn at the pull roll ramps faster by the draw; a higher limit leaves no trace."""
    limits = just_below_a_ramp(0.2)
    demand = 0.2 * (1.0 + LINE.control.pull_roll_draw)
    starts = sorted(1.0 - h.start[0] / demand for h in limits)
    assert starts[0] < 0.0005
    assert all(b / a < 3.5 for a, b in itertools.pairwise(starts))
    assert {h.idle for h in limits} == {h.highest for h in limits} == {(demand,)}
    assert not just_below_a_ramp(0.0)


def test_a_limit_below_a_ramp_is_stepped_away_from_it_by_a_share_of_its_distance():
    for h in just_below_a_ramp(0.2):
        (step,) = h.increments(h.start)
        assert -step <= (h.idle[0] - h.start[0]) / 3.0 + 1e-12
        assert step < 0.0


def test_a_probe_moves_one_strength_and_leaves_the_others_absent():
    h = hypothesis(BY_NAME["eccentric_roller"], "R6")
    first, second = (dict(p.parameters) for p in h.typical_effects())
    assert first["cos_m"] > 0.0 == first["sin_m"]
    assert second["sin_m"] > 0.0 == second["cos_m"]


def test_values_are_kept_within_bounds():
    h = hypothesis(BY_NAME["web_modulus"], "web")
    assert dict(h.added([-3.0]).parameters)["factor"] == h.low[0]


def test_increments_stay_inside_the_bounds():
    h = hypothesis(BY_NAME["web_modulus"], "web")
    assert h.increments([h.high[0]])[0] < 0.0


def test_turning_a_body_turns_its_phasor():
    effect = BY_NAME["eccentric_roller"]
    out = turned(effect, {"cos_m": 1.0, "sin_m": 0.0}, 0.5)
    assert out["cos_m"] == pytest.approx(math.cos(0.5))
    assert out["sin_m"] == pytest.approx(math.sin(0.5))


def test_turning_a_roll_turns_order_n_by_n_times_the_angle():
    effect = BY_NAME["out_of_round_roll"]
    out = turned(effect, {"cos3_m": 1.0, "sin3_m": 0.0, "angle_rad": 0.1}, 0.2)
    assert math.atan2(out["sin3_m"], out["cos3_m"]) == pytest.approx(0.6)
    assert out["angle_rad"] == pytest.approx(0.3)


def test_the_unbalance_of_a_bouncing_roll_turns_by_the_order_it_names():
    values = {"cosn_kg_m": 1.0, "sinn_kg_m": 0.0, "order": 4.0}
    out = turned(BY_NAME["roll_bounce"], values, 0.2)
    assert math.atan2(out["sinn_kg_m"], out["cosn_kg_m"]) == pytest.approx(-0.8)


def test_a_ripple_is_tried_at_every_order_that_its_file_names():
    orders = {dict(h.fixed)["order"] for h in library(LINE) if h.effect.name == "torque_ripple"}
    assert orders == set(BY_NAME["torque_ripple"].accepts["order"].tries)
    assert {1.0, 5.0, 36.0} <= orders
