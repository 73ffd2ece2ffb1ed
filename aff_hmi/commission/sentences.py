"""Sentences of setup and card in the reader's language.

The engine writes English sentences with numbers and names in them. Each is found again by its
pattern and said with the same numbers; what is in no pattern stays English, and is told whole.
"""

from __future__ import annotations

import re
from functools import cache

from aff_hmi.words import N_, Say

PATTERNS = (
    N_("a card is begun, {hash}"),
    N_("no card is begun"),
    N_("stopped"),
    N_("step {step}: pass"),
    N_("step {step}: fail"),
    N_("step {step}: open"),
    N_("step {step}: not applicable"),
    N_("step {step} signed as {name}"),
    N_("{count} entries, whole; newest {hash}"),
    N_("does not hold: {why}"),
    N_("the reason has {count} characters; write {least} to {most}"),
    N_("no service answers; step {step} looks at {what}"),
    N_("no service answers that records now; name a window with --run RUN_DIR@FROM..TO"),
    N_("its process ended without an answer; see the log of the commissioner"),
)
_PLACE = re.compile(r"\\\{(\w+)\\\}")
LONGEST = 700


@cache
def _compiled() -> tuple[tuple[re.Pattern[str], str], ...]:
    """Return every pattern; those with the most fixed text come first."""
    by_length = sorted(PATTERNS, key=lambda text: -len(re.sub(r"\{\w+\}", "", text)))
    return tuple(
        (re.compile(_PLACE.sub(r"(?P<\1>.*?)", re.escape(text)), re.DOTALL), text)
        for text in by_length
    )


def sentence(text: str, say: Say) -> str:
    """Return a sentence in the reader's language; English where no pattern is of it."""
    for pattern, template in _compiled():
        found = pattern.fullmatch(text[:LONGEST])
        if found is not None:
            said = say(template)
            for name, value in found.groupdict().items():
                said = said.replace(f"{{{name}}}", value)
            return said
    return text
