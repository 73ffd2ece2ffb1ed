"""Sentences of setup and card in the reader's language.

Commissioner and card write English sentences with numbers and names in them. Each is found again
by its pattern and said with the same numbers; what is in no pattern stays English, and is told
whole. What has a pattern and more than ``LONGEST`` characters loses its tail to an ellipsis.
What stands in a place called ``what`` or ``why`` is itself such a sentence, or a list of them; in
one called ``choices`` answers that can be given: they are named as their buttons are called.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache, lru_cache

from aff_hmi.commission.bus_sentences import BUS
from aff_hmi.commission.card_lacks import LACKS
from aff_hmi.commission.card_sentences import CARD
from aff_hmi.commission.choices import all_named
from aff_hmi.commission.drive_sentences import DRIVES, WHY_NONE
from aff_hmi.commission.line_sentences import LINE
from aff_hmi.commission.run_sentences import RUNS
from aff_hmi.commission.setup_sentences import SETUP
from aff_hmi.commission.verdict_sentences import PATTERNS as VERDICTS
from aff_hmi.words import N_, Say

PATTERNS = (
    N_("a card is begun, {hash}"),
    N_("no card is begun"),
    N_("stopped"),
    N_("stopped; look at the card and the site file"),
    N_("its commissioner was ended before it answered; look at the card and the site file"),
    N_("tried for {seconds} s: {rest}"),
    N_("kept; saved as the site file"),
    N_("undone; the former settings run"),
    N_("this step proposes nothing"),
    N_("{thing} (applies at once)"),
    N_("{thing} (waits for bypass)"),
    N_("the site file is not what runs: look at the alarms, or wait"),
    N_("this is what runs"),
    N_("what is saved takes effect at the next bypass"),
    N_("saved as the site file, and runs"),
    N_("nothing differs from what is saved"),
    N_("{name}: stands there as no single value; edit the file itself"),
    N_(
        "the try has ended already ({why}), and the former settings run. To go back to those "
        "before them: {rest}"
    ),
    N_("version {number} is saved as the site file, and runs"),
    N_("the text of version {number} is not there any more"),
    N_("somebody has saved other settings since you looked; look again"),
    N_("it is saved and does not run yet; see `aff-runtime status`"),
    N_("other settings are being tried than those that you saw; look again"),
    N_("other settings are being checked; try again"),
    N_("no settings are being tried"),
    N_("the correction was taken back meanwhile; look again"),
    N_("the line is in remote: this is the PLC's"),
    N_("this account may not change settings; the role commission is needed"),
    N_("why: read {count} characters, a reason of {least} to {most} characters is needed"),
    N_("nothing differs from what runs"),
    N_("settings are being tried; keep or undo them first"),
    N_("{name}: one value, such as 5 or 10 ms is needed"),
    N_("{name}: one value, such as 5 or 10 ms is needed; a point, not a comma"),
    N_("{name}: a list such as [1, 2, 3] is needed"),
    N_("this would change more than these values; edit the file itself"),
    N_("its time is up"),
    N_("a file was saved meanwhile"),
    N_("the correction was taken back"),
    N_("the service stops"),
    N_("the control process died"),
    N_("the control process starts anew"),
    N_("nothing was heard of the probe in its time; probe again"),
    N_("the result is too long for the link; probe fewer actuators"),
    N_("nothing was measured: {rest}"),
    N_("take the hand first"),
    N_("step {step}: pass"),
    N_("step {step}: fail"),
    N_("step {step}: open"),
    N_("step {step}: not applicable"),
    N_("step {step} signed as {name}"),
    N_("{count} entries, whole; newest {hash}"),
    N_("does not hold: {reason}"),
    N_("the reason has {count} characters; write {least} to {most}"),
    N_("no service answers; step {step} looks at {thing}"),
    N_(
        "no service answers that records now; start it, or name a window of a record (on the "
        "console: --run RUN_DIR@FROM..TO)"
    ),
    N_("its process ended without an answer; see the log of the commissioner"),
    *SETUP,
    *BUS,
    *RUNS,
    *CARD,
    *LACKS,
    *VERDICTS,
    *LINE,
    *DRIVES,
    *WHY_NONE,
)
_PLACE = re.compile(r"\\\{(\w+)\\\}")
_NESTED = ("what", "why")
_CHOICES = "choices"
_LISTS = (*_NESTED, _CHOICES, "bits", "rest", "reason", "site", "text", "thing", "words")
LIST_MARKS = ("; ", ", ")
_NO_COLON = r"(?:(?!, |; )[^:])+?"
_ONE_WORD = r"[^\s:]+"
_KINDS = {
    "word": r"\d+",
    "file": r"/\S+?",
    "all": r"\d+",
    "roll": _NO_COLON,
    "both": r"\d+",
    **dict.fromkeys(("actuator", "frequency", "order", "radius", "rpm", "speed"), _ONE_WORD),
    **dict.fromkeys(("measured", "setting"), _ONE_WORD),
}
"""What is narrow in every sentence: else a text with many colons has more ways to be taken apart
than a server's loop has time for."""
_END = re.compile(r"(?<=\.) ")
LONGEST, DEEPEST = 700, 6
MOST_KEPT = 2048
"""Sentences that are found at once again: a page says the same ones in every frame."""


