"""Lines of a site file in a field of a browser: put back as they were, and two edits in one."""

from __future__ import annotations

import random

import pytest

from aff_runtime.app.commission.settings.site_lines import (
    Clash,
    NotShown,
    as_in_file,
    not_shown,
    shown,
    together,
)
from tests.each_case import each_case

MIXED = "\ufeffa: 1\r\nb: 2\nc: 3\rd: 4\r\n"
OLD = "a\nb\nc\nd\ne\n"


@each_case("text", [MIXED, "a: 1\n", "a: 1", "a: 1\r\nb: 2", "\ufeffa: 1\n\n", ""])
def test_what_is_not_edited_comes_back_byte_for_byte(text: str) -> None:
    assert "\r" not in shown(text)
    assert "\ufeff" not in shown(text)
    assert as_in_file(text, shown(text)) == text


def test_lines_keep_their_ends_and_new_ones_get_that_of_the_first() -> None:
    typed = shown(MIXED).replace("b: 2\n", "b: 2\nx: 9\n").replace("d: 4", "d: 5")
    assert as_in_file(MIXED, typed) == "\ufeffa: 1\r\nb: 2\nx: 9\r\nc: 3\rd: 5\r\n"


def test_a_character_that_does_not_show_is_named_by_its_place_but_not_one_of_the_file() -> None:
    typed = "a: 1\nb: 2\u00a0 s\n\tc: 3\nd\x00: \u202e4\n"
    assert not_shown("a: 1\n", typed) == (
        NotShown(2, 5, r"\xa0 stands here, which does not show. Remove it."),
        NotShown(4, 2, r"\x00 stands here, which does not show. Remove it."),
        NotShown(4, 5, r"\u202e stands here, which does not show. Remove it."),
    )
    assert not_shown("b: 2\u00a0 s\r\n", typed)[0].line == 4
    assert len(not_shown("", "\x00" * 10**5)) == 20


@each_case(
    ("mine", "theirs", "both"),
    [
        ("a\nB\nc\nd\ne\n", "a\nb\nc\nD\ne\n", "a\nB\nc\nD\ne\n"),
        ("a\nB\nc\nd\ne\n", "a\nb\nC\nd\ne\n", "a\nB\nC\nd\ne\n"),  # beside one another
        ("a\nb\nc\nd\ne\nmine\n", "theirs\na\nb\nc\nd\ne\n", "theirs\na\nb\nc\nd\ne\nmine\n"),
        ("a\nb\nmine\nc\nd\ne\n", "a\nb\ntheirs\nc\nd\ne\n", "a\nb\ntheirs\nmine\nc\nd\ne\n"),
        ("a\nsame\nc\nd\ne\n", "a\nsame\nc\nd\ne\n", "a\nsame\nc\nd\ne\n"),
        ("a\nc\nd\ne\n", "a\nb\nc\nd\nE\n", "a\nc\nd\nE\n"),
        (OLD, "a\n", "a\n"),
    ],
)
def test_two_edits_are_put_together_line_by_line(mine: str, theirs: str, both: str) -> None:
    assert together(OLD, mine, theirs) == (both, ())


def test_where_both_changed_the_same_lines_mine_stand_and_theirs_are_told() -> None:
    found = together(OLD, "a\nmine\nc\nd\nE\n", "a\ntheirs\nmore\nd\ne\n")
    assert found == ("a\nmine\nc\nd\nE\n", (Clash(line=2, theirs=("theirs", "more")),))
    kept = together(OLD, "a\nb\nc\nd\ne2\n", "a\n")  # they deleted where we wrote
    assert kept == ("a\nb\nc\nd\ne2\n", (Clash(line=2, theirs=()),))


@pytest.mark.parametrize(
    ("mine", "theirs", "stands", "clash"),
    [
        ("a\nb\nc\nmine\nd\ne\n", "a\nd\ne\n", "a\nb\nc\nmine\nd\ne\n", Clash(line=2, theirs=())),
        ("a\nmine\nb\nc\nd\ne\n", "a\nd\ne\n", "a\nmine\nb\nc\nd\ne\n", Clash(line=2, theirs=())),
        (
            "a\nd\ne\n",
            "a\nb\nc\ntheirs\nd\ne\n",
            "a\nd\ne\n",
            Clash(line=2, theirs=("b", "c", "theirs")),
        ),
    ],
)
def test_lines_at_an_end_of_what_the_other_has_taken_away_are_a_clash(
    mine: str, theirs: str, stands: str, clash: Clash
) -> None:
    assert together(OLD, mine, theirs) == (stands, (clash,))


@each_case(
    ("mine", "theirs", "both", "clashes"),
    [
        ("a\nx\ny\nb\n", "a\nx\nb\n", "a\nx\ny\nb\n", ()),
        ("a\nx\nb\n", "a\nx\ny\nb\n", "a\nx\ny\nb\n", ()),
        ("a\nx\nm\ny\nb\n", "a\nx\nt\ny\nb\n", "a\nx\nm\ny\nb\n", (Clash(line=3, theirs=("t",)),)),
        ("a\nm\ny\nb\n", "a\nt\ny\nb\n", "a\nm\ny\nb\n", (Clash(line=2, theirs=("t",)),)),
        ("a\nx\nx\nb\n", "a\nx\nb\n", "a\nx\nx\nb\n", ()),
        ("a\nm\nb\n", "a\nt\nb\n", "a\nt\nm\nb\n", ()),
    ],
)
def test_what_both_have_put_at_one_place_stands_once(
    mine: str, theirs: str, both: str, clashes: tuple[Clash, ...]
) -> None:
    assert together("a\nb\n", mine, theirs) == (both, clashes)


def test_of_one_edit_alone_nothing_is_lost_and_two_far_apart_are_both_in_it() -> None:
    draw = random.Random(7)
    for _ in range(300):
        old = [f"{n}" for n in range(draw.randrange(8, 20))]
        half = len(old) // 2
        mine, theirs = list(old), list(old)
        for lines, places in ((mine, range(half - 1)), (theirs, range(half + 1, len(old)))):
            for place in sorted(draw.sample(places, 2), reverse=True):
                match draw.randrange(3):
                    case 0:
                        del lines[place]
                    case 1:
                        lines[place] = f"x{draw.random()}"
                    case _:
                        lines.insert(place, f"x{draw.random()}")
        # the half that each has left alone stands as the other has it
        wanted = [*mine[: mine.index(str(half))], *theirs[theirs.index(str(half)) :]]
        texts = ("\n".join(lines) for lines in (old, mine, theirs))
        assert together(*texts) == ("\n".join(wanted), ())
        one, other = "\n".join(old), "\n".join(mine)
        assert together(one, other, one) == together(one, one, other) == (other, ())
