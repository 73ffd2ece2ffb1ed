"""Single values of a site file's text replaced where they stand; every other byte stays."""

from __future__ import annotations

import re
from collections.abc import Mapping

from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.config.findings import KeyPath, dotted
from aff_runtime.config.yaml_marks import Mark, MarkedTree, Tree, parse_marked

LONGEST = 80  # characters of a value
_LINE_END = re.compile("(\r\n|[\n\r\x85\u2028\u2029])")  # what ends a line in YAML
_BYTE_ORDER = "\ufeff"
_PLAIN = re.compile(r"[\w.+-](?:[\w.+/ -]*[\w.+/-])?")  # a word, a number, a number with its unit
_LIST = re.compile(r"\[[\w.,+ -]*\]")  # on one line
_QUOTED = re.compile(r"\"[^\"\\]*\"|'[^']*'")
_FILE = "site.yaml"


class EditedText:
    """A text of a site file, and where each of its values stands.

    Parameters
    ----------
    text : a text that parses; errors as in `parse_marked`.
    """

    def __init__(self, text: str) -> None:
        self._order_mark = _BYTE_ORDER if text.startswith(_BYTE_ORDER) else ""
        self._lines = _LINE_END.split(text.removeprefix(_BYTE_ORDER))  # each, then what ends it
        self._tree = _parsed(text)

    def written(self, path: KeyPath) -> str | None:
        """Return what stands at a path, without its quotes; None where it cannot be replaced."""
        found = self._token(path)
        return found[1:-1] if found is not None and found[0] in "\"'" else found

    def with_values(self, values: Mapping[KeyPath, str]) -> str:
        """Return the text with other values in it.

        Raises
        ------
        ConfigError
            A value does not stand in the file itself, in one line.
        RefusedError
            What is to be written is no single value.
        """
        places = []
        for path, new in values.items():
            old = self._token(path)
            if old is None:
                raise ConfigError(f"{dotted(path)}: write it into the site file first")
            quote = old[0] if old[0] in "\"'" else ""
            mark = self._tree.marks[path]
            places.append((2 * (mark.line - 1), mark.column - 1, old, f"{quote}{new}{quote}"))
            _refuse_more_than_a_value(path, new, is_list=old[0] == "[")
        lines = list(self._lines)
        for line, column, old, new in sorted(places, reverse=True):
            lines[line] = lines[line][:column] + new + lines[line][column + len(old) :]
        text = self._order_mark + "".join(lines)
        self._refuse_other_changes(text, values)
        return text

    def _token(self, path: KeyPath) -> str | None:
        """Return what stands there, with its quotes; None for what is no value in one line."""
        mark = self._tree.marks.get(path)
        if mark is None or not self._is_own(path, mark):
            return None
        rest = self._lines[2 * (mark.line - 1)][mark.column - 1 :]
        for pattern in (_LIST, _QUOTED):
            if (found := pattern.match(rest)) is not None:
                is_it = pattern is _LIST or found[0][1:-1] == mark.written
                return found[0] if is_it else None
        return mark.written if mark.written and rest.startswith(mark.written) else None

    def _is_own(self, path: KeyPath, mark: Mark) -> bool:
        """Return whether it stands there for this path alone, not for an alias of it, too."""
        place = (mark.line, mark.column)
        there = [one for one, its in self._tree.marks.items() if (its.line, its.column) == place]
        return not any(one[: len(path)] != path and path[: len(one)] != one for one in there)

    def _refuse_other_changes(self, text: str, values: Mapping[KeyPath, str]) -> None:
        """Refuse a text that says something else beside the values that were to be changed."""
        before, after = dict(_flat(self._tree)), dict(_flat(_parsed(text)))
        for path in values:
            for found in (before, after):
                for below in [one for one in found if one[: len(path)] == path]:
                    del found[below]
        if before != after:
            raise RefusedError("this would change more than these values; edit the file itself")


def _refuse_more_than_a_value(path: KeyPath, new: str, *, is_list: bool) -> None:
    wanted = _LIST if is_list else _PLAIN
    if len(new) > LONGEST or wanted.fullmatch(new) is None:
        example = "a list such as [1, 2, 3]" if is_list else "one value, such as 5 or 10 ms"
        comma = "; a point, not a comma" if "," in new and not is_list else ""
        raise RefusedError(f"{dotted(path)}: {example} is needed{comma}")


def _parsed(text: str) -> MarkedTree:
    return parse_marked(text.encode("utf-8"), _FILE)


def _flat(tree: MarkedTree) -> list[tuple[KeyPath, object]]:
    """Return every value by its path; of a section or list its kind."""
    found: list[tuple[KeyPath, object]] = []

    def walk(value: Tree, path: KeyPath) -> None:
        if isinstance(value, dict):
            found.append((path, tuple(value)))
            for name, inner in value.items():
                walk(inner, (*path, name))
        elif isinstance(value, tuple):
            found.append((path, len(value)))
            for index, inner in enumerate(value):
                walk(inner, (*path, index))
        else:
            found.append((path, value))

    walk(tree.values, ())
    return found
