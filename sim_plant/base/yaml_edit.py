"""Change keys of a YAML text; comments, order and spelling of all else stay the owner's.

ruamel's round trip keeps comments and order, but folds long texts anew and spells ``null`` its
own way. So the text is rendered twice, without and with the change, and of the second only what
differs from the first is taken over into the owner's own lines.
"""

from __future__ import annotations

import difflib
import io
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import yaml
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.constructor import RoundTripConstructor
from ruamel.yaml.error import YAMLError
from ruamel.yaml.nodes import ScalarNode
from ruamel.yaml.representer import RoundTripRepresenter
from ruamel.yaml.tokens import CommentToken
from ruamel.yaml.util import load_yaml_guess_indent

from aff_runtime.base.yaml_places import SafeLoader

WIDTH = 110
MOST_ALIKE = 2_000_000
"""Pairs of equal lines in a text; their number is what comparing it with another one costs. A
declaration of 600 lines has some thousands, 10 000 empty comments took 50 s."""


BYTE_ORDER = "\ufeff"
_COMMENT = re.compile(r"(?:^|(?<=\s))#[^\r\n]*", re.MULTILINE)
_END = re.compile(r"\r\n|\r|\n")


class SpelledFloat(float):
    """A number that is written as it was read: ruamel's own rounds its last digit."""

    text: str

    @classmethod
    def read(cls, constructor: RoundTripConstructor, node: ScalarNode) -> SpelledFloat:
        """Return the number of a node."""
        number = cls(constructor.construct_yaml_float(node))
        number.text = node.value
        return number

    @staticmethod
    def write(representer: RoundTripRepresenter, data: SpelledFloat) -> ScalarNode:
        """Return the node of a number."""
        return representer.represent_scalar("tag:yaml.org,2002:float", data.text)


class Constructor(RoundTripConstructor):
    """Reads numbers with their spelling."""


class Representer(RoundTripRepresenter):
    """Writes numbers as they are spelled."""


Constructor.add_constructor("tag:yaml.org,2002:float", SpelledFloat.read)
Representer.add_representer(SpelledFloat, SpelledFloat.write)


class RoundTrip(YAML):
    """Reader and writer of one text; ``short`` writes new lists of plain values on one line.

    ``anchors_too`` changes what has an anchor at its place, for all who name it.
    """

    short: bool = False
    anchors_too: bool = True


def with_keys(text: str, changes: Mapping[str, Any], *, short: bool = False) -> str:
    """Return a YAML mapping with these keys of its top level at these values.

    Values are plain (numbers, texts, lists, mappings). What a value has in common with the one
    that is there keeps its comments; new keys come last. Where ruamel cannot read a text that
    YAML 1.1 allows, or would render a comment into a value, or where too many lines are alike to
    compare them, values come first: comments are lost then, see `lost_comments`. ``short`` puts
    what is new and holds plain values only on one line, as in ``orders: [1, 2]``.
    """
    wanted = {**_values(text), **changes}
    mark = BYTE_ORDER if text.startswith(BYTE_ORDER) else ""
    own = _lines(text.removeprefix(BYTE_ORDER))
    for anchors_too in () if _is_too_alike(text) else (True, False):
        try:
            edited = mark + _edited(own, changes, short=short, anchors_too=anchors_too)
            if _values(edited) == wanted:
                return edited
        except (YAMLError, yaml.YAMLError):
            continue
    return yaml.safe_dump(wanted, sort_keys=False, width=WIDTH)


def lost_comments(before: str, after: str) -> list[str]:
    """Return the comments of a text that another one does not have, or not as often."""
    counts = [Counter(_COMMENT.findall(text)) for text in (before, after)]
    return list((counts[0] - counts[1]).elements())


def with_values(text: str, values: Mapping[tuple[str, ...], str | float]) -> str:
    """Return a YAML mapping with these values, each at its path of keys; all else as it is.

    Raises
    ------
    KeyError
        There is no mapping to put a value into; the path that was looked for.
    """
    data = _values(text)
    for path, value in values.items():
        place = value_at(data, path[:-1])
        if not isinstance(place, dict):
            raise KeyError(".".join(path[:-1]))
        place[path[-1]] = value
    return with_keys(text, {path[0]: data[path[0]] for path in values})


