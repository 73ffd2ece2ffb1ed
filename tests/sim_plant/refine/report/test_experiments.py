import json
from dataclasses import replace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME, CATALOGUE
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.report.experiments import experiment, experiments
from sim_plant.refine.report.findings import verdict_of
from sim_plant.refine.report.next_step import next_step
from sim_plant.refine.report.verdict import Moment
from sim_plant.refine.report.wording import size_of
from sim_plant.refine.search.selection import AcceptedEffect, Selection
from sim_plant.refine.search.unexplained import Unknown
from tests.each_case import each_case
from tests.sim_plant.refine.small import STEP_S, fit_of, formula_twin


@each_case(
    ("one", "other", "word"),
    [
        (
            ("eccentric_roller", "R1"),
            ("eccentric_roller", "R2"),
            "turn R1 and R2 by hand under a dial gauge",
        ),
        (("unbalanced_roller", "swrap"), ("torque_ripple", "swrap"), "drive off"),
        (("eccentric_roller", "swrap"), ("unbalanced_roller", "swrap"), "dial gauge"),
        (("encoder_eccentricity", "unwind"), ("out_of_round_roll", "unwind"), "second encoder"),
        (("bearing_drag", "R2"), ("load_cell_calibration", "R5"), "over R5"),
        (("bearing_drag", "R2"), ("bearing_drag", "R3"), "spin R2 and R3 by hand"),
        (("web_modulus", "web"), ("wound_in_strain", "unwind"), "another tension"),
    ],
)
def test_the_experiment_touches_what_differs(one, other, word):
    assert word in experiment(EffectAt(*one), EffectAt(*other))


def test_an_eccentric_roller_is_gauged_at_rest_and_turned_only_where_its_angle_is_recorded():
    one, rivals = EffectAt("eccentric_roller", "R4"), [EffectAt("eccentric_roller", "R5")]
    values = {"cos_m": 3e-5, "sin_m": -4e-5}  # e = 0.05 mm
    gauge = (
        "take the web off and turn R4 and R5 by hand under a dial gauge: the eccentric one runs "
        "out by twice the eccentricity, 0.1 mm in total"
    )
    assert experiments(one, rivals, values) == [gauge]
    assert experiments(one, rivals, values, angles=["R5", "unwind"]) == [gauge]
    (said,) = experiments(one, rivals, values, angles=["R4"])
    assert said.startswith(f"{gauge}; then lift the web off, turn R4 alone half a turn")
    more = [*rivals, EffectAt("eccentric_roller", "R6"), EffectAt("unbalanced_roller", "R6")]
    both, other = experiments(one, more, values)
    assert "turn R4, R5 and R6 by hand" in both
    assert "turn R4 by hand under a dial gauge: if it is the cause it runs out" in other


def test_of_two_rollers_out_of_balance_one_always_stops_with_the_same_side_down():
    said = experiment(EffectAt("unbalanced_roller", "R4"), EffectAt("unbalanced_roller", "R5"))
    assert "let R4 and R5 turn freely" in said


def test_one_look_goes_round_a_set_along_the_web_and_cells_are_loaded_one_by_one():
    web = ["unwind", *(f"R{k}" for k in range(1, 12))]
    drags = [EffectAt("bearing_drag", name) for name in ("R5", "R3", "R1", "R2", "R11")]
    cell = EffectAt("load_cell_calibration", "all")
    spin, weigh = experiments(EffectAt("bearing_drag", "R4"), [*drags, cell], along=web)
    assert spin.startswith("take the web off, spin R1 to R5 and R11 by hand and time how long")
    assert "the web over each load cell, one after the other, at standstill" in weigh


def test_there_is_one_for_every_pair_of_effects_and_each_is_said_once():
    for a in CATALOGUE:
        for b in CATALOGUE:
            for there in ("x", "y"):
                assert experiment(EffectAt(a.name, "x"), EffectAt(b.name, there))
    rivals = (EffectAt("eccentric_roller", "R2"), EffectAt("eccentric_roller", "R3"))
    assert len(experiments(EffectAt("eccentric_roller", "R1"), rivals)) == 1


