"""Units in column headers: the suffix of a channel name is its unit, others are converted."""

from __future__ import annotations

import math
import re

SUFFIXES = ("m_s", "rad_s", "N_m", "rad", "Hz", "N", "m", "s")
"""Units a channel name may end in, longest first."""

TO_SI = {
    "N": ("N", 1.0),
    "kN": ("N", 1e3),
    "lbf": ("N", 4.4482216152605),
    "mN": ("N", 1e-3),
    "m_s": ("m_s", 1.0),
    "fpm": ("m_s", 0.00508),
    "m_min": ("m_s", 1.0 / 60.0),
    "ft_s": ("m_s", 0.3048),
    "mm_s": ("m_s", 1e-3),
    "rad_s": ("rad_s", 1.0),
    "rpm": ("rad_s", math.pi / 30.0),
    "deg_s": ("rad_s", math.pi / 180.0),
    "rad": ("rad", 1.0),
    "deg": ("rad", math.pi / 180.0),
    "rev": ("rad", 2.0 * math.pi),
    "m": ("m", 1.0),
    "mm": ("m", 1e-3),
    "in": ("m", 0.0254),
    "ft": ("m", 0.3048),
    "s": ("s", 1.0),
    "ms": ("s", 1e-3),
    "us": ("s", 1e-6),
    "min": ("s", 60.0),
    "N_m": ("N_m", 1.0),
}
"""Header unit -> (unit of the channel name, factor)."""

_BRACKET = re.compile(r"^\s*(?P<name>.*?)\s*[\[(](?P<unit>[^\])]+)[\])]\s*$")


def suffix_of(name: str) -> str:
    """Return the unit that a channel name ends in, or an empty text."""
    for suffix in SUFFIXES:
        if name.endswith("_" + suffix):
            return suffix
    return ""


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
        stem = match["name"].strip().replace(" ", "_")
        for suffix in SUFFIXES:
            stem = stem.removesuffix("_" + suffix)
        return stem, canonical(match["unit"])
    for unit in sorted(TO_SI, key=len, reverse=True):
        if text.endswith("_" + unit):
            return text[: -len(unit) - 1], unit
    return text, ""