def value_at(data: Any, path: Sequence[str]) -> Any:
    """Return the value at a path of keys; None where there is none."""
    for key in path:
        data = data.get(key) if isinstance(data, Mapping) else None
    return data


def _values(text: str) -> Any:
    """Return the plain values of a text."""
    return yaml.load(text, Loader=SafeLoader)


def _is_too_alike(text: str) -> bool:
    return sum(count * count for count in Counter(text.splitlines()).values()) > MOST_ALIKE


def _edited(
    own: Sequence[str], changes: Mapping[str, Any], *, short: bool, anchors_too: bool
) -> str:
    """Return the owner's lines with those that the change makes other, each with its own end."""
    lines = [_END.sub("", line) + "\n" for line in own]
    text = "".join(lines)
    round_trip = _round_trip(text)
    round_trip.short, round_trip.anchors_too = short, anchors_too
    data = round_trip.load(text)
    before = _rendered(round_trip, data)
    for key, value in changes.items():
        if key in data:
            below = _taken_from_below(data, key)
            data[key] = _put(round_trip, data[key], value)
            if not value:
                data.ca.items.pop(key, None)  # what was said of its parts goes with them
            _put_below(data, key, below)
        else:
            _add(round_trip, data, key, value)
    after = _rendered(round_trip, data)
    ends = Counter(_END.findall("".join(own)))
    end = max(ends, key=lambda one: ends[one], default="\n")
    found = _spelled_as(own, lines, before, after, end)
    # a last line of the owner's without an end may not be the last one now
    return "".join(line if _END.search(line) else line + end for line in found[:-1]) + found[-1]


class _Unread:
    """Reads nothing: how a text indents is seen in its lines, its values cost a second reading."""

    def load(self, _text: str) -> None:
        """Return nothing."""


def _round_trip(text: str) -> RoundTrip:
    """Return a reader and writer that indents as ``text`` does."""
    _, indent, offset = load_yaml_guess_indent(text, yaml=_Unread())
    editor = RoundTrip()
    editor.Constructor, editor.Representer = Constructor, Representer
    editor.preserve_quotes = True
    editor.width = WIDTH
    editor.indent(mapping=2, sequence=indent or 2, offset=offset or 0)
    return editor


def _rendered(round_trip: RoundTrip, data: CommentedMap) -> list[str]:
    out = io.StringIO()
    round_trip.dump(data, out)
    return _lines(out.getvalue())


def _lines(text: str) -> list[str]:
    """Return the lines of a text, each with what ends it."""
    return [line for line in re.split(r"(?<=\n)|(?<=\r)(?!\n)", text) if line]


def _put(round_trip: RoundTrip, node: Any, value: Any) -> Any:
    """Return ``node`` with this value; parts that are as they were keep comments and spelling."""
    if isinstance(node, CommentedMap | CommentedSeq) and (
        not node or not value or (node.anchor.value and not round_trip.anchors_too)
    ):
        return _new(round_trip, value)  # an anchor's own value stays for those who name it
    if isinstance(node, CommentedMap) and isinstance(value, Mapping):
        return _put_mapping(round_trip, node, value)
    if isinstance(node, CommentedSeq) and isinstance(value, list):
        del node[len(value) :]
        for k, item in enumerate(node):
            _set(node, k, _put(round_trip, item, value[k]))
        if len(value) > len(node):
            below = _taken_from_below(node, len(node) - 1)
            node.extend(_new(round_trip, item) for item in value[len(node) :])
            _put_below(node, len(node) - 1, below)
        return node
    same = type(value) in (int, float, str) and not isinstance(node, bool) and node == value
    return node if same or node is value else _new(round_trip, value)


def _set(node: Any, key: Any, value: Any) -> None:
    """Put a value into a mapping or list, unless it is there: a merged one stays merged."""
    if node[key] is not value:
        node[key] = value


def _put_mapping(round_trip: RoundTrip, node: CommentedMap, value: Any) -> Any:
    """Return a mapping with these values; new keys come last, before the comments below."""
    for key in [key for key in node if key not in value]:
        del node[key]
    for key in node:
        _set(node, key, _put(round_trip, node[key], value[key]))
    fresh = {key: item for key, item in value.items() if key not in node}
    if not node:
        return _new(round_trip, value)
    if fresh:
        last = list(node)[-1]
        below = _taken_from_below(node, last)
        for key, item in fresh.items():
            _add(round_trip, node, key, item)
        _put_below(node, list(node)[-1], below)
    return node


