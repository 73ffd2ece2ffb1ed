"""No word is missing in any language, and none is left over."""

from __future__ import annotations

import re
import string
from pathlib import Path

import pytest

import aff_hmi
from aff_hmi.words import LANGUAGES, figures_in, language_of, say_in
from tests.aff_hmi.msgids import all_texts
from tests.each_case import each_case

pytest.importorskip("babel")

from tests.aff_hmi.catalogues import catalogue, compiled, sentences, sources


@pytest.mark.parametrize("path", sources(), ids=lambda p: p.parts[-3])
def test_every_text_is_translated_and_no_other(path) -> None:
    said = {m.id: m.string for m in catalogue(path) if m.id}
    assert set(said) == all_texts()
    assert [text for text, words in said.items() if not words.strip()] == []
    assert not any(m.fuzzy for m in catalogue(path) if m.id)


@pytest.mark.parametrize("path", sources(), ids=lambda p: p.parts[-3])
def test_places_for_numbers_are_kept(path) -> None:
    for message in catalogue(path):
        if message.id:
            assert _places(message.string) == _places(message.id), message.id


@pytest.mark.parametrize("path", sources(), ids=lambda p: p.parts[-3])
def test_what_gettext_reads_is_what_was_written(path) -> None:
    found = sentences(path.with_suffix(".mo").read_bytes())
    assert len(found) > 1000
    assert found == sentences(compiled(path)), "run: python -m tests.aff_hmi.catalogues"


def test_every_language_has_a_catalogue_and_speaks() -> None:
    assert {path.parts[-3] for path in sources()} | {"en"} == set(LANGUAGES)
    assert say_in("de")("READY") == "BEREIT"
    assert say_in("en")("READY") == say_in("xx")("READY") == "READY"


@each_case(
    ("text", "german"),
    [
        ("0.05", "0,05"),
        ("-2.5", "-2,5"),
        ("5e-05", "5e-05"),
        ("1.5e-05", "1,5e-05"),
        ("PLC_STALE 0.035 s, OVERRUN 1.200 s", "PLC_STALE 0,035 s, OVERRUN 1,200 s"),
        ("31.40 Hz is outside 0.20..12.00 Hz", "31,40 Hz is outside 0,20..12,00 Hz"),
        ("applied 0.012 m/s of 0.030 m/s", "applied 0,012 m/s of 0,030 m/s"),
        # what only looks like a number: an address, a version, a word with its bit, a file
        ("192.168.7.10", "192.168.7.10"),
        ("no route to 10.0.0.5 since 1.5 s", "no route to 10.0.0.5 since 1,5 s"),
        ("Python 3.11", "Python 3.11"),
        ("word 20.7 inverted", "word 20.7 inverted"),
        ("site.yaml:7.3 mm2", "site.yaml:7.3 mm2"),
    ],
)
def test_numbers_have_the_comma_in_german_and_nothing_else_has(text: str, german: str) -> None:
    assert figures_in(text, say_in("de")) == german
    assert figures_in(text, say_in("en")) == text


def test_no_german_text_has_a_number_with_a_point() -> None:
    """But for an address and a word with its bit, which are typed so."""
    typed = re.compile(r"192\.168\.7\.10|20\.7")
    texts = [m.string for path in sources() for m in catalogue(path) if m.id]
    assert [one for one in texts if re.search(r"\d\.\d", typed.sub("", one))] == []


@pytest.mark.parametrize(
    ("german", "english"),
    [
        (r"\bRolle\b", r"\broles?\b"),  # of an account; what turns is a Walze or a Wickel
        (r"\bVerzug\b", r"\bdraws?\b"),  # a delay is a Totzeit
        (r"\bTotzeit", r"\bdelay"),
        (r"\bKern\b", r"\bcore\b"),  # a kernel is a Kernel
        (r"Klebestoß|Klebestöße", r"\bsplices?\b"),
        (r"Spleiß", r"$^"),
        (r"\bPanel\b|\bSteller|Kraftmesser|Herzschlag|klingt ab", r"$^"),
        (r"Display", r"\bdisplay"),
        (r"\bAnzeige", r"\bscreen|\bpage"),
        (r"\bAusgaben?\b", r"\breleases?\b"),
    ],
)
def test_a_german_word_has_one_meaning(german: str, english: str) -> None:
    said = {m.id: m.string for path in sources() for m in catalogue(path) if m.id}
    found = {text for text, words in said.items() if re.search(german, words)}
    assert {text for text in found if not re.search(english, text)} == set()


def test_what_is_tried_is_kept_and_taken_back_in_words_of_its_own() -> None:
    """A window is *aufgehoben*: of settings that would say the opposite."""
    page = Path(aff_hmi.__file__).parent.joinpath("templates", "trying.html").read_text()
    presses = re.findall(r'data-may="(\w+)">{{ _\(\'(.*?)\'\) }}<', page)
    german = {press: say_in("de")(text) for press, text in presses}
    assert german == {"keep": "Behalten", "undo": "Zurücknehmen"}


@each_case(
    ("wanted", "accepted", "language"),
    [
        ("de", "en", "de"),
        ("", "de-AT,de;q=0.9,en;q=0.8", "de"),
        ("", "fr, en;q=0.5", "en"),
        ("../../etc", "", "en"),
        ("", "x" * 100_000, "en"),
        ("", "", "en"),
    ],
)
def test_the_readers_language_is_found(wanted: str, accepted: str, language: str) -> None:
    assert language_of(wanted, accepted, "en") == language


def _places(text: str) -> set[str]:
    assert not re.search(r"{\d*}", text)
    return {name for _, name, _, _ in string.Formatter().parse(text) if name}


def test_no_script_writes_a_number_that_is_read_but_in_the_readers_language() -> None:
    """Attributes of a drawing have points; they are of ``recent.js`` alone."""
    scripts = Path(aff_hmi.__file__).parent.joinpath("static").glob("*.js")
    pointed = re.compile(r"\.toFixed\(|\.toPrecision\(")
    assert [p.name for p in scripts if pointed.search(p.read_text())] == ["recent.js"]
