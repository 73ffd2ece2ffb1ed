"""Effects at their places on a line: what is fitted of them, from where, in which steps."""

import itertools
from pathlib import Path

import numpy as np
import pytest

from sim_plant.base.effects import Demand
from sim_plant.effects.catalogue import BY_NAME, CATALOGUE
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.model.hypotheses import all_hypotheses, hypothesis, onset_hypotheses

LINE = load_declaration(Path(__file__).parents[4] / "config/lines/euclid.yaml")


def test_every_effect_is_tried_and_one_can_be_left_out():
    names = {h.effect.name for h in all_hypotheses(LINE)}
    assert names == {effect.name for effect in CATALOGUE if effect.fitted}
    assert "slip" not in {h.effect.name for h in all_hypotheses(LINE, ["slip"])}


def test_what_begins_at_a_moment_is_tried_in_every_form_and_in_one_record_only():
    found = onset_hypotheses(LINE, 1)
    assert {h.effect.name for h in found} == {e.name for e in CATALOGUE if e.onset is not None}
    assert {h.record_index for h in found} == {1}
    assert all(h.moment_parameter in h.names for h in found)
    assert not [h for h in onset_hypotheses(LINE, 0, ["splice"]) if h.effect.name == "splice"]


def test_every_idler_may_be_eccentric():
    places = {h.location for h in all_hypotheses(LINE) if h.effect.name == "eccentric_roller"}
    assert {r.name for r in LINE.rollers if r.kind != "roll"} == places


def test_a_form_is_tried_only_where_it_can_be():
    forms = {
        (h.location, limits)
        for h in all_hypotheses(LINE)
        if h.effect.name == "rate_limit"
        for limits in [dict(h.fixed)["limits"]]
    }
    trimmed = {loop.acts_on for loop in LINE.control.tension_pi}
    assert {place for place, limits in forms if limits == "loop"} == trimmed
    drives = {drive.roller for drive in LINE.control.drives}
    assert {place for place, limits in forms if limits == "reference"} == drives


def demand(**asked: float) -> Demand:
    """Return the demand of records at 1 m/s and 10 ms but for what is ``asked``."""
    plain = {"slowest_m_s": 1.0, "fastest_m_s": 1.0, "highest_Hz": 50.0}
    return Demand(**({"fastest_ramp_m_s2": 0.0} | plain | asked))


def starts_of(effect: str, place: str, number: str, **asked: float) -> list[float]:
    """Return where a search of an effect at a place begins, by one of its numbers, rising."""
    found = all_hypotheses(LINE, demand=demand(**asked))
    rows = [h for h in found if (h.effect.name, h.location) == (effect, place)]
    return sorted(float(h.at_start[number]) for h in rows)


@pytest.mark.parametrize("ends_m_s", [(0.5, 1.5), (2.0, 8.0), (0.0, 12.0)])
def test_slip_begins_at_shares_of_the_speeds_that_records_have(ends_m_s):
    """By a formula of its own: sampled, what slips above any threshold looks like a start's."""
    low, high = ends_m_s
    begun = starts_of("slip", "pull_roll", "threshold_m_s", slowest_m_s=low, fastest_m_s=high)
    assert begun[0] == 0.0  # from standstill on: in proportion to speed
    assert all(low <= start < high for start in begun[1:])
    speed = np.linspace(low, high, 2000)
    for share in np.geomspace(0.1, 1.0, 40):
        true = np.maximum(0.0, speed - high + share * (high - low))
        tried = np.array([np.maximum(0.0, speed - start) for start in begun])
        alike = tried @ true / np.linalg.norm(tried, axis=1) / np.linalg.norm(true)
        assert alike.max() > 0.96


def test_at_one_speed_slip_has_one_start():
    begun = starts_of("slip", "pull_roll", "threshold_m_s", slowest_m_s=2.0, fastest_m_s=2.0)
    assert begun == [0.0]


