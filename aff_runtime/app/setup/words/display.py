"""What a technician types off a display: ``20.3 lbf``, with the digits that it shows."""

from __future__ import annotations

import re
from dataclasses import dataclass

from aff_runtime.base.units import UnitError, accepted_units, read_number, to_si, unit_info

_PLACES = ("length", "angle", "ratio")  # dimensions in which a dancer's place is shown
_SHOWN = re.compile(
    r"\s*[-+]?\d*\.?(?P<decimals>(?<=\.)\d*)?(?:[eE](?P<exponent>[-+]?\d+))?\s*"
    r"(?P<unit>\S.*?)?\s*"
)
LONGEST = 100  # characters; no display shows as many


@dataclass(frozen=True, slots=True, kw_only=True)
class Shown:
    """One value off a display.

    Attributes
    ----------
    text : as it was typed.
    value : in SI.
    half_digit : half of its last digit, SI.
    unit : as the table of units spells it; ``si_per_unit`` of it.
    """

    text: str
    value: float
    half_digit: float
    unit: str
    si_per_unit: float


def shown_value(text: str, si_unit: str) -> Shown:
    """Return what was typed.

    Raises
    ------
    UnitError : no number, no unit, a unit of another dimension, or zero.
    """
    match = _SHOWN.fullmatch(text[: LONGEST + 1])
    if len(text) > LONGEST:
        raise UnitError(f'"{text.strip()[:40]}" is longer than a display. Write its value alone.')
    if match is None or not match["unit"]:
        read_number(text if match is None else f"{text.strip()} {si_unit}", si_unit)
        others = ", ".join(accepted_units(si_unit)[:5])
        raise UnitError(
            f'"{text.strip()[:40]}" has no unit. Write it as the display has it: {others}.'
        )
    value = read_number(text, si_unit)
    if value == 0.0:
        raise UnitError("0 tells no scale. Wait until the display shows another value.")
    info = unit_info(match["unit"])
    if info is None:  # the two readings of it are not of one mind
        raise UnitError(f'"{text.strip()}" is no value with a unit. Write it as 20.3 {si_unit}.')
    last_digit = int(match["exponent"] or 0) - len(match["decimals"] or "")
    return Shown(
        text=" ".join(text.split()),
        value=value,
        half_digit=float(f"5e{last_digit - 1}") * to_si(info.symbol)[1],
        unit=info.symbol,
        si_per_unit=info.si_per_unit,
    )


def is_place(text: str) -> bool:
    """Return whether this is where a dancer stands: a length, an angle, per cent, its name."""
    if text.strip().lower() == "dancer":
        return True
    match = _SHOWN.fullmatch(text)
    unit = unit_info(match["unit"]) if match is not None and match["unit"] else None
    return unit is not None and unit.dimension in _PLACES
