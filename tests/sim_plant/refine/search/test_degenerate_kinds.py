"""A line in travel is told by the radius of its roller, not by what is wrong with that."""

import math

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.degenerate_pair import (
    best_pair,
    of_other_kind,
    pairs_by_score,
    same_wavenumbers,
)
from sim_plant.refine.spectra.coordinates import wavenumbers_1_m
from tests.each_case import each_case
from tests.sim_plant.refine.search.rollers import (
    KINDS,
    LINE,
    OTHER_RADIUS_M,
    RADIUS_M,
    SPEED_M_S,
    nothing_found,
    of_kind,
    put,
    seen,
)
from tests.sim_plant.refine.small import axes_at

AXES = axes_at(SPEED_M_S, LINE)
CHOSEN = of_kind("eccentric_roller", "R1")


@each_case(
    ("effect", "place", "alike"),
    [
        ("eccentric_roller", "R2", True),
        ("unbalanced_roller", "R2", True),
        ("unbalanced_roller", "R1", True),
        ("eccentric_roller", "R1", False),  # itself
        ("unbalanced_roller", "R8", False),  # of another radius
        ("bearing_drag", "R2", False),
    ],
)
def test_what_rolls_on_one_radius_is_one_line_whatever_is_wrong_there(effect, place, alike):
    h = hypothesis(BY_NAME[effect], place, line=LINE)
    assert same_wavenumbers(AXES, CHOSEN, h) == alike
    if alike:
        assert wavenumbers_1_m(h, AXES) == pytest.approx(wavenumbers_1_m(CHOSEN, AXES))


def test_orders_of_one_drive_are_lines_of_their_own():
    """The first of a motor's ripple is where its roller's eccentricity is; the second is not."""
    eccentric = hypothesis(BY_NAME["eccentric_roller"], "swrap_lead", line=LINE)
    ripples = [
        hypothesis(BY_NAME["torque_ripple"], "swrap_lead", (("order", n),), line=LINE)
        for n in (1.0, 2.0)
    ]
    assert [same_wavenumbers(AXES, eccentric, h) for h in ripples] == [True, False]
    (found,) = of_other_kind(AXES, eccentric, [ripples[0].key])
    assert dict(found.fixed)["order"] == 1.0


def test_other_kinds_are_those_at_its_wavenumber():
    places = [
        EffectAt("unbalanced_roller", "R1"),
        EffectAt("eccentric_roller", "R2"),  # the same kind
        EffectAt("unbalanced_roller", "R8"),
        EffectAt("bearing_drag", "R1"),
    ]
    assert RADIUS_M != OTHER_RADIUS_M
    assert [h.key for h in of_other_kind(AXES, CHOSEN, places)] == places[:1]


def test_the_best_two_are_told_with_what_else_may_be_in_the_place_of_each():
    """In the place of an eccentric R1 comes R1 out of balance next, or R2, which answers alike."""
    hidden = (put(CHOSEN, 3.0, 1.0), put(of_kind("unbalanced_roller", "R6"), 0.6, -3.1))
    objective, selection = nothing_found(hidden)
    found = best_pair(objective, selection.fit, KINDS)
    by_key = dict(zip((h.key for h in found.two), found.behind, strict=True))
    assert set(by_key) == {CHOSEN.key, EffectAt("unbalanced_roller", "R6")}
    for key, behind in by_key.items():
        assert len(behind) == len(KINDS) - 2
        assert key not in dict(behind)
        less = [value for _, value in behind]
        assert less == sorted(less)
        assert less[0] > 0.0
    assert by_key[CHOSEN.key][0][0].location in ("R1", "R2")
    assert best_pair(objective, selection.fit, KINDS[:1]) is None


@pytest.mark.parametrize("failing", [{"R2"}, {"R1", "R2", "R4"}])
def test_two_are_found_among_those_that_the_line_runs_with(failing):
    def breaks_down(case):
        tensions = seen(case)
        return tensions * np.nan if any(e.location in failing for e in case.effects) else tensions

    hidden = (put(of_kind("eccentric_roller", "R6"), 3.0, 1.0),)
    objective, selection = nothing_found(hidden, breaks_down)
    ranked = pairs_by_score(objective, selection.fit, KINDS)
    left = [h for h in KINDS if h.location not in failing]
    assert len(ranked) == math.comb(len(left), 2)
    assert all(KINDS[k] in left for _, pair in ranked for k in pair)
    assert KINDS[ranked[0][1][0]].key == of_kind("eccentric_roller", "R6").key
    assert best_pair(objective, selection.fit, left[:1]) is None
