"""Lines of a site file as a screen shows and edits them, put back as the file has them.

A browser's field knows one end of a line, and shows no byte order mark: what the file has of these
stays in the file. Two people's edits of one text are put together line by line.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from difflib import SequenceMatcher
from typing import NamedTuple

from aff_runtime.app.commission.views.of_settings import Clash
from aff_runtime.base.printable import printable

ORDER_MARK = "\ufeff"
MOST_SAID = 20  # characters that do not show, of one text
_END = re.compile("(\r\n|[\n\r])")  # what a field of a browser takes for the end of a line


class NotShown(NamedTuple):
    """A character that does not show; line and column from 1."""

    line: int
    column: int
    text: str


class _Change(NamedTuple):
    """Lines ``low`` to ``high`` of the former text, for which ``first`` to ``last`` stand now.

    Lines count from 0; ``high`` and ``last`` are the lines behind the last ones.
    """

    low: int
    high: int
    is_mine: bool
    first: int
    last: int


def shown(text: str) -> str:
    """Return a file's text as a field shows it."""
    return _END.sub("\n", text.removeprefix(ORDER_MARK))


def as_in_file(file_text: str, typed: str) -> str:
    """Return a text of a field as the file would hold it.

    Lines that stand in the file keep their end; new ones get that of its first line.
    """
    mark = ORDER_MARK if file_text.startswith(ORDER_MARK) else ""
    parts = _END.split(file_text.removeprefix(ORDER_MARK))
    lines, ends = parts[::2], [*parts[1::2], ""]
    if set(ends) <= {"\n", ""}:
        return mark + typed
    new = typed.split("\n")
    new_ends = [ends[0]] * len(new)
    for block in SequenceMatcher(None, lines, new).get_matching_blocks():
        for at in range(block.size):
            new_ends[block.b + at] = ends[block.a + at] or ends[0]
    new_ends[-1] = ""
    return mark + "".join(line + end for line, end in zip(new, new_ends, strict=True))


def not_shown(file_text: str, typed: str) -> tuple[NotShown, ...]:
    """Return the characters of a text that do not show, but for lines that the file has so."""
    stand = set(shown(file_text).split("\n"))
    found: list[NotShown] = []
    for number, line in enumerate(typed.split("\n"), start=1):
        if line.isprintable() or line in stand:
            continue
        for column, char in enumerate(line, start=1):
            if not char.isprintable() and char != "\t":
                said = f"{printable(char)} stands here, which does not show. Remove it."
                found.append(NotShown(number, column, said))
                if len(found) >= MOST_SAID:
                    return tuple(found)
    return tuple(found)


def together(former: str, mine: str, theirs: str) -> tuple[str, tuple[Clash, ...]]:
    """Return two edits of a text in one, and where both have changed the same lines.

    In these mine stand. What both have put at one place stands there, theirs first; lines that
    both began or ended it with stand once.

    Parameters
    ----------
    former : the text that both began on.
    """
    old, my_lines, their_lines = former.split("\n"), mine.split("\n"), theirs.split("\n")
    changes = sorted([*_changes(old, my_lines, True), *_changes(old, their_lines, False)])
    lines: list[str] = []
    clashes: list[Clash] = []
    at = 0
    for group in _groups(changes):
        low, high = min(one.low for one in group), max(one.high for one in group)
        lines += old[at:low]
        at = high
        sides = [
            _side(group, side, is_mine=is_mine, low=low, high=high)
            for is_mine, side in ((False, their_lines), (True, my_lines))
        ]
        said = [side for side in sides if side is not None]
        if len(said) == 1 or said[0] == said[1]:
            lines += said[0]
        elif low == high:
            lines += _once(said[0], said[1], len(lines), clashes)
        else:
            clashes.append(Clash(line=len(lines) + 1, theirs=tuple(said[0])))
            lines += said[1]
    return "\n".join([*lines, *old[at:]]), tuple(clashes)


def _changes(old: Sequence[str], new: Sequence[str], is_mine: bool) -> list[_Change]:
    codes = SequenceMatcher(None, old, new).get_opcodes()
    return [_Change(a, b, is_mine, c, d) for tag, a, b, c, d in codes if tag != "equal"]


def _groups(changes: Sequence[_Change]) -> list[list[_Change]]:
    """Return changes in groups, of which each stands for itself."""
    groups: list[list[_Change]] = []
    high = -1
    for one in changes:
        if groups and (one.low < high or any(_meet(one, other) for other in groups[-1])):
            groups[-1].append(one)
            high = max(high, one.high)
        else:
            groups.append([one])
            high = one.high
    return groups


def _meet(one: _Change, other: _Change) -> bool:
    """Return whether lines are put where the other side has put some, or has taken some away.

    At an end of what is taken away they would stand in another section, with nobody told.
    """
    if one.is_mine is other.is_mine or min(one.high, other.high) < max(one.low, other.low):
        return False
    into, where = (one, other) if one.low == one.high else (other, one)
    if into.low != into.high:
        return False
    is_less = where.last - where.first < where.high - where.low
    return where.low == where.high or is_less


def _once(
    theirs: Sequence[str], mine: Sequence[str], before: int, clashes: list[Clash]
) -> list[str]:
    """Return what two people have put at one place, first and last lines of both once.

    Where both began or end alike and something differs in between, that is a clash.
    """
    most = min(len(theirs), len(mine))
    first = next((n for n in range(most) if theirs[n] != mine[n]), most)
    rest = most - first
    last = next((n for n in range(rest) if theirs[-1 - n] != mine[-1 - n]), rest)
    other, own = theirs[first : len(theirs) - last], mine[first : len(mine) - last]
    if not first and not last:
        return [*theirs, *mine]
    if other and own:
        clashes.append(Clash(line=before + first + 1, theirs=tuple(other)))
        other = ()
    return [*mine[:first], *other, *own, *mine[len(mine) - last :]]


def _side(
    group: Sequence[_Change], lines: Sequence[str], *, is_mine: bool, low: int, high: int
) -> list[str] | None:
    """Return what one side has for the lines of a group; None where it has changed none."""
    own = [one for one in group if one.is_mine is is_mine]
    if not own:
        return None
    first = own[0].first - (own[0].low - low)
    last = own[-1].last + (high - own[-1].high)
    return list(lines[first:last])
