"""Plain values of an entry with their types asked for; what is none is named with its place."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeVar

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.printable import printable

LONGEST_TEXT = 4_000
MOST_ITEMS = 2_000
Item = TypeVar("Item")


class Fields:
    """The members of one JSON object.

    Parameters
    ----------
    said : plain values. ``place`` : where they stand in the card, for messages.

    Raises
    ------
    ConfigError
        They are no object. Every method raises it for a value of another type.
    """

    def __init__(self, said: Any, place: str) -> None:
        if not isinstance(said, dict):
            raise ConfigError(f"{place}: read {_kind(said)}, expected an object; no card of ours")
        self._said = said
        self._place = place

    def text(self, name: str) -> str:
        """Return a text; one that is not there is empty."""
        value = self._said.get(name, "")
        if not isinstance(value, str) or len(value) > LONGEST_TEXT:
            raise self._refusal(name, value, f"a text of at most {LONGEST_TEXT} characters")
        return printable(value)

    def whole(self, name: str) -> int:
        """Return a whole number from 0 on."""
        value = self._said.get(name)
        if isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 1 << 53:
            return value
        raise self._refusal(name, value, "a whole number")

    def number(self, name: str) -> float:
        """Return a number; null, or one that is not there, is NaN."""
        return self._number(name, self._said.get(name))

    def flag(self, name: str) -> bool | None:
        """Return true, false or null."""
        value = self._said.get(name)
        if value is not None and not isinstance(value, bool):
            raise self._refusal(name, value, "true, false or null")
        return value

    def texts(self, name: str) -> tuple[str, ...]:
        """Return a list of texts."""
        items = self._items(name)
        return tuple(Fields({"": item}, f"{self._place}.{name}").text("") for item in items)

    def numbers(self, name: str) -> tuple[float, ...]:
        """Return a list of numbers."""
        return tuple(self._number(name, item) for item in self._items(name))

    def table(self, name: str) -> tuple[tuple[float, ...], ...]:
        """Return rows of numbers."""
        rows = self._items(name)
        place = f"{self._place}.{name}"
        return tuple(Fields({"": row}, f"{place}[{k}]").numbers("") for k, row in enumerate(rows))

    def named(self, name: str) -> dict[str, str]:
        """Return texts by name."""
        value = self._said.get(name, {})
        inner = Fields(value, f"{self._place}.{name}")
        if len(value) > MOST_ITEMS:
            raise self._refusal(name, value, f"at most {MOST_ITEMS} members")
        return {printable(key): inner.text(key) for key in value}

    def each(self, name: str, read: Callable[[Fields], Item]) -> tuple[Item, ...]:
        """Return what ``read`` makes of every object of a list."""
        return tuple(
            read(Fields(item, f"{self._place}.{name}[{k}]"))
            for k, item in enumerate(self._items(name))
        )

    def inner(self, name: str) -> Fields:
        """Return the object that lies in this one."""
        return Fields(self._said.get(name), f"{self._place}.{name}")

    def _items(self, name: str) -> list[Any]:
        value = self._said.get(name, [])
        if not isinstance(value, list) or len(value) > MOST_ITEMS:
            raise self._refusal(name, value, f"a list of at most {MOST_ITEMS}")
        return list(value)

    def _number(self, name: str, value: Any) -> float:
        if value is None:
            return math.nan
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self._refusal(name, value, "a number or null")
        try:
            return float(value)
        except OverflowError:
            beyond = "a number beyond all floats"
            raise self._refusal(name, beyond, "a number or null") from None

    def _refusal(self, name: str, value: Any, expected: str) -> ConfigError:
        return ConfigError(
            f"{self._place}.{name}: read {_kind(value)}, expected {expected}; it was written by "
            "another release, or by something else"
        )


def plain(number: float) -> float | None:
    """Return a number for JSON: what is none is null."""
    return number if math.isfinite(number) else None


def _kind(value: Any) -> str:
    if isinstance(value, str):
        return f"the text {printable(value, 40)!r}"
    if isinstance(value, dict):
        return "an object"
    return "a list" if isinstance(value, list) else printable(repr(value), 40)
