"""Words that show one value are no sure pick; the one that somebody moves is told apart."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from aff_runtime.app.setup.words.apart import (
    alike,
    first_moved,
    neighbours,
    without_halves,
    words_that_moved,
)
from aff_runtime.app.setup.words.candidates import Candidate, Observation, candidates
from aff_runtime.app.setup.words.display import shown_value
from tests.aff_runtime.app.setup.virtual_words import Item, euclid, ripple, still, watched

TAKEN = frozenset({0})


def cells(*values: Callable[[float], float]) -> list[Item]:
    """Return the default block with load cells of one scale at words 2, 20, 23, ..."""
    rest = [item for item in euclid() if item.address not in (2, 9)]
    places = (2, *range(20, 17 + 3 * len(values), 3))
    return [
        *rest,
        *(Item(place, "i32", 0.001, value) for place, value in zip(places, values, strict=True)),
    ]


def rows_of(items: list[Item], text: str) -> tuple[list[Candidate], list[Candidate]]:
    """Return what fits, and what is near it."""
    one = Observation(shown=shown_value(text, "N"), seen=watched(items, 2.0))
    rows = candidates([one], "N", signed=True, moves=True, taken=TAKEN)
    return rows, neighbours(rows[0], rows, [one], taken=TAKEN)


def test_one_load_cell_alone_has_no_rival_and_no_neighbour() -> None:
    rows, near = rows_of(cells(ripple(90.0, 1.5)), "90.0 N")
    assert rows[0].decoding.address == 2
    assert alike(rows) == rows[:1]
    assert near == []


@pytest.mark.parametrize("other_N", [90.0, 90.4])
def test_a_quiet_cell_at_the_same_tension_is_a_rival_of_a_rippling_one(other_N: float) -> None:
    """The quiet one comes first by its score: the display says nothing of which it is."""
    rows, _ = rows_of(cells(ripple(90.0, 1.5), ripple(other_N, 0.2, 1.7)), "90.2 N")
    assert {2, 20} <= {one.decoding.address for one in alike(rows)}


def test_a_cell_that_was_read_a_moment_ago_stands_beside_one_that_fits_by_its_ripple() -> None:
    """At 92.6 N with 0.1 N of noise it misses the 91.0 N of the display, but by an odd scale."""
    rows, near = rows_of(cells(ripple(90.0, 1.5), ripple(92.6, 0.1, 1.7)), "91.0 N")
    assert rows[0].decoding.address == 2
    assert not any(one.scale == 0.001 for one in rows if one.decoding.address == 20)
    assert [one.decoding.address for one in near] == [20]
    assert near[0].value == pytest.approx(92.6, abs=0.05)
    assert alike([*rows, *near])[-1] == near[0]


def test_the_low_word_of_a_load_cell_is_no_row_beside_it_unless_its_scale_is_the_same() -> None:
    """45.0 N of 1 mN are 45000 counts of the low word, too; 84.5 N are 18964 of 0.001 lbf."""
    for shown_N, is_told in ((45.0, True), (84.5, False)):
        rows, _ = rows_of(cells(ripple(shown_N, 0.4)), f"{shown_N:.1f} N")
        assert {2, 3} <= {one.decoding.address for one in alike(rows)}
        told = alike(without_halves(rows))
        assert told[0].scale == 0.001
        assert (3 in {one.decoding.address for one in told}) is is_told


def test_a_set_point_and_a_cell_six_per_cent_off_are_no_neighbours() -> None:
    items = [*cells(ripple(90.0, 1.5), ripple(95.6, 0.2)), Item(30, "i32", 0.001, still(90.0))]
    assert rows_of(items, "90.0 N")[1] == []


def pressed(value: Callable[[float], float], by: float) -> Callable[[float], float]:
    """Return a value on which somebody presses from 8 s to 10 s."""
    return lambda t_s: value(t_s) + (by if 8.0 <= t_s < 10.0 else 0.0)


@pytest.mark.parametrize("place", [2, 20, 23])
def test_the_cell_that_is_pressed_is_the_one_that_moved(place: int) -> None:
    plain = (ripple(90.0, 1.5), ripple(90.0, 0.3, 1.7), ripple(90.5, 0.4, 1.1))
    values = [
        pressed(value, 6.0 if address == place else 0.6)
        for value, address in zip(plain, (2, 20, 23), strict=True)
    ]
    items = cells(*values)
    rows, _ = rows_of(items, "90.2 N")
    found, best = first_moved(alike(rows), watched(items, 5.0), watched(items, 8.0, 5.0))
    assert {one.decoding.address for one in best} == {place}
    by = {one.candidate.decoding.address: one.change for one in found}
    assert 5.5 < by[place] < 8.0


@pytest.mark.parametrize("by", [(0.0, 0.0), (6.0, 6.0), (6.0, 4.0)])
def test_nothing_that_moved_or_two_alike_decide_nothing(by: tuple[float, float]) -> None:
    plain = (ripple(90.0, 1.0), ripple(90.0, 0.8, 1.7))
    items = cells(*(pressed(value, push) for value, push in zip(plain, by, strict=True)))
    rows, _ = rows_of(items, "90.2 N")
    assert first_moved(alike(rows), watched(items, 5.0), watched(items, 8.0, 5.0))[1] == []


def test_what_comes_to_the_next_zone_with_the_web_moved_later() -> None:
    """A step of 20 N, which a zone of 3 s takes up by nine tenths while it is watched."""

    def step(t_s: float) -> float:
        return 20.0 if t_s >= 8.0 else 0.0

    def behind(t_s: float) -> float:
        return 20.0 * (1.0 - math.exp(-max(0.0, t_s - 8.0) / 3.0))

    first, second = ripple(90.0, 3.0), ripple(90.0, 2.0, 1.7)
    items = cells(lambda t_s: first(t_s) + step(t_s), lambda t_s: second(t_s) + behind(t_s))
    rows, _ = rows_of(items, "90.2 N")
    found, best = first_moved(alike(rows), watched(items, 5.0), watched(items, 10.0, 5.0))
    assert {one.decoding.address for one in best} == {2}
    later = {one.candidate.decoding.address: one.change for one in found}
    assert later[20] < 0.5 * later[2]


def test_one_bad_reading_is_no_movement() -> None:
    spike = ripple(90.0, 1.0)
    items = cells(lambda t_s: spike(t_s) + (6.0 if 8.0 <= t_s < 8.02 else 0.0))
    rows, _ = rows_of(items, "90.2 N")
    assert first_moved(alike(rows), watched(items, 5.0), watched(items, 8.0, 5.0))[1] == []


def test_a_word_that_moved_and_fits_nothing_is_named() -> None:
    """Word 31 is the low word of a count of 32 bits that goes through its end."""
    items = [*cells(ripple(90.0, 1.0)), Item(30, "i32", 1.0, pressed(still(65530.0), 40.0))]
    seen = watched(items, 5.0), watched(items, 8.0, 5.0)
    assert words_that_moved(*seen) == [31]