def _add(round_trip: RoundTrip, node: CommentedMap, key: str, value: Any) -> None:
    """Put a new key into a mapping, the key spelled for YAML 1.1 too."""
    for spelled, item in _new(round_trip, {key: value}).items():
        node[spelled] = item


def _new(round_trip: RoundTrip, value: Any) -> Any:
    """Return a value spelled so that a reader of YAML 1.1 takes it for what it is: 1.0e-05."""
    style = None if round_trip.short else False
    text = yaml.safe_dump(value, sort_keys=False, width=WIDTH, default_flow_style=style)
    return round_trip.load(text)


def _end_of(data: CommentedMap | CommentedSeq, key: Any) -> tuple[Any, Any, int]:
    """Return where the last comment of a value hangs: node, its key or index, and the slot."""
    node: Any = data
    last: Any = key
    while isinstance(node[last], CommentedMap | CommentedSeq) and node[last]:
        if node[last].fa.flow_style():
            break  # what follows a value in braces hangs outside of them
        node = node[last]
        last = len(node) - 1 if isinstance(node, CommentedSeq) else list(node)[-1]
    return node, last, 0 if isinstance(node, CommentedSeq) else 2


def _taken_from_below(data: CommentedMap | CommentedSeq, key: Any) -> CommentToken | None:
    """Remove the comment lines below a value, if any, that are said of what follows.

    One on the value's own line stays, and so do those that stand further in than the keys of
    ``data``: they are said of the value.
    """
    node, last, slot = _end_of(data, key)
    token = (node.ca.items.get(last) or [None] * 4)[slot]
    same_line, _, below = token.value.partition("\n") if token is not None else ("", "", "")
    own, below = _own_lines(below, _column(data))
    if not below:
        return None
    if same_line or own:
        token.value = f"{same_line}\n{own}"
    else:
        node.ca.items[last][slot] = None
    return CommentToken(f"\n{below}", token.start_mark, None)


def _column(data: CommentedMap | CommentedSeq) -> int:
    """Return where the keys or dashes of a value stand; with an anchor it begins before them."""
    if not data.anchor.value or not data.lc.data:
        return data.lc.col or 0
    first = min(int(place[1]) for place in data.lc.data.values())
    return first if isinstance(data, CommentedMap) else first - len("- ")


def _own_lines(text: str, column: int) -> tuple[str, str]:
    """Return the first lines of comment that stand further in than ``column``, and the others."""
    lines = text.splitlines(keepends=True)
    own = 0
    for k, line in enumerate(lines):
        if line.strip() and len(line) - len(line.lstrip()) <= column:
            break
        own = k + 1 if line.strip() else own
    return "".join(lines[:own]), "".join(lines[own:])


def _put_below(data: CommentedMap | CommentedSeq, key: Any, below: CommentToken | None) -> None:
    """Hang lines of comment below a value."""
    if below is None:
        return
    node, last, slot = _end_of(data, key)
    slots = node.ca.items.setdefault(last, [None] * 4)
    if slots[slot] is None:
        slots[slot] = below
    else:
        slots[slot].value = slots[slot].value.rstrip("\n") + below.value


def _spelled_as(
    own: Sequence[str], plain: Sequence[str], before: Sequence[str], after: Sequence[str], end: str
) -> list[str]:
    """Return the lines of ``after``, those that ``before`` has too as ``own`` spells them.

    ``plain`` : the owner's with plain ends, as the others have them; ``end`` of a new line.
    """
    ends = {0: 0}  # line of before -> line of own
    for _, a1, a2, b1, b2 in _opcodes(before, plain):
        for k in range(a1, a2 + 1):
            ends[k] = b1 + k - a1 if a2 - a1 == b2 - b1 else (b1 if k < a2 else b2)
    lines: list[str] = []
    for tag, a1, a2, b1, b2 in _opcodes(before, after):
        new = [_END.sub(end, line) for line in after[b1:b2]]
        lines += own[ends[a1] : ends[a2]] if tag == "equal" else new
    return lines


def _opcodes(
    first: Sequence[str], second: Sequence[str]
) -> Sequence[tuple[str, int, int, int, int]]:
    return difflib.SequenceMatcher(None, first, second, autojunk=False).get_opcodes()
