"""The true register, decoding and scale of what a display shows is among the first."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aff_runtime.app.setup.words.candidates import Candidate, Observation, candidates
from aff_runtime.app.setup.words.decoding import Decoding
from aff_runtime.app.setup.words.display import shown_value
from aff_runtime.app.setup.words.floats import float_hints
from aff_runtime.base.units import to_si
from tests.aff_runtime.app.setup.virtual_words import Item, euclid, ripple, still, watched

ORDERS = ("high_first", "low_first")


def observed(items: list[Item], text: str, unit: str, start_s: float = 0.0) -> Observation:
    return Observation(shown=shown_value(text, unit), seen=watched(items, 2.0, start_s))


def as_shown(value_si: float, unit: str, digits: int) -> str:
    """Return a value as a display with so many digits shows it."""
    value = value_si / to_si(unit)[1]
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(value))))
    return f"{value:.{decimals}f} {unit}"


def same(candidate: Candidate, item: Item) -> bool:
    """Return whether a candidate reads an item: its words, its order, its scale."""
    wide = item.type.endswith("32")
    where = (candidate.decoding.address, candidate.decoding.type[1:], candidate.decoding.order)
    return where == (item.address, item.type[1:], item.order if wide else "") and math.isclose(
        candidate.scale, item.scale, rel_tol=1e-9
    )


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize(
    ("text", "unit", "moves", "place"),
    [
        ("20.2 lbf", "N", True, 2),
        ("90.00 N", "N", False, 4),
        ("7.80 in", "m", None, 6),
        ("198 mm", "m", None, 6),
        ("95.0 N", "N", True, 9),
    ],
)
def test_the_default_block_is_read_off_one_value_each(
    order: str, text: str, unit: str, moves: bool | None, place: int
) -> None:
    items = euclid(order)
    known = order if place > 2 else ""  # by the first quantity of two words
    one = observed(items, text, unit)
    best = candidates([one], unit, signed=unit != "m", moves=moves, word_order=known)[0]
    assert same(best, next(item for item in items if item.address == place))


def test_a_radius_that_shrinks_while_it_is_typed_goes_before_a_noisy_word_that_may_be_it() -> None:
    """164 um less a second; the display was read 2 s before the words."""
    place, shown_m, typed_s = 6, 0.16662, 2.0

    def shrunk(t_s: float) -> float:
        return shown_m - 164e-6 * (t_s + typed_s)

    noisy = Item(9, "i32", 0.001, ripple(92.9, 2.0, 3.1))  # its low word may show any radius
    radius = Item(place, "u16", 0.00002, shrunk)
    rest = [item for item in euclid() if item.address not in (place, 9)]
    one = observed([*rest, radius, noisy], "6.56 in", "m")
    known = frozenset({0, 2, 3, 4, 5})
    rows = candidates([one], "m", signed=False, moves=None, taken=known, word_order="high_first")
    assert same(rows[0], radius)


def test_two_words_with_one_speed_are_both_offered_first() -> None:
    rows = candidates([observed(euclid(), "200 FPM", "m/s")], "m/s", signed=True, moves=True)
    assert {one.decoding.address for one in rows[:2]} == {5, 7}


def test_a_taken_word_is_no_candidate_and_the_other_order_neither() -> None:
    rows = candidates(
        [observed(euclid(), "200 FPM", "m/s")],
        "m/s",
        signed=True,
        moves=True,
        taken=frozenset({7}),
        word_order="high_first",
    )
    assert rows[0].decoding == Decoding(address=5, type="i16")
    assert not any(7 in one.decoding.addresses for one in rows)
    assert {one.decoding.order for one in rows} <= {"", "high_first"}


def test_an_odd_scale_is_offered_as_it_follows_from_two_values() -> None:
    # 16384 counts are 750 rpm of a 0.2 m roll: 15.7 m/s
    scale = 15.707963 / 16384

    def items(speed: float) -> list[Item]:
        return [*euclid(), Item(40, "i16", scale, ripple(speed, 0.002))]

    moments = [observed(items(1.5), "1.500 m/s", "m/s"), observed(items(3.0), "3.000 m/s", "m/s")]
    best = candidates(moments, "m/s", signed=True, moves=True)[0]
    assert best.decoding == Decoding(address=40, type="i16")
    assert best.scale == pytest.approx(scale, rel=1e-3)
    assert not best.is_round


def test_a_device_that_counts_against_the_web_has_a_negative_scale() -> None:
    items = [Item(3, "i16", -0.001, ripple(1.016, 0.002))]
    best = candidates([observed(items, "200 FPM", "m/s")], "m/s", signed=True, moves=True)[0]
    assert (best.scale, best.scale_text) == (-0.001, "-0.001")


def test_a_float_is_named_and_not_offered() -> None:
    # 90.0 N is 0x42B40000 in IEEE 754
    items = [Item(3, "u16", 1.0, still(0x42B4)), Item(4, "u16", 1.0, still(0))]
    one = observed(items, "90.0 N", "N")
    (hint,) = float_hints(one.shown, one.seen, "N")
    assert "words 3 and 4 read 90 N as a float (high_first)" in hint


SCALES = st.sampled_from(
    [0.1, 0.01, 0.001, 0.0001, 0.02, 0.05, 0.2, 4.4482216152605 / 100, 4.4482216152605 / 10]
)
NOISE = st.lists(st.integers(0, 65535), min_size=4, max_size=24)


@settings(deadline=None, max_examples=50)
@given(
    address=st.integers(0, 20),
    kind=st.sampled_from(["i16", "u16", "i32", "u32"]),
    order=st.sampled_from(ORDERS),
    scale=SCALES,
    counts=st.tuples(st.integers(400, 8000), st.integers(9000, 30000)),
    others=NOISE,
    unit=st.sampled_from(["N", "lbf", "kgf"]),
    digits=st.integers(3, 4),
)
def test_of_two_values_the_true_reading_is_among_the_first_three(
    address: int,
    kind: str,
    order: str,
    scale: float,
    counts: tuple[int, int],
    others: list[int],
    unit: str,
    digits: int,
) -> None:
    moments = []
    item = Item(address, kind, scale, still(0.0), order)
    for place, mean in enumerate(counts):
        value = mean * scale
        item = Item(address, kind, scale, ripple(value, 0.004 * value), order)
        words = [Item(30 + n, "u16", 1.0, still(float(word))) for n, word in enumerate(others)]
        moments.append(observed([*words, item], as_shown(value, unit, digits), "N", 7.0 * place))
    rows = candidates(moments, "N", signed=kind.startswith("i"), moves=True)
    if kind.endswith("32"):  # a high word that is always 0 may as well be another's
        low = address + (1 if order == "high_first" else 0)
        narrow = Item(low, f"{kind[0]}16", scale, still(0.0))
        assert any(same(one, item) or same(one, narrow) for one in rows[:3])
    else:
        assert any(same(one, item) for one in rows[:3])
