"""What is asked with words: a name, a sentence, a default, and how an answer is read."""

from __future__ import annotations

import re
from collections.abc import Callable, Set
from dataclasses import dataclass

from aff_runtime.base.channel_units import ENDINGS, unit_of_channel
from aff_runtime.base.printable import printable
from aff_runtime.base.suggest import meant
from aff_runtime.base.units import UnitError, plain, read_number

LONGEST = 200  # characters of an answer
_NAME = re.compile(r"[a-z][A-Za-z0-9_]{0,39}")
_BIT = re.compile(r"\s*(?P<word>\d{1,5})\.(?P<bit>\d{1,2})(?P<inverted>\s+inverted)?\s*")
NONE, FIND = "none", "find"
"""Answers: the PLC has none; setup shall find it by watching."""


class AnswerError(ValueError):
    """An answer cannot be taken; the text says what was read and what to write."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """One question.

    Attributes
    ----------
    name : key of the answer.
    text : what is asked, for a technician.
    read : takes an answer as typed and returns it as it is kept; ``AnswerError`` otherwise.
    default : taken when nothing is typed; None where something must be.
    rows : answers that may be picked, each with what it stands for.
    """

    name: str
    text: str
    read: Callable[[str], str]
    default: str | None = None
    rows: tuple[tuple[str, str], ...] = ()

    @property
    def choices(self) -> tuple[str, ...]:
        """What may be answered beside rows; empty where anything may be typed."""
        return getattr(self.read, "choices", ())


def read_text(text: str) -> str:
    """Take any one line that prints."""
    text = text.strip()
    if not text or len(text) > LONGEST:
        raise AnswerError(f"{len(text)} characters. Write 1 to {LONGEST}.")
    if not text.isprintable():
        raise AnswerError(f"{printable(text, 60)} holds what does not print. Type it again.")
    return text


def read_name(text: str) -> str:
    """Take a name as the site file has them."""
    if not _NAME.fullmatch(text.strip()):
        raise AnswerError(
            f'"{printable(text, 40)}" is no name. Begin with a small letter, then letters, digits '
            "and underscores, 40 at most."
        )
    return text.strip()


def channel_or_none(names: Set[str]) -> Callable[[str], str]:
    """Return the reader of a channel's name or ``none``; those of ``names`` are refused."""

    def read(text: str) -> str:
        if text.strip() == NONE:
            return NONE
        name = _channel(text, names)
        if unit_of_channel(name) == "rad":
            raise AnswerError(
                f"{name} is an angle: setup finds the encoders of corrected rolls alone. Write "
                "others into the site file, by the manual (docs/config-reference.md)."
            )
        if not unit_of_channel(name):
            raise AnswerError(
                f"{name} is a number without a unit: nothing on a display tells it from others. "
                "Write it into the site file (docs/config-reference.md)."
            )
        return name

    return read


def channel_in(unit: str, names: Set[str]) -> Callable[[str], str]:
    """Return the reader of the name of a channel in ``unit``; those of ``names`` are refused."""

    def read(text: str) -> str:
        name = _channel(text, names)
        if unit_of_channel(name) != unit:
            raise AnswerError(f"{name} is in {unit_of_channel(name)}. Name a channel in {unit}.")
        return name

    return read


def _channel(text: str, names: Set[str]) -> str:
    name = read_name(text)
    if unit_of_channel(name) is None:
        raise AnswerError(
            f"{name} does not end with its SI unit. Let it end with one of: {ENDINGS}."
        )
    if name in names:
        raise AnswerError(f"{name} is asked for already. Write another name.")
    return name


def whole(low: int, high: int) -> Callable[[str], str]:
    """Return the reader of a whole number."""

    def read(text: str) -> str:
        shown = text.strip()
        if not re.fullmatch(r"[0-9]{1,9}", shown) or not low <= int(shown) <= high:
            raise AnswerError(f'"{printable(shown, 40)}": write a whole number, {low} to {high}.')
        return str(int(shown))

    return read


@dataclass(frozen=True, slots=True)
class OneOf:
    """Takes one word of several."""

    choices: tuple[str, ...]

    def __call__(self, text: str) -> str:
        """Return the word."""
        shown = text.strip()
        if shown not in self.choices:
            raise AnswerError(
                f'"{printable(shown, 40)}" is not known. {meant(shown, self.choices)}'
            )
        return shown


def one_of(*choices: str) -> OneOf:
    """Return the reader of one word of several."""
    return OneOf(choices)


def number(unit: str, low: float, high: float) -> Callable[[str], str]:
    """Return the reader of a number, bare (then in ``unit``) or with its own: low < it <= high."""

    def read(text: str) -> str:
        shown = " ".join(text.split())
        value = number_of(shown, unit)
        if not low < value <= high:
            raise AnswerError(
                f'"{printable(shown, 40)}" is out of range: above {plain(low)}, up to '
                f"{plain(high)} {unit}."
            )
        return shown

    return read


def number_of(text: str, unit: str) -> float:
    """Return a number as typed, in ``unit``; a bare one is in it."""
    try:
        return read_number(float(text), unit)
    except ValueError:
        pass
    try:
        return read_number(text, unit)
    except UnitError as error:
        raise AnswerError(printable(str(error), 300)) from None


def word_or_none(why_not: Callable[[int], str]) -> Callable[[str], str]:
    """Return the reader of a wire address or ``none``; ``why_not`` as of ``word``."""

    def read(text: str) -> str:
        return NONE if text.strip() == NONE else word(why_not)(text)

    return read


def word(why_not: Callable[[int], str]) -> Callable[[str], str]:
    """Return the reader of a wire address; ``why_not`` returns why it cannot be; empty: it can."""

    def read(text: str) -> str:
        address = whole(0, 65535)(text)
        why = why_not(int(address))
        if why:
            raise AnswerError(why)
        return address

    return read


def bit(why_not: Callable[[int, int], str]) -> Callable[[str], str]:
    """Return the reader of ``20.7`` or ``20.7 inverted``, ``find``, or ``none``.

    ``why_not`` returns why a bit of a word cannot be it; empty: it can.
    """

    def read(text: str) -> str:
        if text.strip() in (NONE, FIND):
            return text.strip()
        match = _BIT.fullmatch(text)
        if match is None or int(match["word"]) > 65535 or int(match["bit"]) > 15:
            raise AnswerError(
                f'"{printable(text, 40)}": write word and bit such as 20.7 (bit 0 to 15), '
                "`20.7 inverted` where 0 means yes, `find`, or `none`."
            )
        why = why_not(int(match["word"]), int(match["bit"]))
        if why:
            raise AnswerError(why)
        place = f"{int(match['word'])}.{int(match['bit'])}"
        return f"{place} inverted" if match["inverted"] else place

    return read


def split_bit(kept: str) -> tuple[int, int, bool]:
    """Return word, bit and whether it is inverted of an answer that ``bit`` took."""
    place, _, inverted = kept.partition(" ")
    at, _, bit = place.partition(".")
    return int(at), int(bit), bool(inverted)
