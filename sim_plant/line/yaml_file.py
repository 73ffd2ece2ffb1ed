"""YAML of line, record and map files: bounded, with places, and no key twice."""

from __future__ import annotations

from copy import deepcopy
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml

from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable
from aff_runtime.base.yaml_places import (
    Bounds,
    Fault,
    Place,
    SafeLoader,
    YamlTextError,
    as_text_error,
    compose,
    line_and_column,
)
from sim_plant.base.plain_file import read_plain_text

Places = dict[Place, tuple[int, int]]

LONGEST_BYTES = 1 << 20
"""A declaration of a whole line with tables of its rolls has some 10 kB."""
DEEPEST = 32
MOST_VALUES = 50_000
"""Keys and values, those that aliases repeat counted each time: they can double line by line."""
LONGEST_SCALAR = 20_000
"""Characters of one value."""
LONGEST_NUMBER = 100
"""Characters of a number; its cost grows with their square."""

_KEPT = 4
"""Texts of which what was parsed is kept."""

_NUMBERS = ("tag:yaml.org,2002:int", "tag:yaml.org,2002:float")
_BOUNDS = Bounds(depth=DEEPEST, events=2 * MOST_VALUES, characters=LONGEST_SCALAR)


class _Loader(SafeLoader):  # type: ignore[misc]
    """Knows which value it was about to make."""

    at: yaml.Node | None = None

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        self.at = node
        return super().construct_object(node, deep)


def load_yaml(path: Path) -> tuple[Any, Places]:
    """Return the data of a YAML file, and the line and column (from 1) of every key.

    Raises
    ------
    PlantError
        When it cannot be read, and as `parse_yaml`.
    """
    return parse_yaml(read_plain_text(path, LONGEST_BYTES), printable(str(path)))


def parse_yaml(text: str, file: str) -> tuple[Any, Places]:
    """Return the data of a YAML text, and the line and column (from 1) of every key.

    Raises
    ------
    PlantError
        With ``file``, line and column: it is not YAML, holds a value that is none (a 13th
        month), a key twice, or more than a person writes.
    """
    try:
        return _parsed(text)
    except _RefusedError as error:
        raise PlantError(
            "\n".join(f"{file}{where}: {said}" for where, said in error.found)
        ) from error
    except YamlTextError as error:
        where = "" if error.place is None else _colons(error.place)
        raise PlantError(f"{file}{where}: {_words(error)}") from error


class _RefusedError(Exception):
    """What is wrong with a text: places as ``:line:column``, and sentences."""

    def __init__(self, *found: tuple[str, str]) -> None:
        super().__init__(found)
        self.found = found


def _colons(place: tuple[int, int]) -> str:
    return f":{place[0]}:{place[1]}"


def _words(error: YamlTextError) -> str:
    """Return why a text was not taken."""
    match error.fault:
        case Fault.LENGTH:
            return f"a value has {error.problem} characters, more than {LONGEST_SCALAR}"
        case Fault.DEPTH:
            return f"is nested deeper than {DEEPEST} levels"
        case Fault.COUNT:
            return f"holds more than {MOST_VALUES} values"
    return f"not YAML: {printable(' '.join(error.problem.split()) or 'cannot be read', 200)}"


def _parsed(text: str) -> tuple[Any, Places]:
    data, places = _parsed_once(text)
    return deepcopy(data), dict(places)


@lru_cache(maxsize=_KEPT)
def _parsed_once(text: str) -> tuple[Any, Places]:
    """Return what `_parsed` gives copies of: a command reads its line file several times."""
    root = compose(text, _BOUNDS)
    if root is None:
        return None, {}
    loader = _Loader("")
    try:
        walk = _Walk()
        walk.visit(root, ())
        if walk.repeated:
            raise _RefusedError(*walk.repeated)
        return loader.construct_document(root), walk.places
    except yaml.MarkedYAMLError as error:  # a value that is none: a tag, a key that is a list
        raise as_text_error(error) from error
    except (ValueError, ArithmeticError, AttributeError, LookupError) as error:
        # of a date, or of a number, truth or stamp that a tag asks for
        where = "" if loader.at is None else _colons(line_and_column(loader.at))
        said = f"not YAML: a value cannot be read ({printable(str(error), 200)})"
        raise _RefusedError((where, said)) from error
    finally:
        loader.dispose()


class _Walk:
    """Every value as aliases unfold it: its place, and keys that stand twice."""

    def __init__(self) -> None:
        self.places: Places = {}
        self.repeated: list[tuple[str, str]] = []
        self._values = 0

    def visit(self, node: yaml.Node, at: Place) -> None:
        """Note a value and all below it."""
        self._values += 1
        if self._values > MOST_VALUES or len(at) > DEEPEST:
            said = "its aliases unfold to too much; write it out"
            raise _RefusedError((_colons(line_and_column(node)), said))
        if node.tag in _NUMBERS and len(node.value) > LONGEST_NUMBER:
            said = f"a number has {len(node.value)} characters, more than {LONGEST_NUMBER}"
            raise _RefusedError((_colons(line_and_column(node)), said))
        self.places.setdefault(at, line_and_column(node))
        if isinstance(node, yaml.SequenceNode):
            for index, item in enumerate(node.value):
                self.visit(item, (*at, index))
        if isinstance(node, yaml.MappingNode):
            for key, value in node.value:
                # a list as a key is refused later; its text would unfold aliases once more
                word = str(key.value) if isinstance(key, yaml.ScalarNode) else ""
                self._key(key, (*at, word))
                self.visit(key, (*at, word))
                self.visit(value, (*at, word))

    def _key(self, key: yaml.Node, place: Place) -> None:
        if place in self.places:
            said = printable(".".join(map(str, place)), 200)
            first = self.places[place][0]
            self.repeated.append(
                (
                    _colons(line_and_column(key)),
                    f"{said}: is given twice, first in line {first}; keep one",
                )
            )
        self.places[place] = line_and_column(key)
