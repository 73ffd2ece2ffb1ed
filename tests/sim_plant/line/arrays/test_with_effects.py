from dataclasses import replace

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.arrays.build import build_arrays, timing_of
from sim_plant.line.arrays.locations import places_of
from sim_plant.line.arrays.with_effects import apply_effects, merged
from sim_plant.line.declared.declaration import EffectEntry
from tests.each_case import each_case
from tests.sim_plant.line.lines import declared

LINE = declared("euclid")


def arrays():
    return build_arrays(LINE, timing_of(LINE, LINE.sample_time_s))


def entry(effect="eccentric_roller", location="R6", **parameters):
    return EffectEntry(effect=effect, location=location, parameters=parameters)


def at(place):
    return replace(BY_NAME["eccentric_roller"], place=place)


@each_case(
    ("bad", "said"),
    [
        (entry(effect="excentric_roller"), "effects.1.effect: read 'excentric_roller'"),
        (entry(effect="excentric_roller"), "did you mean 'eccentric_roller'?"),
        (entry(location="R66"), "effects.1.location: read 'R66'; expected one of"),
        (entry(eccentricity_mm=1.0), "effects.1.parameters: unknown key 'eccentricity_mm'"),
        (entry(eccentricity_mm=1.0), "did you mean 'eccentricity_m'?"),
        (entry(eccentricity_m="1e-3"), "effects.1.parameters.eccentricity_m: read '1e-3'"),
        (entry(eccentricity_m=True), "read True; expected a number"),
        (entry(eccentricity_m=float("nan")), "read nan; expected a number"),
        (entry("out_of_round_roll", "unwind", shape="square", size_m=1e-3), "read 'square'"),
        (
            entry("out_of_round_roll", "unwind", size_m=-0.001),
            "size_m: read -0.001; expected >= 0",
        ),
    ],
)
def test_a_wrong_entry_is_refused_by_its_number_and_key(bad, said):
    good = entry(eccentricity_m=1e-4)
    with pytest.raises(PlantError) as caught:
        apply_effects(LINE, arrays(), [good, bad])
    assert said in str(caught.value)


@each_case(
    ("place", "location", "expected"),
    [
        ("web", "web", [0]),
        ("span", "R2-R3", [2]),
        ("cell", "R9", [0]),
        ("cell", "all", [0, 1, 2, 3]),
        ("loop", "rewind", [1]),
        ("body", "R9", [9]),
        ("drive", "swrap_follower", [2]),
    ],
)
def test_a_location_names_the_index_of_its_kind(place, location, expected):
    assert places_of(LINE, at(place), location, "effects.0.location") == expected


@each_case(
    ("place", "location", "said"),
    [
        ("span", "R3-R2", "did you mean"),
        ("cell", "R8", "effects.0.location: read 'R8'; expected one of"),
        ("loop", "pull_roll", "read 'pull_roll'"),
        ("drive", "R9", "roller 'R9' has no drive"),
        ("drive", "unwinder", "did you mean 'unwind'"),
    ],
)
def test_a_location_of_another_kind_is_refused(place, location, said):
    with pytest.raises(PlantError) as caught:
        places_of(LINE, at(place), location, "effects.0.location")
    assert said in str(caught.value)


def test_given_values_go_on_top_of_defaults():
    effect = BY_NAME["out_of_round_roll"]
    values = merged(effect, {"size_m": 1, "shape": "bulge"}, "effects.0")
    assert values["size_m"] == 1.0
    assert isinstance(values["size_m"], float)
    assert values["shape"] == "bulge"
    assert values["gravity"] == effect.parameters["gravity"]


def test_no_entries_change_nothing():
    after = apply_effects(LINE, arrays(), [])
    assert all(np.array_equal(a, b) for a, b in zip(arrays(), after, strict=True))


def test_two_effects_on_one_body_add():
    twice = apply_effects(LINE, arrays(), [entry(eccentricity_m=1e-4)] * 2)
    once = apply_effects(LINE, arrays(), [entry(eccentricity_m=2e-4)])
    row = int(twice.bodies["shape_row"][6])
    assert row == 0
    assert twice.shape_h_m[row] == pytest.approx(once.shape_h_m[row], abs=1e-18)
    assert twice.shape_h_m.shape == once.shape_h_m.shape


def test_a_declaration_of_effects_gives_one_table_row_per_shaped_body():
    ripple = declared("euclid_ripple")
    found = apply_effects(ripple, arrays(), ripple.effects)
    assert found.bodies["shape_row"][0] == 0
    assert found.bodies["shape_row"][11] == 1
    assert found.shape_rho_m.shape[0] == 2
