"""Change keys of a YAML text; comments, order and spelling of all else stay the owner's.

ruamel's round trip keeps comments and order, but folds long texts anew and spells ``null`` its
own way. So the text is rendered twice, without and with the change, and of the second only what
differs from the first is taken over into the owner's own lines.
"""

from __future__ import annotations

import difflib
import io
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

WIDTH = 110


class SpelledFloat(float):
    """A number that is written as it was read: ruamel's own rounds its last digit."""

    text: str

    @classmethod
    def read(cls, constructor: RoundTripConstructor, node: ScalarNode) -> SpelledFloat:
        """Return the number of a node."""
        found = cls(constructor.construct_yaml_float(node))
        found.text = node.value
        return found

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


def with_keys(text: str, changes: Mapping[str, Any]) -> str:
    """Return a YAML mapping with these keys of its top level at these values.

    Values are plain (numbers, texts, lists, mappings). What a value has in common with the one
    that is there keeps its comments; new keys come last. Where ruamel cannot read a text that
    YAML 1.1 allows, or would render a comment into a value, values come first: the comments are
    lost then.
    """
    wanted = {**yaml.safe_load(text), **changes}
    try:
        found = _edited(text, changes)
        faithful = yaml.safe_load(found) == wanted
    except (YAMLError, yaml.YAMLError):
        faithful = False
    return found if faithful else yaml.safe_dump(wanted, sort_keys=False, width=WIDTH)


def _edited(text: str, changes: Mapping[str, Any]) -> str:
    """Return the owner's lines with those that the change makes other."""
    round_trip = _round_trip(text)
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
    return "".join(_spelled_as(text.splitlines(keepends=True), before, after))


def _round_trip(text: str) -> YAML:
    """Return a reader and writer that indents as ``text`` does."""
    _, indent, offset = load_yaml_guess_indent(text)
    found = YAML()
    found.Constructor, found.Representer = Constructor, Representer
    found.preserve_quotes = True
    found.width = WIDTH
    found.indent(mapping=2, sequence=indent or 2, offset=offset or 0)
    return found


def _rendered(round_trip: YAML, data: CommentedMap) -> list[str]:
    out = io.StringIO()
    round_trip.dump(data, out)
    return out.getvalue().splitlines(keepends=True)


def _put(round_trip: YAML, node: Any, value: Any) -> Any:
    """Return ``node`` with this value; parts that are as they were keep comments and spelling."""
    if isinstance(node, CommentedMap | CommentedSeq) and (
        node.anchor.value or not node or not value
    ):
        return _new(round_trip, value)  # what is named elsewhere too stays as it is there
    if isinstance(node, CommentedMap) and isinstance(value, Mapping):
        for key in [key for key in node if key not in value]:
            del node[key]
        for key, item in value.items():
            if key in node:
                node[key] = _put(round_trip, node[key], item)
            else:
                _add(round_trip, node, key, item)
        return node
    if isinstance(node, CommentedSeq) and isinstance(value, list):
        del node[len(value) :]
        for k, item in enumerate(value):
            if k < len(node):
                node[k] = _put(round_trip, node[k], item)
            else:
                node.append(_new(round_trip, item))
        return node
    same = type(value) in (int, float, str) and not isinstance(node, bool) and node == value
    return node if same else _new(round_trip, value)


def _add(round_trip: YAML, node: CommentedMap, key: str, value: Any) -> None:
    """Put a new key into a mapping, the key spelled for YAML 1.1 too."""
    for spelled, item in _new(round_trip, {key: value}).items():
        node[spelled] = item


def _new(round_trip: YAML, value: Any) -> Any:
    """Return a value spelled so that a reader of YAML 1.1 takes it for what it is: 1.0e-05."""
    return round_trip.load(yaml.safe_dump(value, sort_keys=False, width=WIDTH))


def _end_of(data: CommentedMap, key: str) -> tuple[Any, Any, int]:
    """Return where the last comment of a value hangs: node, its key or index, and the slot."""
    node: Any = data
    last: Any = key
    while isinstance(node[last], CommentedMap | CommentedSeq) and node[last]:
        node = node[last]
        last = len(node) - 1 if isinstance(node, CommentedSeq) else list(node)[-1]
    return node, last, 0 if isinstance(node, CommentedSeq) else 2


def _taken_from_below(data: CommentedMap, key: str) -> CommentToken | None:
    """Take the lines of comment below a value off it, if any; what is beside its end stays."""
    node, last, slot = _end_of(data, key)
    token = (node.ca.items.get(last) or [None] * 4)[slot]
    beside, _, below = token.value.partition("\n") if token is not None else ("", "", "")
    if not below:
        return None
    if beside:
        token.value = f"{beside}\n"
    else:
        node.ca.items[last][slot] = None
    return CommentToken(f"\n{below}", token.start_mark, None)


def _put_below(data: CommentedMap, key: str, below: CommentToken | None) -> None:
    """Hang lines of comment below a value."""
    if below is None:
        return
    node, last, slot = _end_of(data, key)
    slots = node.ca.items.setdefault(last, [None] * 4)
    if slots[slot] is None:
        slots[slot] = below
    else:
        slots[slot].value = slots[slot].value.rstrip("\n") + below.value


def _spelled_as(own: Sequence[str], before: Sequence[str], after: Sequence[str]) -> list[str]:
    """Return the lines of ``after``, those that ``before`` has too as ``own`` spells them."""
    ends = {0: 0}  # line of before -> line of own
    for _, a1, a2, b1, b2 in _opcodes(before, own):
        for k in range(a1, a2 + 1):
            ends[k] = b1 + k - a1 if a2 - a1 == b2 - b1 else (b1 if k < a2 else b2)
    found: list[str] = []
    for tag, a1, a2, b1, b2 in _opcodes(before, after):
        found += own[ends[a1] : ends[a2]] if tag == "equal" else after[b1:b2]
    return found


def _opcodes(
    first: Sequence[str], second: Sequence[str]
) -> Sequence[tuple[str, int, int, int, int]]:
    return difflib.SequenceMatcher(None, first, second, autojunk=False).get_opcodes()
