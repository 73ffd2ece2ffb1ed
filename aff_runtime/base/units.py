"""Plant units to SI, at the edge only: ``300 m/min``, ``200 FPM``, ``20 lbf``, ``8 in``.

A key carries its unit in its name; text with a unit is converted to that unit, a bare number
already is in it. Nothing behind ``config`` and ``fieldbus`` ever sees a plant unit.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

_FT = 0.3048
_LBF = 4.4482216152605
_KGF = 9.80665
_TURN = 2.0 * math.pi

# dimension -> (its SI unit, {written unit: SI units in one of it})
_TABLE: dict[str, tuple[str, dict[str, float]]] = {
    "length": (
        "m",
        {"m": 1, "cm": 0.01, "mm": 1e-3, "um": 1e-6, "in": 0.0254, "ft": _FT, "mil": 2.54e-5},
    ),
    "speed": (
        "m/s",
        {
            "m/s": 1,
            "m/min": 1 / 60,
            "mm/s": 1e-3,
            "cm/s": 0.01,
            "mm/min": 1e-3 / 60,
            "km/h": 1 / 3.6,
            "ft/s": _FT,
            "ft/min": _FT / 60,
            "FPM": _FT / 60,
            "in/s": 0.0254,
        },
    ),
    "acceleration": (
        "m/s2",
        {"m/s2": 1, "m/s^2": 1, "mm/s2": 1e-3, "m/min/s": 1 / 60, "FPM/s": _FT / 60, "ft/s2": _FT},
    ),
    "force": (
        "N",
        {"N": 1, "mN": 1e-3, "kN": 1e3, "lbf": _LBF, "ozf": _LBF / 16, "kgf": _KGF, "daN": 10},
    ),
    "pressure": (
        "Pa",
        {"Pa": 1, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "N/mm2": 1e6, "psi": _LBF / 0.0254**2},
    ),
    "torque": (
        "N m",
        {
            "N m": 1,
            "Nm": 1,
            "mN m": 1e-3,
            "mNm": 1e-3,
            "kN m": 1e3,
            "lbf ft": _LBF * _FT,
            "lbf in": _LBF * 0.0254,
        },
    ),
    "torque rate": ("N m/s", {"N m/s": 1, "Nm/s": 1, "lbf in/s": _LBF * 0.0254}),
    "time": ("s", {"s": 1, "ms": 1e-3, "us": 1e-6, "min": 60, "h": 3600}),
    "angle": (
        "rad",
        {
            "rad": 1,
            "mrad": 1e-3,
            "deg": math.pi / 180,
            "turn": _TURN,
            "turns": _TURN,
            "rev": _TURN,
        },
    ),
    "angular speed": (
        "rad/s",
        {"rad/s": 1, "deg/s": math.pi / 180, "rpm": _TURN / 60, "rev/s": _TURN},
    ),
    "frequency": ("Hz", {"Hz": 1, "mHz": 1e-3, "kHz": 1e3}),
    "moment of inertia": (
        "kg m2",
        {"kg m2": 1, "kg m^2": 1, "kgm2": 1, "kg cm2": 1e-4, "lb ft2": 0.0421401},
    ),
    "density": ("kg/m3", {"kg/m3": 1, "g/cm3": 1000, "lb/ft3": 16.018463}),
    "size": ("B", {"B": 1, "kB": 1e3, "MB": 1e6, "GB": 1e9}),
    "ratio": ("", {"": 1, "%": 0.01}),
}
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_QUANTITY = re.compile(rf"\s*({_NUMBER})\s*(\S.*?)?\s*")
_DECIMAL_COMMA = re.compile(r"\s*([-+]?\d+),(\d+)((?:[eE][-+]?\d+)?\s*\D.*|)")


_COUNTS_PER_TURN = re.compile(rf"\s*({_NUMBER})\s*(?:counts?|cts?)\s*/\s*(?:turn|rev)\s*")


class UnitError(ValueError):
    """A value cannot be read in the unit its key asks for; the text says what was expected."""


@dataclass(frozen=True, slots=True, kw_only=True)
class UnitInfo:
    """One written unit: its dimension and how many SI units it holds."""

    symbol: str
    dimension: str
    si_per_unit: float


def _by_symbol() -> dict[str, UnitInfo]:
    found: dict[str, UnitInfo] = {}
    for dimension, (_, written) in _TABLE.items():
        for symbol, factor in written.items():
            found[symbol] = UnitInfo(symbol=symbol, dimension=dimension, si_per_unit=factor)
    return found


_BY_SYMBOL = _by_symbol()
# other spellings of the same unit; folded case decides only where nothing else matches
_SAME = {"µm": "um", "μm": "um", '"': "in", "'": "ft", "°": "deg", "°/s": "deg/s", "sec": "s"}
_SAME |= {"kg m²": "kg m2", "kg·m²": "kg m2", "kg cm²": "kg cm2", "kg/m³": "kg/m3"}
_SAME |= {"m/s²": "m/s2", "n·m": "N m", "n*m": "N m", "1/min": "rpm", "r/min": "rpm"}
_FOLDED: dict[str, list[str]] = {}
for _symbol in _BY_SYMBOL:
    _FOLDED.setdefault(_symbol.casefold(), []).append(_symbol)


def unit_info(symbol: str) -> UnitInfo | None:
    """Return what is known of a written unit, or None."""
    spelled = " ".join(symbol.split())
    spelled = _SAME.get(spelled, _SAME.get(spelled.casefold(), spelled))
    if spelled in _BY_SYMBOL:
        return _BY_SYMBOL[spelled]
    candidates = _FOLDED.get(spelled.casefold(), [])
    return _BY_SYMBOL[candidates[0]] if len(candidates) == 1 else None


def to_si(symbol: str) -> tuple[str, float]:
    """Return the SI unit of a symbol of the table, and how many of it one holds.

    Raises
    ------
    KeyError : the table has no such symbol.
    """
    info = _BY_SYMBOL[symbol]
    return _TABLE[info.dimension][0], info.si_per_unit


def accepted_units(unit: str) -> tuple[str, ...]:
    """Return every spelling that a key in ``unit`` takes, its own unit first."""
    info = _BY_SYMBOL[unit]
    return (unit, *(name for name in _TABLE[info.dimension][1] if name != unit))


def read_number(value: object, unit: str) -> float:
    """Return ``value`` as a number of ``unit``s.

    Parameters
    ----------
    value : a bare number (already in ``unit``), or text such as ``"300 m/min"``.
    unit : the key's own unit, one of the table (``"m/s"``, ``"ms"``, ``""`` for a ratio).

    Raises
    ------
    UnitError : not a number, not finite, or a unit of another dimension; says what to write.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise UnitError(f"{_shown(value)} is not a number. Write {_example(unit)}.")
    if isinstance(value, str):
        return _read_text(value, unit)
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise UnitError(f"{_shown(value)} is not a finite number. Write {_example(unit)}.")
    return number


