"""How many characters a pattern looks at until it knows: Python's own search, counted."""

from __future__ import annotations

import re._constants as op
import re._parser as parser
from collections.abc import Callable
from typing import Any

Then = Callable[[int], bool]


class TooManyError(Exception):
    """More steps than were allowed."""


class Steps:
    """Searches as `re` does, one way after another, and counts.

    Parameters
    ----------
    most : of the steps; one more is an error.
    """

    def __init__(self, most: int) -> None:
        self.count = 0
        self._most = most

    def fullmatch(self, pattern: str, text: str) -> bool:
        """Return whether a pattern is of the whole text."""
        return self._all(list(parser.parse(pattern)), 0, text, 0, lambda at: at == len(text))

    def _all(self, nodes: list[Any], first: int, text: str, at: int, then: Then) -> bool:
        if first == len(nodes):
            return then(at)
        kind, what = nodes[first]

        def rest(end: int) -> bool:
            return self._all(nodes, first + 1, text, end, then)

        if kind is op.SUBPATTERN:
            return self._all(list(what[3]), 0, text, at, rest)
        if kind is op.ASSERT_NOT:
            return not self._all(list(what[1]), 0, text, at, lambda _: True) and rest(at)
        if kind is op.BRANCH:
            return any(self._all(list(one), 0, text, at, rest) for one in what[1])
        if kind in (op.MIN_REPEAT, op.MAX_REPEAT):
            return self._repeat(kind is op.MAX_REPEAT, what, text, at, rest)
        return self._is_one(kind, what, text, at) and rest(at + 1)

    def _repeat(self, is_greedy: bool, what: Any, text: str, at: int, rest: Then) -> bool:
        """Try each count; what is repeated is always one character wide."""
        least, most, body = what
        nodes = list(body)
        counts = []
        for count in range(most + 1 if most is not op.MAXREPEAT else len(text) + 2):
            if count >= least:
                if not is_greedy and rest(at + count):
                    return True
                counts.append(count)
            if not self._all(nodes, 0, text, at + count, lambda _: True):
                break
        return is_greedy and any(rest(at + count) for count in reversed(counts))

    def _is_one(self, kind: Any, what: Any, text: str, at: int) -> bool:
        self.count += 1
        if self.count > self._most:
            raise TooManyError
        if at >= len(text):
            return False
        one = text[at]
        if kind is op.LITERAL:
            return ord(one) == what
        if kind is op.NOT_LITERAL:
            return ord(one) != what
        if kind is op.ANY:
            return one != "\n"
        assert kind is op.IN, kind
        return _is_in(what, one)


def _is_in(kinds: Any, one: str) -> bool:
    """Return whether a character is of a set."""
    is_not = bool(kinds) and kinds[0][0] is op.NEGATE
    for kind, what in kinds[1:] if is_not else kinds:
        if kind is op.LITERAL and ord(one) == what:
            return not is_not
        if kind is op.RANGE and what[0] <= ord(one) <= what[1]:
            return not is_not
        if kind is op.CATEGORY and CATEGORIES[what](one):
            return not is_not
    return is_not


CATEGORIES: dict[Any, Callable[[str], bool]] = {
    op.CATEGORY_DIGIT: str.isdecimal,
    op.CATEGORY_SPACE: str.isspace,
    op.CATEGORY_NOT_SPACE: lambda one: not one.isspace(),
}
