"""Where a key that a site file leaves to its default would stand in the owner's text.

Below its `#key:` where the file has that line, else beside the other keys of its section. Only
lines are added: what the owner wrote, comments and all, stays as it is.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from aff_runtime.config.findings import KeyPath
from aff_runtime.config.yaml_marks import Mark, MarkedTree, Tree


@dataclass(frozen=True, slots=True, kw_only=True)
class Insertion:
    """Where a key would be written, and below which sections.

    Attributes
    ----------
    line : file line, from 1: the key gets a line of its own before it, or stands within it.
    column : within that line, from 0; -1 where the key gets a line of its own.
    indent : spaces before the key on a line of its own.
    names : the key; before it sections that do not stand in the file either.
    """

    line: int
    column: int
    indent: int
    names: tuple[str, ...]

    def text(self, value: str, line_end: str) -> str:
        """Return what is written there."""
        if self.column >= 0:
            text = value
            for name in reversed(self.names):
                text = f"{name}: {text}" if text is value else f"{name}: {{ {text} }}"
            return f"{text}, "
        *sections, name = self.names
        rows = [f"{' ' * (self.indent + 2 * n)}{one}:" for n, one in enumerate(sections)]
        rows.append(f"{' ' * (self.indent + 2 * len(sections))}{name}: {value}")
        return "".join(f"{row}{line_end}" for row in rows)


def insertion_of(
    tree: MarkedTree, lines: Sequence[str], path: KeyPath, own: Mapping[KeyPath, Mark]
) -> Insertion | None:
    """Return where a key that is not in the file would stand; None where nothing shows it.

    Parameters
    ----------
    lines : of the text, without what ends them.
    own : marks of what stands in the file for one path alone, and for no alias of it.
    """
    names, section = [str(path[-1])], path[:-1]
    while not isinstance(found := _at(tree.values, section), dict):
        if not section or section in tree.marks or isinstance(section[-1], int):
            return None
        names.insert(0, str(section[-1]))
        section = section[:-1]
    if section and section not in own:
        return None
    keys = [own[(*section, name)] for name in found if (*section, name) in own]
    if not keys:
        return None
    start = tree.marks[section]
    if lines[start.line - 1][start.column - 1 : start.column] == "{":
        first = keys[0]
        return Insertion(
            line=first.key_line, column=first.key_column - 1, indent=0, names=tuple(names)
        )
    indent = keys[0].key_column - 1
    above = start.key_line if section else 0
    line = _below_its_comment(lines, above, indent, names[0]) or _beside(lines, keys, indent)
    return Insertion(line=line, column=-1, indent=indent, names=tuple(names)) if line else None


def _below_its_comment(lines: Sequence[str], above: int, indent: int, name: str) -> int:
    """Return the line behind the section's ``#name:``; 0 where it has none.

    ``above`` : the line of the section's own key, from 1; 0 for the file itself.
    """
    wanted = re.compile(rf" {{{indent}}}#{re.escape(name)}:(\s|$)")
    for number, line in enumerate(lines[above:], above + 1):
        body = line.strip()
        if wanted.match(line):
            return number + 1
        if body and not body.startswith("#") and len(line) - len(line.lstrip()) < indent:
            is_first_of_item = number == above + 1 and body.startswith("- ")
            if not is_first_of_item:
                return 0
    return 0


def _beside(lines: Sequence[str], keys: Sequence[Mark], indent: int) -> int:
    """Return the line above the last key on a line of its own, and above what is said of it."""
    alone = [one.key_line for one in keys if not lines[one.key_line - 1][:indent].strip()]
    if not alone:
        return 0
    line = max(alone)
    while line > 1 and re.match(rf" {{{indent}}}#", lines[line - 2]):
        line -= 1
    return line


def _at(values: Tree, path: KeyPath) -> Tree:
    for part in path:
        if isinstance(values, dict) and isinstance(part, str):
            values = values.get(part)
        elif isinstance(values, tuple) and isinstance(part, int) and part < len(values):
            values = values[part]
        else:
            return None
    return values
