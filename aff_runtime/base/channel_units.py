"""The SI unit of a name, read from its end: ``unwind_tension_N``, ``transport_s``.

The one place that knows how a unit is spelled in a name; whoever asks what unit something is in
asks here.
"""

from __future__ import annotations

_CHANNELS = (
    ("_rad_s", "rad/s"),
    ("_m_s", "m/s"),
    ("_N_m", "N m"),
    ("_rad", "rad"),
    ("_N", "N"),
    ("_m", "m"),
    ("_number", ""),
)
"""End of a channel's name, and its unit; the first match counts: an end before its own end.

What is a number alone, such as that of a supplier, has none.
"""

_NAMES = (*_CHANNELS, ("_Hz", "Hz"), ("_s", "s"))
"""The same for any name: a time or a frequency too."""

ENDINGS = ", ".join(f"{ending} ({unit or 'no unit'})" for ending, unit in _CHANNELS)
"""The ends of channels' names, for a message that asks to choose one."""


def unit_of_channel(name: str) -> str | None:
    """Return the SI unit of a channel name such as ``unwind_tension_N``, empty of a number alone.

    None when its end says nothing.
    """
    return _unit(name, _CHANNELS)


def unit_of_name(name: str) -> str:
    """Return the SI unit that any name ends in, a time or a frequency too; empty when in none."""
    return _unit(name, _NAMES) or ""


def suffix_of_unit(unit: str) -> str:
    """Return how names spell a unit: ``m/s`` as ``m_s``."""
    return next(ending[1:] for ending, known in _NAMES if known == unit)


def without_unit(name: str) -> str:
    """Return a name without the unit at its end: ``unwind_tension_N`` as ``unwind_tension``."""
    unit = unit_of_name(name)
    return name.removesuffix("_" + suffix_of_unit(unit)) if unit else name


def _unit(name: str, known: tuple[tuple[str, str], ...]) -> str | None:
    for ending, unit in known:
        if name.endswith(ending) and len(name) > len(ending):
            return unit
    return None
