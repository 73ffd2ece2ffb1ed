"""Units in column headers: the suffix of a channel name is its unit, others are converted."""

from __future__ import annotations

import re

from aff_runtime.base.channel_units import without_unit
from aff_runtime.base.units import to_si

_SYMBOLS = {
    **{symbol: symbol for symbol in ("N", "kN", "lbf", "mN", "rad", "deg", "rev", "rpm")},
    **{symbol: symbol for symbol in ("m", "mm", "in", "ft", "s", "ms", "us", "min")},
    **{"m_s": "m/s", "fpm": "FPM", "m_min": "m/min", "ft_s": "ft/s", "mm_s": "mm/s"},
    **{"rad_s": "rad/s", "deg_s": "deg/s", "N_m": "N m"},
}
"""Unit as a header spells it -> its symbol in the product's table of units."""


def _suffix_and_factor(symbol: str) -> tuple[str, float]:
    unit, factor = to_si(symbol)
    return unit.replace("/", "_").replace(" ", "_"), factor


TO_SI = {spelling: _suffix_and_factor(symbol) for spelling, symbol in _SYMBOLS.items()}
"""Header unit -> (unit of the channel name, factor)."""

_BRACKET = re.compile(r"^\s*(?P<name>.*?)\s*[\[(](?P<unit>[^\])]+)[\])]\s*$")


def canonical(unit: str) -> str:
    """Return a header's unit in the spelling of ``TO_SI``: ``m/s`` -> ``m_s``."""
    text = unit.strip().replace("/", "_").replace("·", "_").replace(" ", "_").replace("*", "_")
    lower = {key.lower(): key for key in TO_SI}
    text = {"ft_min": "fpm", "1_min": "rpm", "inch": "in", "sec": "s", "nm": "N_m"}.get(
        text.lower(), text
    )
    return text if text in TO_SI else lower.get(text.lower(), text)


def split_header(text: str) -> tuple[str, str]:
    """Return (stem, unit) of a header; unit is empty when the header names none.

    ``line_speed_m_s`` -> (line_speed, m_s); ``line speed [fpm]`` -> (line_speed, fpm).
    """
    text = text.strip().strip('"')
    match = _BRACKET.match(text)
    if match:
        stem = without_unit(match["name"].strip().replace(" ", "_"))
        return stem, canonical(match["unit"])
    for unit in sorted(TO_SI, key=len, reverse=True):
        if text.endswith("_" + unit):
            return text[: -len(unit) - 1], unit
    return text, ""
