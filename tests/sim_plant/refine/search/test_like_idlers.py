"""Which idlers are tried first on a long line, and which when the search is near."""

import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.candidate import Candidate
from sim_plant.refine.search.like_idlers import LikeIdlers
from tests.each_case import each_case
from tests.sim_plant.refine.small import LINE

IDLER = next(r for r in LINE.rollers if r.kind == "idler")
NAMES = [f"R{k}" for k in range(1, 13)]
RADIUS_M = 0.04


def line_of(radii_m):
    """Return a line whose idlers have these radii, along the web; its model is not built."""
    idlers = [
        IDLER.model_copy(update={"name": name, "radius_m": radius})
        for name, radius in zip(NAMES, radii_m, strict=False)
    ]
    return LINE.model_copy(update={"rollers": (LINE.rollers[0], *idlers, LINE.rollers[-1])})


def at(effect, places):
    return [hypothesis(BY_NAME[effect], place) for place in places]


def first_places(hypotheses, line):
    thinned = LikeIdlers.of(hypotheses, line).thinned(hypotheses)
    return [h.location for h in thinned]


def looked_at(hypotheses, score):
    return [
        Candidate(hypothesis=h, chi2_reduction=score, penalty=0.0, start=h.start)
        for h in hypotheses
    ]


def test_no_load_cell_and_no_idler_of_a_short_line_is_left_out():
    line = line_of([RADIUS_M] * 12)
    hums, drags = at("mains_hum", NAMES), at("bearing_drag", NAMES)
    assert first_places(hums, line) == NAMES
    assert first_places(drags[:5], line) == NAMES[:5]
    assert first_places(drags, line) == ["R2", "R5", "R8", "R11"]
    assert first_places(at("eccentric_roller", NAMES), line) == ["R2", "R5", "R8", "R11"]


@each_case("own", range(10))
def test_an_idler_of_a_radius_of_its_own_is_tried_where_its_line_alone_has_power(own):
    """Ten idlers, the spectral line of one: it is the whole group, wherever it stands."""
    radii = [0.05 if k == own else RADIUS_M for k in range(10)]
    group = at("eccentric_roller", [NAMES[own]])
    assert first_places(group, line_of(radii)) == [NAMES[own]]


@each_case("own", range(10))
def test_it_is_tried_beside_all_the_others_too(own):
    radii = [0.05 if k == own else RADIUS_M for k in range(10)]
    places = first_places(at("eccentric_roller", NAMES[:10]), line_of(radii))
    assert NAMES[own] in places
    assert len(places) == 4


def test_radii_that_no_record_tells_apart_are_alike():
    """0.3 % is less than a record of a minute resolves: one wave, twelve idlers, every third."""
    radii = [RADIUS_M * (1.0 + 0.003 * (k % 2)) for k in range(12)]
    assert len(first_places(at("eccentric_roller", NAMES), line_of(radii))) == 4


def test_what_shows_at_no_wavenumber_is_thinned_along_the_web_whatever_the_radii():
    radii = [0.03 + 0.002 * k for k in range(12)]
    assert first_places(at("bearing_drag", NAMES), line_of(radii)) == ["R2", "R5", "R8", "R11"]


def test_an_effect_that_is_there_at_the_middle_ones_is_tried_at_another():
    """The fit has an eccentric R2 of two like idlers: R1 stands for what may be there too."""
    radii = [0.05, 0.05, *[RADIUS_M] * 8]
    group = [*at("eccentric_roller", ["R1", *NAMES[2:10]]), *at("unbalanced_roller", NAMES[:10])]
    tried = {h.key for h in LikeIdlers.of(group, line_of(radii)).thinned(group)}
    assert {(k.effect, k.location) for k in tried if k.location in ("R1", "R2")} == {
        ("eccentric_roller", "R1"),
        ("unbalanced_roller", "R2"),
    }


def test_near_the_best_all_like_idlers_are_tried_however_far_along_the_web():
    """Idlers of two radii by turns: those like R4 are two apart, so its neighbours R8 is too."""
    radii = [RADIUS_M, 0.05] * 6
    group = at("eccentric_roller", NAMES)
    like = LikeIdlers.of(group, line_of(radii))
    best = [h for h in like.thinned(group) if h.location == "R4"]
    assert best
    near = {h.location for h in like.neighbours(group, looked_at(best, 100.0))}
    assert near == {"R2", "R3", "R5", "R6", "R8"}
    assert like.neighbours(group, looked_at(best, 0.0)) == []


def test_near_a_load_cell_that_is_an_idler_its_neighbours_along_the_web_are_tried():
    group = at("mains_hum", NAMES)
    like = LikeIdlers.of(group, line_of([RADIUS_M] * 12))
    near = like.neighbours(group, looked_at(group[3:4], 100.0))
    assert [h.location for h in near] == ["R2", "R3", "R5", "R6"]


@pytest.mark.parametrize("alike", [True, False])
def test_every_idler_is_tried_first_or_beside_the_best(alike):
    radii = [RADIUS_M if alike or k % 3 else 0.05 for k in range(12)]
    group = at("eccentric_roller", NAMES)
    like = LikeIdlers.of(group, line_of(radii))
    first = like.thinned(group)
    reached = {h.location for h in first}
    for h in first:
        reached |= {n.location for n in like.neighbours(group, looked_at([h], 100.0))}
    assert reached == set(NAMES)