def read_scale(value: object, unit: str) -> float:
    """Return how many ``unit``s one count is: as ``read_number``, or ``4096 counts/turn``.

    Raises
    ------
    UnitError : as ``read_number``, or counts per turn of what is no angle, or of 0 counts.
    """
    match = _COUNTS_PER_TURN.fullmatch(value) if isinstance(value, str) else None
    if match is None:
        return read_number(value, unit)
    wanted, counts = _BY_SYMBOL[unit], float(match[1])
    if wanted.dimension != "angle":
        reason = f"counts/turn is for an angle, expected {_a(wanted)}: {_example(unit)}."
        raise UnitError(f'"{_short(str(value))}": {reason}')
    if not math.isfinite(counts) or counts == 0.0:
        reason = "a turn needs a finite number of counts that is not 0. Write 4096 counts/turn."
        raise UnitError(f'"{_short(str(value))}": {reason}')
    return _TURN / counts / wanted.si_per_unit


def _read_text(text: str, unit: str) -> float:
    match = _QUANTITY.fullmatch(text)
    if match is None or _DECIMAL_COMMA.fullmatch(text) is not None:
        raise UnitError(_why_no_number(text, unit))
    number, written = float(match[1]), match[2]
    if not math.isfinite(number):
        raise UnitError(f'"{_short(text)}" is not a finite number. Write {_example(unit)}.')
    if written is None:
        raise UnitError(
            f'"{_short(text)}" is text, not a number (YAML 1.1). Write {plain(number)}.'
        )
    info = unit_info(written)
    wanted = _BY_SYMBOL[unit]
    if info is None:
        raise UnitError(f'unit "{_short(written)}" is not known here. Write {_example(unit)}.')
    if info.dimension != wanted.dimension:
        asked = _a(wanted) if unit else "a plain number"
        raise UnitError(f'"{_short(text)}" is {_a(info)}, expected {asked}: {_example(unit)}.')
    converted = number * info.si_per_unit / wanted.si_per_unit
    if not math.isfinite(converted):
        raise UnitError(f'"{_short(text)}" is not a finite number. Write {_example(unit)}.')
    return converted


def _why_no_number(text: str, unit: str) -> str:
    comma = _DECIMAL_COMMA.fullmatch(text)
    if comma is not None:
        written = f"{comma[1]}.{comma[2]}{comma[3]}"
        return f'"{_short(text)}" has a decimal comma. Write {_short(written)}.'
    return f'"{_short(text)}" is not a number. Write {_example(unit)}.'


def plain(number: float) -> str:
    """Return a number as YAML 1.1 reads it: no bare exponent, no trailing zeros."""
    text = f"{number:.12g}"
    if "e" not in text:
        return text
    if 1e-12 <= abs(number) < 1e15:
        return f"{number:.18f}".rstrip("0").rstrip(".")
    mantissa, exponent = text.split("e")
    return f"{mantissa if '.' in mantissa else mantissa + '.0'}e{int(exponent):+d}"


def _a(info: UnitInfo) -> str:
    article = "an" if info.dimension[0] in "aeiou" else "a"
    return f"{article} {info.dimension}"


def _example(unit: str) -> str:
    if not unit:
        return "a plain number such as 1.5"
    others = [name for name in accepted_units(unit) if name != unit][:3]
    return f"a number in {unit}" + (f", or with its unit ({', '.join(others)})" if others else "")


def _shown(value: object) -> str:
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "a section"
    return "a list" if isinstance(value, list | tuple) else _short(str(value))


def _short(text: str) -> str:
    return text if len(text) <= 40 else f"{text[:37]}..."
