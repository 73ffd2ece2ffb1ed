"""No word is missing in any language, and none is left over."""

from __future__ import annotations

import re
import string

import pytest

from aff_hmi.words import LANGUAGES, language_of, say_in
from tests.aff_hmi.msgids import all_texts

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


@pytest.mark.parametrize(
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
