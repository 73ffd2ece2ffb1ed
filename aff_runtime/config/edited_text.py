"""Single values of a site file's text replaced or added; every other byte stays."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from functools import cached_property

from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.config.added_key import Insertion, insertion_of
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

    def can_add(self, path: KeyPath) -> bool:
        """Return whether a key that is not in the file can be written into it."""
        return self._insertion(path) is not None

    def with_values(self, values: Mapping[KeyPath, str]) -> str:
        """Return the text with other values in it; keys that are not in it are added.

        Raises
        ------
        ConfigError
            A value stands in the file, but not in one line, or has no place in it.
        RefusedError
            What is to be written is no single value.
        """
        standing = {path: new for path, new in values.items() if path in self._tree.marks}
        text = self._replaced(standing)
        for path in [one for one in values if one not in standing]:
            text = EditedText(text).with_key(path, values[path])
        return text

    def with_key(self, path: KeyPath, new: str) -> str:
        """Return the text with a key that it did not have; errors as in `with_values`."""
        insertion = self._insertion(path)
        if insertion is None:
            raise ConfigError(f"{dotted(path)}: write it into the site file first")
        _refuse_more_than_a_value(path, new, is_list=new.startswith("["))
        at, lines = 2 * (insertion.line - 1), list(self._lines)
        line_end = self._lines[1] if len(self._lines) > 1 else "\n"
        if insertion.column >= 0:
            line = lines[at]
            lines[at] = (
                line[: insertion.column] + insertion.text(new, "") + line[insertion.column :]
            )
        elif at >= len(lines) or (at == len(lines) - 1 and lines[at] == ""):
            ends = len(lines) > 1 and lines[-1] == ""
            lines.append(("" if ends else line_end) + insertion.text(new, line_end))
        else:
            lines[at] = insertion.text(new, line_end) + lines[at]
        text = self._order_mark + "".join(lines)
        self._refuse_other_changes(text, {path[: len(path) - len(insertion.names) + 1]: new})
        return text

    def _insertion(self, path: KeyPath) -> Insertion | None:
        if path in self._tree.marks:
            return None
        return insertion_of(self._tree, self._lines[::2], path, self._own)

    def _replaced(self, values: Mapping[KeyPath, str]) -> str:
        """Return the text with other values in place of those that stand in it."""
        edits = []
        for path, new in values.items():
            old = self._token(path)
            if old is None:
                raise ConfigError(f"{dotted(path)}: write it into the site file first")
            quote = old[0] if old[0] in "\"'" else ""
            mark = self._tree.marks[path]
            edits.append((2 * (mark.line - 1), mark.column - 1, old, f"{quote}{new}{quote}"))
            _refuse_more_than_a_value(path, new, is_list=old[0] == "[")
        lines = list(self._lines)
        for line, column, old, new in sorted(edits, reverse=True):
            lines[line] = lines[line][:column] + new + lines[line][column + len(old) :]
        text = self._order_mark + "".join(lines)
        self._refuse_other_changes(text, values)
        return text

    def _token(self, path: KeyPath) -> str | None:
        """Return what stands there, with its quotes; None for what is no value in one line."""
        mark = self._tree.marks.get(path)
        if mark is None or path not in self._own:
            return None
        rest = self._lines[2 * (mark.line - 1)][mark.column - 1 :]
        for pattern in (_LIST, _QUOTED):
            if (found := pattern.match(rest)) is not None:
                is_it = pattern is _LIST or found[0][1:-1] == mark.written
                return found[0] if is_it else None
        return mark.written if mark.written and rest.startswith(mark.written) else None

    @cached_property
    def _own(self) -> dict[KeyPath, Mark]:
        """The marks of what stands in its place for one path alone, not for an alias of it."""
        there: dict[tuple[int, int], list[KeyPath]] = {}
        for path, mark in self._tree.marks.items():
            there.setdefault((mark.line, mark.column), []).append(path)
        return {
            path: mark
            for path, mark in self._tree.marks.items()
            if all(
                one[: len(path)] == path or path[: len(one)] == one
                for one in there[mark.line, mark.column]
            )
        }

    def _refuse_other_changes(self, text: str, values: Mapping[KeyPath, str]) -> None:
        """Refuse a text that says something else beside the values that were to be changed."""
        before, after = _flat(self._tree, values), _flat(_parsed(text), values)
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


def _flat(tree: MarkedTree, but: Collection[KeyPath]) -> list[tuple[KeyPath, object]]:
    """Return every value by its path, but for some of them; of a section or list its kind."""
    found: list[tuple[KeyPath, object]] = []

    def walk(value: Tree, path: KeyPath) -> None:
        if path in but:
            return
        if isinstance(value, dict):
            found.append((path, tuple(name for name in value if (*path, name) not in but)))
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
