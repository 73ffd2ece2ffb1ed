"""How many there are of something, in a sentence."""

from __future__ import annotations


def counted(count: int, noun: str) -> str:
    """Return ``no values``, ``1 value`` or ``2 values`` of the noun ``value``."""
    return f"{count or 'no'} {noun}{'' if count == 1 else 's'}"
