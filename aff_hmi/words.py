"""Words of the screen in the reader's language, by gettext.

English is in the code. What the service says in its own tables (events, permissives, states of an
order) is translated by the same catalogue, as a whole sentence; names of the site file never are.
"""

from __future__ import annotations

import gettext
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path

LOCALE = Path(__file__).parent / "locale"
DOMAIN = "aff_hmi"
LANGUAGES = ("en", "de")
NAMES = {"en": "English", "de": "Deutsch"}
Say = Callable[[str], str]


# one that a unit follows is a number: an address, a version or a word.bit is none
_FIGURE = re.compile(
    r"(?<![\w,])(?:(?<!\.)|(?<=\.\.))([+-]?\d+)\.(\d+(?:e-?\d+)?)"
    r"(?=\.\.\d| (?:s|ms|m|mm|N|N m|m/s|mm/s|m/min|Hz|deg|MB|dB|times|%)(?![\w/]))"
)
_WHOLE = re.compile(r"[+-]?\d+\.\d+(?:e-?\d+)?")


def N_(text: str) -> str:
    """Mark a text for translation."""
    return text


FIGURE = N_("0.0")
"""How a number is written: what stands between its digits is the language's decimal mark."""


def figures_in(text: str, say: Say) -> str:
    """Return a text with the reader's decimal mark: a number, or numbers with units in it."""
    found = re.search(r"0(\D)0", say(FIGURE))
    if found is None or found[1] == ".":
        return text
    if _WHOLE.fullmatch(text):
        return text.replace(".", found[1])
    return _FIGURE.sub(lambda one: f"{one[1]}{found[1]}{one[2]}", text)


@cache
def say_in(language: str) -> Say:
    """Return the translation of one of ``LANGUAGES``; English for any other."""
    if language not in LANGUAGES or language == "en":
        return gettext.NullTranslations().gettext
    return gettext.translation(DOMAIN, LOCALE, [language]).gettext


def language_of(wanted: str, accepted: str, default: str) -> str:
    """Return the language of a page.

    Parameters
    ----------
    wanted : chosen by the reader; empty when nothing is.
    accepted : the browser's ``Accept-Language``.
    default : of this screen.
    """
    if wanted in LANGUAGES:
        return wanted
    for part in accepted[:200].split(","):
        code = part.split(";")[0].strip().lower()[:2]
        if code in LANGUAGES:
            return code
    return default
