"""A thousand random edits of commented site files: every byte outside the edited values stays."""

from __future__ import annotations

import random

import pytest
import yaml

from aff_runtime.config.edited_text import EditedText
from aff_runtime.config.findings import KeyPath
from tests.parameter_records import CONFIG

FILES = [path.name for path in sorted(CONFIG.glob("*.yaml"))]
ENDS = ("\n", "\r\n")
EDITS, AT_ONCE = 84, 42
"""Of each of the twelve texts."""
SAID = (
    "settle_s: 6 was too slow", "'quoted' \"twice\"", "{ not: [a, flow }", "äöü ß 張力 \U0001f600",
    "# # #", "tab\there", "- dash: 12", "100 %, @, `backtick`, |", "", "a line\u2028# goes on",
    "another\x85# goes on", "and\u2029# on", "&anchor *alias !tag",
)  # fmt: skip
WORDS = ("7", "-0.25", "1.0e-05", "0", "12 ms", "300 FPM", "rewind_2x", "on", "a.b-c", "x")


def commented(text: str, end: str, draw: random.Random) -> str:
    """Strew comments over a site file: lines of their own, and behind values."""
    lines = []
    for own in text.split("\n"):
        if draw.random() < 0.2:
            lines.append(" " * draw.randrange(9) + f"# {draw.choice(SAID)}")
        behind = " " * draw.choice((0, 0, 0, 3))
        if own.strip() and "#" not in own and draw.random() < 0.2:
            behind = " " * draw.randrange(1, 5) + f"# {draw.choice(SAID)}"
        lines.append(own + behind)
    whole = end.join(lines)
    return "\ufeff" + whole if draw.random() < 0.3 else whole


def places(text: str) -> dict[KeyPath, tuple[int, int]]:
    """Return where each value stands, a list of one line as a whole, by another reader's marks."""
    body = text.removeprefix("\ufeff")
    shift = len(text) - len(body)
    found: dict[KeyPath, tuple[int, int]] = {}

    def walk(node: yaml.Node, path: KeyPath) -> None:
        is_list = isinstance(node, yaml.SequenceNode) and node.flow_style
        if isinstance(node, yaml.ScalarNode) or (is_list and _is_plain(node)):
            found[path] = (node.start_mark.index + shift, node.end_mark.index + shift)
        elif isinstance(node, yaml.MappingNode):
            for key, value in node.value:
                walk(value, (*path, key.value))
        else:
            for number, value in enumerate(node.value):
                walk(value, (*path, number))

    walk(yaml.compose(body, Loader=yaml.CSafeLoader), ())
    return found


def _is_plain(node: yaml.SequenceNode) -> bool:
    is_short = node.start_mark.line == node.end_mark.line
    return is_short and all(isinstance(one, yaml.ScalarNode) for one in node.value)


def other_value(old: str, draw: random.Random) -> str:
    """Return another value, of a list another list."""
    if old.startswith("["):
        return f"[{', '.join(str(draw.randrange(1, 99)) for _ in range(draw.randrange(1, 6)))}]"
    return draw.choice((*WORDS, f"{draw.uniform(-9.0, 9.0):.6f}", str(draw.randrange(10**6))))


def edited_as_wanted(text: str, count: int, draw: random.Random) -> str:
    """Edit some values at once; return the text, which differs in their bytes alone."""
    where = places(text)
    values, wanted = {}, text
    for path in sorted(draw.sample(list(where), count), key=where.__getitem__, reverse=True):
        begin, end = where[path]
        old = text[begin:end]
        quote = old[0] if old[0] in "\"'" else ""
        values[path] = other_value(old, draw)
        wanted = f"{wanted[:begin]}{quote}{values[path]}{quote}{wanted[end:]}"
    edited = EditedText(text).with_values(values)
    assert edited.encode() == wanted.encode()
    return edited


@pytest.mark.parametrize("end", ENDS, ids=("lf", "crlf"))
@pytest.mark.parametrize("name", FILES)
def test_every_byte_outside_the_edited_values_stays(name: str, end: str) -> None:
    draw = random.Random(f"{name} {end!r}")
    text = commented((CONFIG / name).read_text(encoding="utf-8"), end, draw)
    for _ in range(EDITS // AT_ONCE):
        text = edited_as_wanted(text, AT_ONCE, draw)


# the test above has as many edits, some at once; here each is of the text that the last has left
@pytest.mark.long
@pytest.mark.parametrize("end", ENDS, ids=("lf", "crlf"))
@pytest.mark.parametrize("name", FILES)
def test_every_byte_stays_where_a_thousand_values_are_edited_one_by_one(
    name: str, end: str
) -> None:
    draw = random.Random(f"one by one {name} {end!r}")
    text = commented((CONFIG / name).read_text(encoding="utf-8"), end, draw)
    for _ in range(1000):
        text = edited_as_wanted(text, 1, draw)
