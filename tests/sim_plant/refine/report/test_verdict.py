"""Version 1 of a verdict: the bytes that other programs read, and back."""

import json
from dataclasses import replace

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.report.verdict import (
    Ambiguity,
    ChannelRms,
    EffectFinding,
    UnknownFinding,
    Verdict,
)
from tests.each_case import each_case

VERDICT = Verdict(
    answer="not_identifiable",
    effects=(
        EffectFinding(
            place=EffectAt("eccentric_roller", "R6"),
            parameters={"cos_m": np.float64(3e-4), "order": 1},
            interval95={"cos_m": (2.9e-4, 3.1e-4)},
            score=981535.25,
            runner_up=EffectAt("eccentric_roller", "R7"),
            margin=4.5,
            cancel=True,
            text="a roller turns off its axis",
        ),
    ),
    unknown=(
        UnknownFinding(
            unknown_class="angle", coordinate={"roll": "unwind", "order": 4.0}, chi2_reduction=1e4
        ),
    ),
    ambiguous=(
        Ambiguity(
            place=EffectAt("eccentric_roller", "R6"),
            alternatives=(EffectAt("eccentric_roller", "R7"),),
            experiments=("turn R6",),
        ),
    ),
    residual_rms={"unwind_tension_N": ChannelRms(before=1.0, after=0.25, noise_floor=0.25)},
    holdout="b.csv",
)
GOLDEN = """\
{
 "version": 1,
 "verdict": "not_identifiable",
 "effects": [
  {
   "effect": "eccentric_roller",
   "location": "R6",
   "parameters": {
    "cos_m": 0.0003,
    "order": 1
   },
   "interval95": {
    "cos_m": [
     0.00029,
     0.00031
    ]
   },
   "score": 981535.25,
   "runner_up": "eccentric_roller at R7",
   "margin": 4.5,
   "cancel": true,
   "text": "a roller turns off its axis"
  }
 ],
 "unknown": [
  {
   "class": "angle",
   "coordinate": {
    "roll": "unwind",
    "order": 4.0
   },
   "strength": 10000.0
  }
 ],
 "ambiguous": [
  {
   "effect": "eccentric_roller at R6",
   "with": [
    "eccentric_roller at R7"
   ],
   "experiments": [
    "turn R6"
   ]
  }
 ],
 "residual_rms": {
  "unwind_tension_N": {
   "before": 1.0,
   "after": 0.25,
   "noise_floor": 0.25
  }
 },
 "holdout": "b.csv"
}
"""


def test_version_1_is_written_to_the_byte():
    assert VERDICT.to_json() == GOLDEN


def test_a_file_of_version_1_is_read_back_as_it_was():
    assert Verdict.from_json(GOLDEN) == VERDICT
    assert Verdict.from_json(GOLDEN).to_json() == GOLDEN


def test_what_a_line_may_be_as_well_stands_beside_it_and_is_read_back():
    """Who reads ``class`` and ``coordinate`` alone reads on; a line that is told has no more."""
    also = (("travel", {"wavenumber_1_m": 5.0, "equivalent_radius_m": 1.0 / (10.0 * np.pi)}),)
    line = UnknownFinding(
        unknown_class="time", coordinate={"frequency_Hz": 4.0}, chi2_reduction=9e2, also=also
    )
    said = replace(VERDICT, unknown=(line, *VERDICT.unknown))
    first, second = json.loads(said.to_json())["unknown"]
    assert (first["class"], first["coordinate"]) == ("time", {"frequency_Hz": 4.0})
    assert first["alternatives"] == [{"class": "travel", "coordinate": also[0][1]}]
    assert "alternatives" not in second
    assert Verdict.from_json(said.to_json()).unknown == said.unknown


def test_what_the_runner_up_leaves_is_a_key_more_where_it_was_judged():
    (found,) = VERDICT.effects
    said = replace(VERDICT, effects=(replace(found, runner_up_rms={"unwind_tension_N": 0.4}),))
    (row,) = json.loads(said.to_json())["effects"]
    assert row["runner_up_rms"] == {"unwind_tension_N": 0.4}
    assert Verdict.from_json(said.to_json()) == said


def test_no_runner_up_is_an_empty_text_in_a_file():
    alone = json.loads(GOLDEN)
    alone["effects"][0]["runner_up"] = ""
    assert Verdict.from_json(json.dumps(alone)).effects[0].runner_up is None


def changed(**keys):
    return json.dumps(json.loads(GOLDEN) | keys)


@each_case(
    ("text", "said"),
    [
        ("{", "no verdict of version 1"),
        ("[]", "no verdict of version 1"),
        (changed(version=2), "version: read 2; expected 1"),
        (changed(verdict="perhaps"), "verdict: read 'perhaps'; expected one of"),
        (changed(effects=[{"effect": "x"}]), "location is missing"),
        (changed(ambiguous=[{"effect": "x", "with": []}]), "read 'x'; expected an effect, ' at '"),
    ],
)
def test_what_is_no_verdict_is_refused_with_the_reason(text, said):
    with pytest.raises(PlantError, match=said):
        Verdict.from_json(text)


@each_case(("location", "named"), [("R6", True), ("R7", True), ("R8", False), ("unwind", False)])
def test_a_verdict_names_what_it_found_and_what_it_does_not_tell_from_that(location, named):
    assert VERDICT.names(EffectAt("eccentric_roller", location)) is named
    assert not VERDICT.names(EffectAt("unbalanced_roller", location))
