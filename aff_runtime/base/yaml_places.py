"""YAML as a bounded tree of nodes: the one place where a text that somebody sent is parsed.

The readers of site files and of line files make values of the nodes, and sentences of what they
refuse. What they have in common is here: depth, number and length of values are checked before
anything is made of a text, and every node and every fault has its place.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto
from typing import Any, TypeAlias

import yaml
from yaml.reader import ReaderError

Place: TypeAlias = "tuple[str | int, ...]"
"""Keys and indices from the root of a file to a value."""

SafeLoader: type[Any] = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_PARSERS_OWN_DEPTH = "maximum nesting"
"""In the message of a parser with a bound of its own (libyaml since 0.2.6), which reads ahead."""


class Fault(Enum):
    """What is wrong with a text."""

    SYNTAX = auto()
    CHARACTERS = auto()
    OTHER = auto()
    DEPTH = auto()
    COUNT = auto()
    LENGTH = auto()


@dataclass(frozen=True, slots=True, kw_only=True)
class Bounds:
    """What a text may hold at most.

    Attributes
    ----------
    depth : sections within sections.
    events : beginnings and ends of sections and values.
    characters : of one value; None: as many as the text has.
    """

    depth: int
    events: int
    characters: int | None = None


class YamlTextError(Exception):
    """A text is no YAML within its bounds.

    Attributes
    ----------
    fault : of which kind. ``problem`` : what the parser says, or the length of a value.
    place : line and column, from 1; None when the parser names none.
    """

    def __init__(self, fault: Fault, problem: str, place: tuple[int, int] | None) -> None:
        super().__init__(problem)
        self.fault = fault
        self.problem = problem
        self.place = place


def compose(text: str, bounds: Bounds) -> yaml.Node | None:
    """Return the root of a text's nodes, None for an empty text; no value is made yet.

    Aliases are not unfolded: who walks the nodes must bound that.

    Raises
    ------
    YamlTextError
        It is not YAML, or goes beyond ``bounds``.
    """
    try:
        _refuse_beyond(text, bounds)
        root: yaml.Node | None = yaml.compose(text, Loader=SafeLoader)
    except yaml.MarkedYAMLError as error:
        raise as_text_error(error) from error
    except ReaderError as error:
        before = text.encode()[: error.position].decode(errors="ignore")
        place = (before.count("\n") + 1, len(before) - before.rfind("\n"))
        raise YamlTextError(Fault.CHARACTERS, str(error.reason), place) from error
    except (yaml.YAMLError, ValueError) as error:
        raise YamlTextError(Fault.OTHER, str(error), None) from error
    return root


def as_text_error(error: yaml.MarkedYAMLError) -> YamlTextError:
    """Return what a parser or a maker of values has refused, with its place."""
    said = str(error.problem or error.context or "")
    return YamlTextError(Fault.SYNTAX, said, _from_one(error.problem_mark or error.context_mark))


def line_and_column(item: yaml.Node | yaml.Event) -> tuple[int, int]:
    """Return line and column of a node, from 1."""
    return _from_one(item.start_mark) or (1, 1)


def _from_one(mark: Any) -> tuple[int, int] | None:
    return None if mark is None else (mark.line + 1, mark.column + 1)


def _refuse_beyond(text: str, bounds: Bounds) -> None:
    """Refuse what exceeds the bounds, where it first does, even if a parser refuses it before."""
    try:
        _refuse_beyond_with(text, bounds, SafeLoader)
    except yaml.MarkedYAMLError as error:
        if _PARSERS_OWN_DEPTH not in str(error.problem):
            raise
        _refuse_beyond_with(text, bounds, yaml.SafeLoader)  # reads ahead by one key at most
        place = _from_one(error.problem_mark)
        raise YamlTextError(Fault.DEPTH, str(error.problem), place) from error


def _refuse_beyond_with(text: str, bounds: Bounds, loader: type[Any]) -> None:
    depth = 0
    for count, event in enumerate(yaml.parse(text, Loader=loader)):
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
        if isinstance(event, yaml.ScalarEvent) and bounds.characters is not None:
            length = len(event.value)
            if length > bounds.characters:
                raise YamlTextError(Fault.LENGTH, str(length), line_and_column(event))
        if depth > bounds.depth:
            raise YamlTextError(Fault.DEPTH, "", line_and_column(event))
        if count > bounds.events:
            raise YamlTextError(Fault.COUNT, "", line_and_column(event))
