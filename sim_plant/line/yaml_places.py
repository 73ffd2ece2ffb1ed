"""YAML with places: where every key stands, and no key twice."""

from __future__ import annotations

from typing import Any

import yaml

Place = tuple[str | int, ...]


def read_places(text: str) -> tuple[Any, dict[Place, tuple[int, int]], list[str]]:
    """Return the data, the line and column (from 1) of every key, and repeated keys as findings.

    Raises
    ------
    yaml.YAMLError
        When the text is not YAML, a value is none (a 13th month), or nesting has no end.
    """
    loader = yaml.SafeLoader(text)
    try:
        root = loader.get_single_node()
        places: dict[Place, tuple[int, int]] = {}
        repeated: list[str] = []
        if root is None:
            return None, places, repeated
        _walk(root, (), places, repeated)
        return loader.construct_document(root), places, repeated
    except ValueError as error:  # of a date, or of a number that a tag asks for
        raise yaml.YAMLError(f"a value cannot be read ({error})") from error
    except RecursionError as error:
        raise yaml.YAMLError("is nested without end, or far too deep") from error
    finally:
        loader.dispose()


def _walk(
    node: yaml.Node, at: Place, places: dict[Place, tuple[int, int]], repeated: list[str]
) -> None:
    places.setdefault(at, (node.start_mark.line + 1, node.start_mark.column + 1))
    if isinstance(node, yaml.SequenceNode):
        for index, item in enumerate(node.value):
            _walk(item, (*at, index), places, repeated)
    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            place = (*at, str(key.value))
            line, column = key.start_mark.line + 1, key.start_mark.column + 1
            if place in places:
                first = places[place][0]
                repeated.append(
                    f"{line}:{column}: {'.'.join(map(str, place))}: is given twice, first in "
                    f"line {first}; keep one"
                )
            places[place] = (line, column)
            _walk(value, place, places, repeated)
