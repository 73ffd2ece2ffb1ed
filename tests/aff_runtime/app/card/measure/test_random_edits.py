"""A thousand random edits of commented site files: every byte outside the numbers stays."""

from __future__ import annotations

import random
from functools import reduce

import pytest
import yaml

from aff_runtime.app.card.measure.search import text_with
from aff_runtime.base.units import plain
from aff_runtime.config.yaml_marks import parse_marked
from tests.parameter_records import CONFIG

FILES = ("euclid.yaml", "euclid_blocks.yaml", "film.yaml", "euclid_can.yaml")
SEEDS, EDITS = 20, 50
SAID = (
    "settle_s: 6 was too slow", "'quoted' \"twice\"", "{ not: [a, flow }", "äöü ß 張力 \U0001f600",
    "# # #", "tab\there", "- dash: 12", "100 %, @, `backtick`, |", "", "a line\u2028# goes on",
    "another\x85# goes on", "and\u2029# on", "&anchor *alias !tag",
)  # fmt: skip


def commented(text: str, draw: random.Random) -> str:
    """Strew comments over a site file: lines of their own, and behind values."""
    lines = []
    for own in text.split("\n"):
        if draw.random() < 0.2:
            lines.append(" " * draw.randrange(9) + f"# {draw.choice(SAID)}")
        behind = " " * draw.choice((0, 0, 0, 3))
        if own.strip() and "#" not in own and draw.random() < 0.2:
            behind = " " * draw.randrange(1, 5) + f"# {draw.choice(SAID)}"
        lines.append(own + behind)
    whole = "\n".join(lines)
    if draw.random() < 0.3:
        whole = whole.replace("\n", "\r\n")
    return "\ufeff" + whole if draw.random() < 0.3 else whole


def taken_apart(text: str) -> tuple[list[str], list[str]]:
    """Return every value of a file and all that stands between, by another reader's indices."""
    mark = "\ufeff" if text.startswith("\ufeff") else ""
    text = text.removeprefix(mark)
    values, between, end = [], [], 0
    for token in yaml.scan(text, Loader=yaml.SafeLoader):
        if isinstance(token, yaml.ScalarToken):
            between.append(text[end : token.start_mark.index])
            end = token.end_mark.index
            values.append(text[token.start_mark.index : end])
    return values, [mark, *between, text[end:]]


def shown(value: float) -> str:
    """Return a number as a site file takes it: six digits, no exponent."""
    return plain(float(f"{value:.6g}"))


def number_places(text: str) -> list[tuple[str | int, ...]]:
    tree = parse_marked(text.encode("utf-8"), "site.yaml")
    return [
        path
        for path, mark in tree.marks.items()
        if path and mark.written.replace(".", "", 1).removeprefix("-").isdecimal()
    ]


@pytest.mark.sweep(every=20)
@pytest.mark.parametrize("seed", range(SEEDS))
def test_only_the_numbers_that_are_meant_change(seed: int) -> None:
    draw = random.Random(f"edits {seed}")
    text = commented((CONFIG / draw.choice(FILES)).read_text(encoding="utf-8"), draw)
    places = number_places(text)
    assert len(places) > 50
    values, between = taken_apart(text)
    for _ in range(EDITS):
        wanted = {
            path: draw.choice((draw.uniform(-9, 9), 10.0 ** draw.randrange(-6, 9), 0.0, 7.0))
            for path in draw.sample(places, draw.choice((1, 1, 2, 5)))
        }
        text = text_with(text, wanted)
        now, still_between = taken_apart(text)
        assert still_between == between
        changed = [n for n, (a, b) in enumerate(zip(values, now, strict=True)) if a != b]
        assert len(changed) <= len(wanted)
        assert {now[n] for n in changed} <= {shown(value) for value in wanted.values()}
        values = now
        tree = parse_marked(text.encode("utf-8"), "site.yaml")
        for path, value in wanted.items():
            assert tree.marks[path].written == shown(value)
            read = reduce(lambda part, key: part[key], path, tree.values)
            assert read == pytest.approx(value, rel=1e-5)
        if draw.random() < 0.05:
            places = number_places(text)
