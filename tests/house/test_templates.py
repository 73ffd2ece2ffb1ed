"""Templates: a browser keeps the first of two attributes of one name, and says nothing."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path

from tests.each_case import each_case

TEMPLATES = sorted((Path(__file__).parents[2] / "aff_hmi" / "templates").glob("*.html"))
_BLOCK = re.compile(r"({%.*?%})", re.DOTALL)
_VALUE = re.compile(r"{{.*?}}", re.DOTALL)


class Doubles(HTMLParser):
    """Attributes that one element has twice, as ``line: name``."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        names = [name for name, _ in attrs]
        line, _ = self.getpos()
        self.found += [f"{line}: {name}" for name in sorted(set(names)) if names.count(name) > 1]


def one_way(text: str, *, first: bool) -> str:
    """Return a template as one condition has it: the first way of every ``if``, or the last."""
    shown: list[bool] = []
    parts: list[str] = []
    for part in _BLOCK.split(text):
        word = part.removeprefix("{%").split()[0] if _BLOCK.fullmatch(part) else ""
        if word == "if":
            shown.append(first)
        elif word in ("elif", "else") and shown:
            shown[-1] = not first and word == "else"
        elif word == "endif":
            shown.pop()
        elif word == "for":
            shown.append(True)
        elif word == "endfor":
            shown.pop()
        elif not word and all(shown):
            parts.append(part)
    return _VALUE.sub("x", "".join(parts))


@each_case("first", [True, False])
@each_case("path", TEMPLATES, ids=lambda path: path.name)
def test_no_element_has_an_attribute_twice(path: Path, first: bool) -> None:
    assert Doubles(one_way(path.read_text(encoding="utf-8"), first=first)).found == []


def test_a_double_is_found_and_two_ways_of_one_condition_are_none() -> None:
    assert Doubles('<p a="1"\nb="2" a="3">').found == ["1: a"]
    ways = "<p {% if x %}a=\"{{ _('y') }}\"{% else %}a='2'{% endif %} b=''>"
    for first in (True, False):
        assert Doubles(one_way(ways, first=first)).found == []
    assert Doubles(one_way("<p {% if x %}a='1'{% endif %} a='2'>", first=True)).found == ["1: a"]
