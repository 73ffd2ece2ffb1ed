"""What a person typed for a step on the command line: ``name=value unit``."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

from aff_runtime.app.card.entries import Typed
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.printable import printable
from aff_runtime.base.units import to_si, unit_info

LONGEST = 200  # characters of a value
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,63}")
_NUMBER = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)")
_COMMA = re.compile(r"([-+]?\d+),(\d+.*)")
HAS_COMMA = "has a decimal comma"
_DECIBEL = "dB"


class NotTypedError(ConfigError):
    """A step cannot be measured before somebody types what only a person knows."""


class TypedValues:
    """What was typed for one step, by name."""

    def __init__(self, values: Iterable[Typed]) -> None:
        self._values = {value.name: value for value in values}

    @property
    def names(self) -> tuple[str, ...]:
        """Names in the order in which they were typed."""
        return tuple(self._values)

    def number(self, name: str, unit: str) -> float:
        """Return a number in an SI unit (or dB, or none), NaN where it was not typed.

        Raises
        ------
        ConfigError
            It is no number, or has another unit.
        """
        typed = self._values.get(name)
        if typed is None:
            return math.nan
        if (comma := _COMMA.fullmatch(typed.text)) is not None:
            point = f"{comma[1]}.{comma[2]}"
            raise ConfigError(f"{name}={printable(typed.text, 40)}: {HAS_COMMA}; write {point}")
        if not math.isfinite(typed.number) or typed.unit not in ("", unit):
            wanted = f"a number in {unit}" if unit else "a plain number"
            raise ConfigError(
                f"{name}={printable(typed.text, 40)}: expected {wanted}, or in a unit of that kind"
            )
        return typed.number

    def word(self, name: str) -> str:
        """Return a text as it was typed, empty where it was not."""
        typed = self._values.get(name)
        return typed.text if typed is not None else ""

    def refuse_others(self, known: Iterable[str]) -> None:
        """Refuse what a step does not ask for.

        Raises
        ------
        ConfigError
            A name is none of those.
        """
        wanted = sorted(set(known))
        for name in self._values:
            if name not in wanted:
                raise ConfigError(
                    f"{name}: this step does not ask for it; it asks for "
                    f"{', '.join(wanted) or 'nothing'}"
                )


def typed(text: str) -> Typed:
    """Return ``name=value unit`` as typed; the number comes out in SI.

    Raises
    ------
    ConfigError
        It is none.
    """
    name, is_there, value = text.partition("=")
    name, value = name.strip(), value.strip()
    if not is_there or not _NAME.fullmatch(name) or not value or len(value) > LONGEST:
        raise ConfigError(
            f"--typed {printable(text, 60)}: expected name=value, or 'name=value unit', such as "
            "'load=20 lbf'"
        )
    match = _NUMBER.fullmatch(value)
    number, unit = (math.nan, "") if match is None else _si(float(match[1]), match[2])
    return Typed(name=name, text=printable(value), number=number, unit=unit)


def _si(number: float, written: str) -> tuple[float, str]:
    """Return a number and its SI unit; NaN where the unit is not known: the text is no number."""
    if not math.isfinite(number):
        return math.nan, ""
    if not written or written == _DECIBEL:
        return number, written
    info = unit_info(written)
    if info is None:
        return math.nan, ""
    unit, factor = to_si(info.symbol)
    return number * factor, unit
