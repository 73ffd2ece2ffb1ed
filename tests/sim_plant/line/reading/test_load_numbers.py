"""What a line file may not say in numbers: every refusal names key, what was read and bounds."""

from __future__ import annotations

import math
from typing import Any

import pytest

from sim_plant.base.effects import Parameter
from sim_plant.effects.catalogue import CATALOGUE
from sim_plant.line.arrays.locations import candidate_locations
from sim_plant.line.declared.declaration import Declaration, EffectEntry
from sim_plant.line.reading.load import consistency
from tests.each_case import each_case
from tests.sim_plant.line.lines import ROOT, declared

BOUNDED = [
    (row, name)
    for row in CATALOGUE
    for name, parameter in row.accepts.items()
    if not isinstance(parameter.default, str) and math.isfinite(parameter.low)
]


def line(name: str = "euclid", **update: Any) -> Declaration:
    return declared(name).model_copy(update=update)


def with_number(effect: str, location: str, key: str, value: float) -> Declaration:
    entry = EffectEntry(effect=effect, location=location, parameters={key: value})
    return line(effects=(entry,))


def beyond(row: Parameter) -> tuple[float, float]:
    """Return a number a little below the lower bound, one a little above the upper."""
    room = 1e-3 * (row.high - row.low)
    return row.low - room, row.high + room


@pytest.mark.parametrize(("row", "name"), BOUNDED, ids=lambda x: getattr(x, "name", x))
@pytest.mark.sweep(every=4)
def test_a_number_beyond_the_catalogues_bounds_is_refused_and_the_bounds_are_not(row, name):
    place, parameter = candidate_locations(declared("euclid"), row)[0], row.accepts[name]
    for value in beyond(parameter):
        (said,) = consistency(with_number(row.name, place, name, value))
        assert said.startswith(f"effects.0.parameters.{name}: read {value:.10g}; expected ")
        assert f"{parameter.low:g} to {parameter.high:g}" in said
    for value in (parameter.low, parameter.high):
        assert consistency(with_number(row.name, place, name, value)) == []


@each_case("value", [-2.0, -1.0, 1e3, math.nan])
def test_a_correction_that_leaves_no_stiffness_or_another_machine_is_refused(value):
    (said,) = consistency(line(corrections={"web.EA_N": value}))
    assert said.startswith(f"corrections.web.EA_N: read {value:.10g}; expected -0.99 to 99")


@each_case(
    ("name", "value"),
    [
        ("web.EA_N", -0.3),
        ("rollers.R6.friction_constant_N_m", -1.0),
        ("sensors.unwind_tension_N.offset", -60.0),
        ("control.pull_roll_draw", 0.001),
    ],
)
def test_a_correction_that_a_machine_can_have_is_taken(name, value):
    assert consistency(line(corrections={name: value})) == []


def test_a_correction_of_what_is_not_declared_is_refused_with_the_nearest_name():
    (said,) = consistency(line(corrections={"web.EA_kN": 0.1}))
    assert said == (
        "corrections.web.EA_kN: this line declares no such number; did you mean 'web.EA_N'?"
    )


@each_case(
    ("radii", "said"),
    [
        ({"core": 0.25}, "initial_radii_m.unwind: read 0.2032; expected more than the radius of"),
        ({"core": 0.2032}, "initial_radii_m.unwind: read 0.2032; expected more than the radius"),
        ({"core": 0.15}, "initial_radii_m.rewind: read 0.12; expected more than the radius of"),
        ({"unwind": 0.18}, "initial_radii_m.unwind: read 0.18, but rollers.unwind.radius_m says"),
        ({"rewind": 0.13}, "initial_radii_m.rewind: read 0.13, but rollers.rewind.radius_m says"),
    ],
)
def test_rolls_smaller_than_their_core_or_of_two_radii_are_refused(radii, said):
    given = declared("euclid").initial_radii_m.model_copy(update=radii)
    assert any(found.startswith(said) for found in consistency(line(initial_radii_m=given)))


def test_a_rewind_may_begin_with_its_core():
    euclid = declared("euclid")
    core = euclid.initial_radii_m.model_copy(update={"core": euclid.initial_radii_m.rewind})
    assert consistency(line(initial_radii_m=core)) == []


@pytest.mark.parametrize(
    ("pattern", "nearest"),
    [("web.EA_kN", "'web.EA_N'"), ("roller.*.radius_m", ""), ("web.thicknes_m", "thickness_m'")],
)
def test_a_tolerance_of_nothing_is_refused_with_the_nearest_name(pattern, nearest):
    (said,) = consistency(line(tolerances={"web.EA_N": 0.1, pattern: 0.1}))
    assert said.startswith(f"tolerances.{pattern}: names no number of this line")
    assert nearest in said


@each_case(
    "pattern", ["*", "*.inertia_kg_m2", "web.*", "rollers.R*.friction_*", "inertia_kg_m2.*"]
)
def test_a_tolerance_of_a_declared_number_is_taken_by_name_or_pattern(pattern):
    assert consistency(line(tolerances={pattern: 0.1})) == []


@each_case("name", ["euclid", "euclid_ripple", "film", "film_ripple", "coater"])
def test_the_shipped_lines_pass(name):
    assert consistency(declared(name)) == []
    assert (ROOT / "config" / "lines" / f"{name}.yaml").exists()
