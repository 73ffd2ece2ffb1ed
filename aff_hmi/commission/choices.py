"""Answers that have a button: what it is called, and sentences that name it so."""

from __future__ import annotations

import re
from collections.abc import Iterable

from aff_hmi.words import N_, Say

CHOICES = {
    "yes": N_("yes"),
    "no": N_("no"),
    "none": N_("none"),
    "skip": N_("skip"),
    "again": N_("another moment"),
    "find": N_("find"),
    "move": N_("move it"),
}
OR, COMMA = " or ", ", "
_RANGE = re.compile(r"(\d+) to (\d+)")


def called(choice: str, say: Say) -> str:
    """Return what the button of an answer is called."""
    return say(CHOICES.get(choice, choice))


def named(choice: str, say: Say) -> str:
    """Return an answer as a sentence names it: rows by number, buttons as they are called."""
    if (rows := _RANGE.fullmatch(choice)) is not None:
        low, high = rows.groups()
        return say(N_("{low} to {high}")).replace("{low}", low).replace("{high}", high)
    if choice not in CHOICES:
        return choice
    return say(N_("“{choice}”")).replace("{choice}", called(choice, say))


def all_named(choices: str, say: Say) -> str:
    """Return answers that can be given (``1 to 4 or again``, ``yes, no``) as a sentence does."""
    first, *others = [named(one, say) for one in choices.split(OR)]
    for other in others:
        first = say(N_("{one} or {other}")).replace("{one}", first).replace("{other}", other)
    return first if others else COMMA.join(named(one, say) for one in choices.split(COMMA))


def with_buttons(text: str, choices: Iterable[str], say: Say) -> str:
    """Return a question whose answers in backticks are named as their buttons are called."""
    for one in choices:
        text = text.replace(f"`{one}`", named(one, say))
    return text
