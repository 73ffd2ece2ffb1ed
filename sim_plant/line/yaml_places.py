"""YAML of line, record and map files: bounded, with places, and no key twice."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml
from yaml.reader import ReaderError

from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable
from sim_plant.base.plain_file import read_plain_text

Place = tuple[str | int, ...]
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

_NUMBERS = ("tag:yaml.org,2002:int", "tag:yaml.org,2002:float")
_SafeLoader: type[Any] = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class _Loader(_SafeLoader):  # type: ignore[misc]
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
        _refuse_depth(text)
        return _parsed(text)
    except _RefusedError as error:
        raise PlantError(
            "\n".join(f"{file}{where}: {said}" for where, said in error.found)
        ) from error
    except yaml.MarkedYAMLError as error:
        where = _colons(error.problem_mark or error.context_mark)
        said = printable(error.problem or error.context or "cannot be read", 200)
        raise PlantError(f"{file}{where}: not YAML: {said}") from error
    except ReaderError as error:
        before = text.encode()[: error.position].decode(errors="ignore")
        line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
        said = f"not YAML: {error.reason}"
        raise PlantError(f"{file}:{line}:{column}: {printable(said, 200)}") from error
    except yaml.YAMLError as error:
        said = printable(" ".join(str(error).split()), 200)
        raise PlantError(f"{file}: not YAML: {said}") from error


class _RefusedError(Exception):
    """What is wrong with a text: places as ``:line:column``, and sentences."""

    def __init__(self, *found: tuple[str, str]) -> None:
        super().__init__(found)
        self.found = found


def _colons(mark: Any) -> str:
    return "" if mark is None else f":{mark.line + 1}:{mark.column + 1}"


def _refuse_depth(text: str) -> None:
    """Go through a text without making anything of it: depth, number and length of its values."""
    depth = 0
    for count, event in enumerate(yaml.parse(text, Loader=_SafeLoader)):
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
        said = ""
        if isinstance(event, yaml.ScalarEvent) and len(event.value) > LONGEST_SCALAR:
            said = f"a value has {len(event.value)} characters, more than {LONGEST_SCALAR}"
        elif depth > DEEPEST:
            said = f"is nested deeper than {DEEPEST} levels"
        elif count > 2 * MOST_VALUES:
            said = f"holds more than {MOST_VALUES} values"
        if said:
            raise _RefusedError((_colons(event.start_mark), said))


def _parsed(text: str) -> tuple[Any, Places]:
    loader = _Loader(text)
    try:
        root = loader.get_single_node()
        if root is None:
            return None, {}
        walk = _Walk()
        walk.visit(root, ())
        if walk.repeated:
            raise _RefusedError(*walk.repeated)
        return loader.construct_document(root), walk.places
    except (ValueError, OverflowError) as error:  # of a date, or of a number a tag asks for
        where = "" if loader.at is None else _colons(loader.at.start_mark)
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
            raise _RefusedError((_colons(node.start_mark), said))
        if node.tag in _NUMBERS and len(node.value) > LONGEST_NUMBER:
            said = f"a number has {len(node.value)} characters, more than {LONGEST_NUMBER}"
            raise _RefusedError((_colons(node.start_mark), said))
        self.places.setdefault(at, _place_of(node))
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
                    _colons(key.start_mark),
                    f"{said}: is given twice, first in line {first}; keep one",
                )
            )
        self.places[place] = _place_of(key)


def _place_of(node: yaml.Node) -> tuple[int, int]:
    mark = node.start_mark
    return (1, 1) if mark is None else (mark.line + 1, mark.column + 1)