def test_the_verdict_names_the_equals_and_the_experiment():
    h = hypothesis(BY_NAME["unbalanced_roller"], "swrap")
    accepted = AcceptedEffect(
        hypothesis=h,
        score=500.0,
        runner_up=EffectAt("torque_ripple", "swrap"),
        margin=2.0,
        rejected=(),
        ambiguous=(EffectAt("torque_ripple", "swrap"),),
    )
    fit = replace(fit_of(h, values=((1e-3, 2e-3),)), covariance=np.eye(2) * 1e-8)
    found = Selection(
        nominal=fit_of(),
        fit=fit,
        record_axes=(),
        spectra_declared=(),
        spectra_left=(),
        accepted=(accepted,),
    )
    verdict = verdict_of(found, None, "b.csv")
    assert verdict.answer == "not_identifiable"
    (same,) = verdict.ambiguous
    assert same.alternatives == (EffectAt("torque_ripple", "swrap"),)
    assert "drive off" in same.experiments[0]
    assert same.experiments[0] in next_step(verdict)
    written = json.loads(verdict.to_json())  # places are text in a file of version 1
    assert written["ambiguous"][0]["effect"] == "unbalanced_roller at swrap"
    assert written["ambiguous"][0]["with"] == ["torque_ripple at swrap"]
    assert written["effects"][0]["runner_up"] == "torque_ripple at swrap"


def test_the_verdict_has_channels_records_and_moments_by_their_names():
    """At 2 m/s the web at 30 m of it unstretched passes after 30 (1 + strain) / 2 s."""
    seam = hypothesis(BY_NAME["splice"], "web", (), ("step_m", "piece_m", "at_length_m"))
    accepted = AcceptedEffect(
        hypothesis=seam, score=500.0, runner_up=None, margin=500.0, rejected=()
    )
    numbers = {"step_m": 5e-4, "piece_m": 0.1, "at_length_m": 30.0}
    fit = fit_of(seam, values=(tuple(numbers[name] for name in seam.names),))
    twin = formula_twin(lambda _case: np.zeros((1, 3000)), ("a_N",), 3000, speed_m_s=2.0)
    event = Unknown(
        unknown_class="event", coordinate={"from_s": 12.5, "record": 2.0}, chi2_reduction=1.0
    )
    found = Selection(
        nominal=fit_of(),
        fit=replace(fit, covariance=np.eye(3) * 1e-8),
        record_axes=(),
        spectra_declared=(),
        spectra_left=(),
        accepted=(accepted,),
        unknown=(event,),
    )
    verdict = verdict_of(found, None, "c.csv", [("a.csv", twin), ("b.csv", twin)])
    (effect,) = verdict.effects
    web = twin.declaration.web
    strain = web.wound_in_tension_N / web.EA_N
    moment_s = effect.parameters["at_length_m"] * (1.0 + strain) / 2.0
    assert effect.begins.record == "a.csv"
    assert effect.begins.time_s == pytest.approx(moment_s, abs=2.0 * STEP_S)
    assert size_of(effect).endswith(f"{effect.begins.time_s:.1f} s after the start of a.csv")
    assert effect.text == BY_NAME["splice"].forms[0].text
    assert verdict.unknown[0].begins == Moment(record="b.csv", time_s=12.5, record_index=1)
    rollers = {s.channel: s.roller for s in twin.declaration.sensors if s.kind == "load_cell"}
    assert effect.cells == tuple(rollers)


def test_of_a_part_that_was_taken_out_the_amplitude_has_the_error_of_the_other():
    effect, choice = BY_NAME["torque_ripple"], (("sin_N_m", 0.0),)
    h = hypothesis(effect, "swrap", choice, ("cos_N_m", "order"))
    fit = replace(fit_of(h, values=((2.0, 6.0),)), covariance=np.diag([0.01**2, 0.5**2]))
    found = Selection(
        nominal=fit_of(),
        fit=fit,
        record_axes=(),
        spectra_declared=(),
        spectra_left=(),
        accepted=(
            AcceptedEffect(hypothesis=h, score=1.0, runner_up=None, margin=1.0, rejected=()),
        ),
    )
    (traced,) = verdict_of(found, None, "b.csv").effects
    assert h.names == ("cos_N_m", "order")
    assert traced.parameters["amplitude_N_m"] == pytest.approx(2.0)
    assert traced.interval95["amplitude_N_m"] == pytest.approx(traced.interval95["cos_N_m"])
