"""Sets of event codes as one integer each: bit ``code`` is set while the cause is present."""

from __future__ import annotations

from aff_runtime.base.events import BY_NAME, TABLE, Reaction


def bit(name: str) -> int:
    """Return the mask of the event called ``name``."""
    return 1 << BY_NAME[name].code


def first_code(causes: int) -> int:
    """Return the lowest event code in ``causes``; 0 when there is none."""
    return (causes & -causes).bit_length() - 1 if causes else 0


def _with_reaction(reaction: Reaction) -> int:
    return sum(1 << event.code for event in TABLE if event.reaction is reaction)


LATCHING = _with_reaction(Reaction.FADE_AND_LATCH)
FADING = _with_reaction(Reaction.FADE)
HOLDING = _with_reaction(Reaction.HOLD)
