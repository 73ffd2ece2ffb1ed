"""The printed card: one file that asks for nothing, everything on it, hash and page numbers."""

import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from aff_runtime.app.card.entries import Inputs, entries_of
from aff_runtime.app.card.figures import Figure, Sample
from aff_runtime.app.card.page import page, unfinished
from aff_runtime.app.card.standing import card_of
from aff_runtime.app.card.steps import STEPS
from tests.aff_runtime.app.card.made import BAD, GOOD, INPUTS, add, book, measured, signed

VOID = {"meta", "path", "circle"}
HOSTILE = '<script>alert(1)</script>\u202e\x1b[31m" onload=x'
POINTS = Sample(
    kind="probe",
    of="unwind",
    columns=("frequency_Hz", "gain", "phase_rad", "relative_error", "coherence"),
    rows=((0.5, 90.0, -3.0, 0.05, 0.99), (4.0, 20.0, 2.5, 0.1, 0.9)),
)
DECIBELS = [
    Figure(
        name=f"order {n}",
        value=10.0 * n,
        unit="dB",
        low=10.0 * n - 1,
        high=10.0 * n + 1,
        limit="does not rise",
        good=True,
    )
    for n in (1, 2)
]


class Outline(HTMLParser):
    """Headings, tags, attributes; every tag that opens is closed in its order."""

    def __init__(self, text):
        super().__init__()
        self.headings, self.attributes, self.open, self.tags = [], [], [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [name for name, _ in attrs]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [name for name, _ in attrs]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if "h1" in self.open or "h2" in self.open:
            self.headings.append(data.strip())


@pytest.fixture
def card(tmp_path):
    made = book(tmp_path)
    add(made, signed(0, add(made, measured(0)), name=HOSTILE))
    add(made, measured(3, [BAD], remarks=(HOSTILE,), proposals=("noise_N: 1.2",)))
    add(
        made,
        measured(
            4, [Figure(name="time", value=float("nan"), limit="300 ms")], missing=("type it",)
        ),
    )
    add(made, measured(7, [GOOD], samples=(POINTS,)))
    add(made, measured(12, DECIBELS))
    return made


def shown(card, now=INPUTS, **how):
    found = card_of(entries_of(card.read()), now)
    return found, page(found, **how)


def test_the_outline_is_that_of_a_card(card):
    _, text = shown(card, replace(INPUTS, roll_id="5"))
    outline = Outline(text)
    said = " | ".join(outline.headings)
    assert said == (
        "Euclid: commissioning card | Steps | What is left to do | "
        "0. Machine: rights, processors, clock: | \u2713 pass | "
        "3. Limits, in the PLC first: | \u2717 fail | "
        "4. Watchdog of drive or gateway: | \u2026 open | "
        "7. Response at three speeds or radii, twice each: | \u2713 pass | "
        "12. Proof on the running web: off, on, off, on: | \u21bb again | "
        "Newest entry"
    )
    assert outline.tags.count("svg") == 2  # the response, and the reductions
    assert outline.open == []


def test_it_needs_nothing_from_elsewhere_and_words_act_on_nothing(card):
    _, text = shown(card)
    outline = Outline(text)
    assert not {"script", "link", "img", "iframe", "form", "object", "a"} & set(outline.tags)
    allowed = {
        "class",
        "lang",
        "charset",
        "viewbox",
        "font-size",
        "role",
        "aria-label",
        "d",
        "stroke",
        "x",
        "y",
        "cx",
        "cy",
        "r",
        "fill",
    }
    assert set(outline.attributes) <= allowed
    assert not re.search(r"https?:|url\(|@import|\u202e|\x1b", text)


@pytest.mark.parametrize(("paper", "size"), [("a4", "A4"), ("letter", "Letter")])
def test_every_sheet_has_its_number_and_the_hash_of_the_newest_entry(card, paper, size):
    found, text = shown(card, size=paper)
    style = re.search(r"<style>(.*)</style>", text)[1]
    assert f"@page{{size:{size};" in style
    assert '"page " counter(page) " of " counter(pages)' in style
    assert f'"{found.newest[:32]}\\a {found.newest[32:]}"' in style
    assert f"<code>{found.newest}</code>" in text


def test_everything_that_counts_is_on_it(card):
    found, text = shown(card)
    for step in STEPS:
        assert step.title in text
    for one in found.steps:
        if one.last is not None:
            assert one.last.sha256 in text
    assert "110 to 130" in text
    assert "120 us" in text
    assert "noise_N: 1.2" in text
    assert "seen on the drive" in text


def test_what_is_left_to_do_is_listed_and_why(card):
    found, _ = shown(card, replace(INPUTS, responses={}))
    said = list(unfinished(found))
    assert len(said) == len(STEPS) - 1  # only step 0 is passed and signed
    assert "step 3, Limits, in the PLC first: fail" in said
    assert "step 4, Watchdog of drive or gateway: open (type it)" in said
    assert any(
        text.startswith("step 7") and "again (measured responses of" in text for text in said
    )
    found, _ = shown(card)
    assert any(text.endswith("pass, not signed") for text in unfinished(found))


def test_a_step_that_was_not_measured_is_never_shown_as_measured(tmp_path):
    found, text = shown(book(tmp_path), Inputs())
    assert list(unfinished(found)) == [
        f"step {step.number}, {step.title}: not measured" for step in STEPS
    ]
    assert "section" not in Outline(text).tags