@cache
def _compiled() -> tuple[tuple[re.Pattern[str], str], ...]:
    """Return every pattern; those with the most fixed text come first."""
    by_length = sorted(PATTERNS, key=lambda text: -len(re.sub(r"\{\w+\}", "", text)))
    patterns = (_PLACE.sub(_any, re.escape(_evenly(text))) for text in by_length)
    return tuple(zip(map(re.compile, patterns), by_length, strict=True))


def _any(place: re.Match[str]) -> str:
    """Return what stands in a place: of some its kind; no list, unless it is for one."""
    if place[1] in _KINDS:
        return f"(?P<{place[1]}>{_KINDS[place[1]]})"
    return f"(?P<{place[1]}>.+?)" if place[1] in _LISTS else f"(?P<{place[1]}>(?:(?!, |; ).)+?)"


def sentence(text: str, say: Say, depth: int = 0) -> str:
    """Return a sentence in the reader's language; English where no pattern is of it."""
    if depth > DEEPEST:
        return text
    template, values = _taken_apart(_bounded(_evenly(text)))
    if not template:
        return text
    said = say(template)
    for name, value in values:
        said = said.replace(f"{{{name}}}", _shown(name, value, say, depth))
    return said


@lru_cache(maxsize=MOST_KEPT)
def _taken_apart(text: str) -> tuple[str, tuple[tuple[str, str], ...]]:
    """Return the pattern of a sentence and what stands in its places; nothing where none is."""
    for pattern, template in _compiled():
        found = pattern.fullmatch(text)
        if found is not None:
            return template, tuple(found.groupdict().items())
    return "", ()


def _shown(name: str, value: str, say: Say, depth: int) -> str:
    """Return what stands in a place, in the reader's language where it is a text of ours."""
    if name == _CHOICES:
        return all_named(value, say)
    return parts(value, say, depth) if name in _NESTED else value


def _evenly(text: str) -> str:
    """Return a text whose words stand one space apart: a terminal's columns are none here."""
    return " ".join(text.split())


def _bounded(text: str) -> str:
    """Return at most ``LONGEST`` characters, for a pattern takes longer the longer a text is."""
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}\u2026"


def parts(text: str, say: Say, depth: int = 0) -> str:
    """Return a sentence, or a list of them, in the reader's language."""
    whole = sentence(text, say, depth + 1)
    if whole != text:
        return whole
    for mark in LIST_MARKS:
        if mark in text:
            return mark.join(_list(text.split(mark), mark, say, depth))
    return text


def _list(pieces: list[str], mark: str, say: Say, depth: int) -> Iterator[str]:
    """Yield the parts of a list; a sentence that has the mark in it is one part."""
    while pieces:
        for count in (2, 1):
            text = mark.join(pieces[:count])
            said = sentence(text, say, depth + 1)
            if said != text or len(pieces[:count]) == 1:
                break
        pieces = pieces[count:]
        yield parts(said, say, depth + 1) if said == text else said


def sentences(text: str, say: Say) -> str:
    """Return several sentences in the reader's language, each by itself, or part by part."""
    return " ".join(_one(said, say) for said in _END.split(text))


def _one(text: str, say: Say) -> str:
    """Return a sentence with its stop; one that is too long for a pattern stays English."""
    if len(text) > LONGEST:
        return text
    said = sentence(text, say)
    body = text.removesuffix(".")
    return f"{parts(body, say)}." if said == text != body else said
