"""The side view: where the web runs, and which places a verdict marks."""

from dataclasses import replace

import numpy as np
import pytest

from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.report.sketch import Marks, marks_of_verdict, sketch, web_path_m
from sim_plant.refine.report.verdict import Ambiguity, UnknownFinding
from tests.each_case import each_case
from tests.parameter_records import CONFIG
from tests.sim_plant.refine.small import finding, verdict_with

LINE = load_declaration(CONFIG / "lines/euclid.yaml")
NAMES = [roller.name for roller in LINE.rollers]
R4 = EffectAt("eccentric_roller", "R4")


def at(effect, location):
    return finding(effect, location, {})


def bodies(*names):
    return frozenset(map(NAMES.index, names))


def as_set(*alternatives):
    """Return the verdict that R4 is eccentric, or one of these instead."""
    verdict = verdict_with(at(R4.effect, R4.location))
    open_ = Ambiguity(place=R4, alternatives=alternatives, experiments=())
    return replace(verdict, ambiguous=(open_,))


@pytest.mark.parametrize("file", ["euclid", "film", "coater"])
def test_the_web_drawn_touches_every_body_at_a_right_angle_and_is_as_long_as_declared(file):
    line = load_declaration(CONFIG / f"lines/{file}.yaml")
    for span, (start, end) in zip(line.spans, web_path_m(line), strict=True):
        assert np.linalg.norm(end - start) == pytest.approx(span.length_m, abs=1e-5)
        for point, name in ((start, span.start), (end, span.end)):
            body = line.rollers[line.body(name)]
            arm = point - [body.center_x_m, body.center_y_m]
            assert np.linalg.norm(arm) == pytest.approx(body.radius_m)
            assert arm @ (end - start) == pytest.approx(0.0, abs=1e-5)


@each_case(
    ("effect", "location", "marked"),
    [
        ("eccentric_roller", "R4", Marks(bodies=bodies("R4"))),
        ("loop_delay", "unwind", Marks(bodies=bodies("unwind"))),
        ("load_cell_filter", "R9", Marks(bodies=bodies("R9"))),
        ("changed_number", "control.drives.pull_roll.zeta", Marks(bodies=bodies("pull_roll"))),
        ("changed_number", "sensors.r3_tension_N.gain", Marks(bodies=bodies("R3"))),
        ("splice", "web", Marks(spans=frozenset(range(len(NAMES) - 1)))),
        ("thermal_strain", "R4-R5", Marks(spans=frozenset({NAMES.index("R4")}))),
    ],
)
def test_an_effect_is_marked_where_it_sits(effect, location, marked):
    assert marks_of_verdict(LINE, verdict_with(at(effect, location))) == (marked, Marks())


def test_what_may_be_instead_and_the_zone_of_an_unknown_are_marked_apart_from_what_was_found():
    found, also = marks_of_verdict(LINE, as_set(EffectAt("eccentric_roller", "R5"), R4))
    assert (found.bodies, also.bodies) == (bodies("R4"), bodies("R5"))
    event = UnknownFinding(
        unknown_class="event",
        coordinate={"from_s": 43.2, "zone": "unwind_zone"},
        chi2_reduction=1e4,
    )
    found, also = marks_of_verdict(LINE, replace(verdict_with(), unknown=(event,)))
    assert found == Marks()
    lead = next(k for k, roller in enumerate(LINE.rollers) if roller.kind == "driven")
    assert also == Marks(spans=frozenset(range(lead)))
    turns = replace(event, unknown_class="angle", coordinate={"order": 1.0, "roll": "unwind"})
    found, also = marks_of_verdict(LINE, replace(verdict_with(), unknown=(turns,)))
    assert also == Marks(bodies=bodies("unwind"))


def test_every_body_has_its_name_and_a_verdict_without_a_place_has_no_picture():
    drawn = sketch(LINE, as_set(EffectAt("eccentric_roller", "R5")))
    assert all(f">{name}</text>" in drawn for name in NAMES)
    assert drawn.count("stroke: #b3261e") == 2  # R4 and R5
    assert sketch(LINE, verdict_with()) == ""
