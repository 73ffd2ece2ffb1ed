"""Foreign text in a log or on a terminal: one line, nothing that acts."""

from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.base.printable import printable
from tests.drawn_text import drawn_text
from tests.each_case import each_case


@each_case(
    ("text", "shown"),
    [
        ("Bahnspannung [µm] °", "Bahnspannung [µm] °"),
        ("a\nINFO OPERATOR: arm", "a\\nINFO OPERATOR: arm"),
        ("a\r\tb", "a\\r\\tb"),
        ("\x1b[2J\x07", "\\x1b[2J\\x07"),
        ("\u202eabc\u2028", "\\u202eabc\\u2028"),
        ("\u200b\ufeff\x00\x9b", "\\u200b\\ufeff\\x00\\x9b"),
        ("\udc80", "\\udc80"),
        ("a\\nb", "a\\nb"),
    ],
)
def test_characters_that_act_are_escaped_and_others_are_kept(text: str, shown: str) -> None:
    assert printable(text) == shown


@given(drawn_text(), st.none() | st.integers(0, 30))
def test_it_is_printable_no_longer_than_asked_and_the_same_when_done_twice(
    text: str, longest: int | None
) -> None:
    once = printable(text, longest)
    assert once.isprintable()
    assert once.isascii() or set(once) - set(map(chr, range(128))) <= set(text)
    assert printable(once, longest) == once
    assert longest is None or len(once) <= longest


def test_a_long_text_ends_in_dots() -> None:
    assert printable("x" * 50, 10) == "xxxxxxx..."
    assert printable("x" * 10, 10) == "x" * 10
    assert printable("\n" * 9, 10) == "\\n\\n\\n\\..."