@pytest.mark.parametrize("sample_time_s", [0.05, 0.01, 0.002])
def test_a_cell_begins_to_ring_within_two_half_widths_of_every_frequency_shown(sample_time_s):
    """A damping of 0.05: 10 % to either side, up to half the sample rate, 200 Hz at the most."""
    begun = starts_of("load_cell_resonance", "R3", "frequency_Hz", highest_Hz=0.5 / sample_time_s)
    for true_Hz in np.geomspace(1.5, min(0.5 / sample_time_s, 200.0) / 1.2, 200):
        assert min(abs(start / true_Hz - 1.0) for start in begun) < 0.1001
    assert len(begun) == len(set(begun)) <= np.log(200.0 / 1.5) / np.log(1.2) + 1


def just_below_a_ramp(rate_m_s2: float) -> list:
    """Return what is tried of the pull roll only because records ramp at this rate."""
    found = all_hypotheses(LINE, demand=demand(fastest_ramp_m_s2=rate_m_s2))
    return [h for h in found if h.acts_below and h.location == "pull_roll"]


def test_a_limit_of_the_reference_is_looked_for_just_below_the_fastest_ramp():
    """What is drawn at the pull roll ramps faster by the draw; a higher limit leaves no trace."""
    limits = just_below_a_ramp(0.2)
    asked = 0.2 * (1.0 + LINE.control.pull_roll_draw)
    starts = sorted(1.0 - h.start[0] / asked for h in limits)
    assert starts[0] < 0.0005
    assert all(b / a < 3.5 for a, b in itertools.pairwise(starts))
    assert {h.idle for h in limits} == {h.highest for h in limits} == {(asked,)}
    assert not just_below_a_ramp(0.0)


def test_a_limit_below_a_ramp_is_stepped_away_from_it_by_a_share_of_its_distance():
    for h in just_below_a_ramp(0.2):
        (step,) = h.increments(h.start)
        assert -step <= (h.idle[0] - h.start[0]) / 3.0 + 1e-12
        assert step < 0.0


def test_a_probe_moves_one_strength_and_leaves_the_others_absent():
    h = hypothesis(BY_NAME["eccentric_roller"], "R6")
    first, second = (dict(p.parameters) for p in h.start_effects())
    assert first["cos_m"] > 0.0 == first["sin_m"]
    assert second["sin_m"] > 0.0 == second["cos_m"]


@pytest.mark.parametrize("beyond", [-3.0, 1e9])
def test_values_are_kept_within_bounds(beyond):
    h = hypothesis(BY_NAME["web_modulus"], "web")
    end = h.low[0] if beyond < 0.0 else h.high[0]
    assert dict(h.added([beyond]).parameters)["factor"] == end


def test_increments_stay_inside_the_bounds():
    h = hypothesis(BY_NAME["web_modulus"], "web")
    for end in (h.low[0], h.high[0]):
        assert h.within([end + step for step in h.increments([end])])


def test_a_linear_strength_steps_by_a_quarter_of_the_larger_of_its_size_and_its_start():
    """A curved number by a twentieth of its size, or of a fifth of its start."""
    h = hypothesis(BY_NAME["eccentric_roller"], "R6")
    cos_m, sin_m = h.increments([4.0 * h.start[0], 0.1 * h.start[1]])
    assert cos_m == pytest.approx(0.25 * 4.0 * h.start[0])
    assert sin_m == pytest.approx(0.25 * h.start[1])
    twist = hypothesis(
        BY_NAME["shaft_compliance_backlash"], "unwind", fitted=("compliance_rad_N_m",)
    )
    (start,) = twist.start
    assert twist.increments([2.0 * start]) == pytest.approx([0.05 * 2.0 * start])
    assert twist.increments([0.0]) == pytest.approx([0.05 * 0.2 * start])


def test_a_step_that_an_effect_states_is_taken_and_an_angle_turns_by_its_own():
    delay = hypothesis(BY_NAME["loop_delay"], "unwind")
    assert delay.increments(delay.start) == [BY_NAME["loop_delay"].accepts["delay_s"].step]
    flat = hypothesis(BY_NAME["out_of_round_roll"], "unwind", fitted=("size_m", "angle_rad"))
    assert flat.increments(flat.start)[1] == pytest.approx(0.02)


def test_a_ripple_is_tried_at_every_order_that_its_file_names():
    orders = {
        dict(h.fixed)["order"] for h in all_hypotheses(LINE) if h.effect.name == "torque_ripple"
    }
    assert orders == set(BY_NAME["torque_ripple"].accepts["order"].tries)
    assert {1.0, 5.0, 36.0} <= orders
