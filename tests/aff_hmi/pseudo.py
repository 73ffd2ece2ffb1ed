"""A language of its own for tests: every text marked, accented, and longer by two fifths."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest

from aff_hmi.words import say_in

BEGIN, END = "⟦", "⟧"
LONGER = 0.4
_ACCENTS = str.maketrans("aeiouncsyAEIOUNCSY", "àéîõüñçšýÀÉÎÕÜÑÇŠÝ")
_PLACE = re.compile(r"({\w+})")
_USERS = ("aff_hmi.pages", "aff_hmi.hub", "aff_hmi.see.kept", "aff_hmi.support.desk")


def pseudo(text: str) -> str:
    """Return a text in that language; what stands in braces stays."""
    if not text:
        return text
    parts = _PLACE.split(text)
    said = "".join(p if _PLACE.fullmatch(p) else p.translate(_ACCENTS) for p in parts)
    words = [word for word in re.findall(r"[^\W\d_]+", text) if len(word) > 2] or ["lô"]
    more, n = "", 0
    while len(more) < LONGER * len(text):  # in words as long as its own, which break as they do
        more += f" {words[n % len(words)].translate(_ACCENTS)}"
        n += 1
    return f"{BEGIN}{said}{more[: 1 + round(LONGER * len(text))]}{END}"


def speaks(patch: pytest.MonkeyPatch) -> None:
    """Have the whole screen speak it, whichever language is asked for."""
    for module in _USERS:
        patch.setattr(f"{module}.say_in", lambda language: pseudo)


@pytest.fixture
def spoken(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The screen speaks it in this test."""
    speaks(monkeypatch)
    yield
    assert say_in("en")("READY") == "READY"
