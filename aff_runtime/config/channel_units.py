"""The SI unit of a channel, read from the end of its name."""

from __future__ import annotations

_SUFFIXES = (
    ("_rad_s", "rad/s"),
    ("_m_s", "m/s"),
    ("_N_m", "N m"),
    ("_rad", "rad"),
    ("_N", "N"),
    ("_m", "m"),
)
ENDINGS = ", ".join(f"{suffix} ({unit})" for suffix, unit in _SUFFIXES)


def unit_of_channel(name: str) -> str | None:
    """Return the SI unit of a channel name such as ``unwind_tension_N``, None when it has none."""
    for suffix, unit in _SUFFIXES:
        if name.endswith(suffix) and len(name) > len(suffix):
            return unit
    return None


def suffix_of_unit(unit: str) -> str:
    """Return how key names spell a unit: ``m/s`` as ``m_s``."""
    return next(suffix[1:] for suffix, known in _SUFFIXES if known == unit)
