"""Every word of the screen goes through the catalogue: in a language of its own none is left."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from typing import Any

import pytest

pytest.importorskip("starlette")

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import State
from aff_runtime.core.monitor import OrderState
from tests.aff_hmi.asgi import HOST
from tests.aff_hmi.pressed import Pressed, onlooker
from tests.aff_hmi.pseudo import BEGIN, END, LONGER, pseudo, speaks

PAGES = ("/", "/alarms", "/rolls", "/trends", "/scope", "/timing", "/login")
SPOKEN = ("aria-label", "title", "placeholder", "alt")
# what is the same in every language: marks, keys, units, names of the site, programs and files
UNITS = r"N|rms|dB|mm|mm/s|m/min|MB|s|min|h|%|Hz|°|µs|ms|m/s"
SAME = re.compile(
    rf"(\W|\d|{UNITS}|AFF Runtime [\w.+-]+|AFF|F9|PLC|CSV|English|Deutsch|Esc|"
    r"g|t|u|l|a|m|c|unwind)*"
)
NAMES = {"Euclid", "anna", "unwind tension", "line speed", "Euclid · AFF"}
NAMES |= set(BY_NAME)  # of events, as the service and its records call them
CODE = ("code", "kbd", "script", "style")


class Texts(HTMLParser):
    """Collects every text that a reader may see or hear, and the words that scripts take."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []
        self._inside: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in ("meta", "link", "input", "img", "br"):
            self._inside.append(tag)
        of_scripts = dict(attrs).get("id") in ("words", "see-words", "hand-words")
        for name, value in attrs:
            if name in SPOKEN or (of_scripts and name.startswith("data-")):
                self.found.append(value or "")

    def handle_endtag(self, tag: str) -> None:
        while self._inside and self._inside.pop() != tag:
            pass

    def handle_data(self, data: str) -> None:
        if not set(self._inside) & set(CODE):
            self.found.append(data)


def untranslated(texts: list[str]) -> list[str]:
    """Return what is left of texts without what was translated, and what is no word."""
    left = [re.sub(rf"{BEGIN}[^{BEGIN}{END}]*{END}", "", one).strip() for one in texts]
    return [one for one in left if one not in NAMES and not SAME.fullmatch(one)]


@pytest.fixture
def speaking(keeping: Pressed, monkeypatch: pytest.MonkeyPatch) -> Pressed:
    """Return a screen that speaks the language of these tests."""
    speaks(monkeypatch)
    return keeping


@pytest.mark.parametrize("account", ["", "anna"])
@pytest.mark.parametrize("path", PAGES)
def test_no_word_of_a_page_is_beside_the_catalogue(
    speaking: Pressed, path: str, account: str
) -> None:
    browser = speaking.browser(account)
    said = [("host", HOST), ("cookie", browser.cookie)]
    reader = Texts()
    reader.feed(browser.ask("GET", path, said).said["text"])
    assert len(reader.found) > 20
    assert untranslated(reader.found) == []


def words_of(said: Any, keys: tuple[str, ...]) -> list[str]:
    """Return every text under one of these keys, however deep."""
    if isinstance(said, list):
        return [text for one in said for text in words_of(one, keys)]
    if not isinstance(said, dict):
        return []
    found = [one for key in keys if isinstance(one := said.get(key), str)]
    return found + [text for one in said.values() for text in words_of(one, keys)]


WORDS = ("word", "why", "to_do", "text", "life_word", "load", "zero", "extremes", "state_word")


@pytest.mark.parametrize("topic", ["", "alarms", "rolls", "timing"])
def test_no_sentence_of_a_frame_is_beside_the_catalogue(speaking: Pressed, topic: str) -> None:
    hub = speaking.hub
    hub._viewers.add(onlooker(topic))
    speaking.clock.advance_ns(10**9)
    speaking.show(
        State.ACTIVE,
        blocked="WEB_INTACT=0",
        **{"unwind.unwind_2x.state": float(OrderState.CLAMPED), "unwind.omega_rad_s": 5.0},
    )
    frame = json.loads("{" + hub._frames["en", topic].lstrip("{"))
    texts = [text for text in words_of(frame, WORDS) if text] + list(frame["notes"].values())
    assert len(texts) > 2
    assert untranslated(texts) == []


def test_the_language_is_longer_by_two_fifths_and_keeps_its_places() -> None:
    for text in ("Do", "no orders of two rolls will meet soon", "{age} old", "READY"):
        said = pseudo(text)
        assert len(said) >= (1.0 + LONGER) * len(text)
        assert re.findall(r"{\w+}", said) == re.findall(r"{\w+}", text)
