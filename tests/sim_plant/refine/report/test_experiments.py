import json
from dataclasses import replace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME, CATALOGUE
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.report.experiments import experiment, experiments
from sim_plant.refine.report.findings import verdict_of
from sim_plant.refine.report.page import headline
from sim_plant.refine.search.selection import AcceptedEffect, Selection
from tests.sim_plant.refine.small import fit_of


@pytest.mark.parametrize(
    ("one", "other", "word"),
    [
        (("eccentric_roller", "R1"), ("eccentric_roller", "R2"), "turn R1 alone"),
        (("unbalanced_roller", "swrap"), ("torque_ripple", "swrap"), "drive off"),
        (("eccentric_roller", "swrap"), ("unbalanced_roller", "swrap"), "dial gauge"),
        (("encoder_eccentricity", "unwind"), ("out_of_round_roll", "unwind"), "second encoder"),
        (("bearing_drag", "R2"), ("load_cell_calibration", "R5"), "over R5"),
        (("bearing_drag", "R2"), ("bearing_drag", "R3"), "R2 and R3 coast"),
        (("web_modulus", "web"), ("wound_in_strain", "unwind"), "another tension"),
    ],
)
def test_the_experiment_touches_what_differs(one, other, word):
    assert word in experiment(EffectAt(*one), EffectAt(*other))


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
        nominal=fit_of(), fit=fit, travels=(), before=(), after=(), accepted=(accepted,)
    )
    verdict = verdict_of(found, None, "b.csv")
    assert verdict.answer == "not_identifiable"
    (same,) = verdict.ambiguous
    assert same.alternatives == (EffectAt("torque_ripple", "swrap"),)
    assert "drive off" in same.experiments[0]
    assert same.experiments[0] in headline(verdict)
    written = json.loads(verdict.to_json())  # places are text in a file of version 1
    assert written["ambiguous"][0]["effect"] == "unbalanced_roller at swrap"
    assert written["ambiguous"][0]["with"] == ["torque_ripple at swrap"]
    assert written["effects"][0]["runner_up"] == "torque_ripple at swrap"
