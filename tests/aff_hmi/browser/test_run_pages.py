"""Refining and maintenance in a real browser: four widths, two languages, hands, what is stale.

The screen server is the real one; what a commissioner tells is given.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("pyarrow")

from aff_hmi import doorkeeper
from aff_runtime.app.commission.views import of_line as views
from aff_runtime.app.hand.may import Role
from tests.aff_hmi.browser.axe import grave_findings
from tests.aff_hmi.browser.eyes import Page
from tests.aff_hmi.browser.staged import PASSWORD, Stage
from tests.aff_hmi.browser.test_looks import looked_at
from tests.aff_hmi.browser.told import PROPOSAL, RUNS, TRIED, Told, running

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]
WIDTHS = {360: 740, 768: 1024, 1280: 800, 1920: 1080}
SHOWN = {"refine": "#one-body .effect", "maintenance": "#chart canvas"}
STANDS = "performance.now = () => 1000"
LOOKS = list(product(SHOWN, WIDTHS, ("en", "de")))
DRESS = {"en": "light", "de": "dark"}


@pytest.fixture(scope="module")
def told() -> Told:
    return Told()


@pytest.fixture(scope="module")
def stage(told: Told, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stage]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(doorkeeper, "PER_ACCOUNT", 1000)
        patch.setattr(doorkeeper, "PER_ADDRESS", 1000)
        found = Stage(tmp_path_factory.mktemp("runs"), keeps=True, commission=told)
        yield found
        found.close()


@pytest.fixture(autouse=True)
def _quiet(told: Told) -> None:
    told.is_there, told.long, told.last, told.trying = True, None, None, ""
    told.job = None
    told.said.clear()


class Carl:
    """Somebody of role commission at a page."""

    def __init__(self, chromium: Any, stage: Stage, first: str = "", **context: Any) -> None:
        self.stage = stage
        self.screen = Page(chromium, f"{stage.url}login", first, **context)
        self.page = self.screen.page
        self.page.fill("#name", "carl")
        self.page.fill("#password", PASSWORD)
        self.page.press("#password", "Enter")
        self.screen.await_selector("#arm")

    def go(self, path: str, shows: str = "") -> None:
        self.page.goto(f"{self.stage.url}{path}")
        is_shown = "refining" if path.startswith("refine") else "maintenance"
        self.page.wait_for_selector(f"html[data-{is_shown}=shown]")
        if shows:
            self.page.wait_for_selector(shows, state="attached")

    def open(self) -> None:
        if self.page.is_visible("#open"):
            self.page.fill("#open-password", PASSWORD)
            self.page.press("#open-password", "Enter")
        self.page.wait_for_selector("#opened:not([hidden])")


@pytest.mark.parametrize(("name", "width", "language"), LOOKS)
def test_it_fits_is_readable_and_stays_on_the_host(
    chromium, stage: Stage, pictures: Path, name: str, width: int, language: str
) -> None:
    view = {"width": width, "height": WIDTHS[width]}
    given = {"viewport": view, "locale": language, "color_scheme": DRESS[language]}
    carl = Carl(chromium, stage, **given)
    carl.go("refine#8" if name == "refine" else name, SHOWN[name])
    carl.open()
    if name == "refine":
        carl.page.click(f'#runs button[aria-label$="{RUNS[2]}"]')
    carl.screen.picture(pictures / f"{name}-{width}-{language}.png")
    looked_at(carl.screen, width)
    if width in (360, 1280):
        assert grave_findings(carl.page) == []
    assert carl.screen.complaints == []
    assert {re.sub(r"/[^/]*$", "", url) for url in carl.screen.requests} <= {
        stage.url.rstrip("/"),
        f"{stage.url}static",
        f"{stage.url}data",
        f"{stage.url}commission",
    }
    carl.screen.close()


def test_windows_are_chosen_looked_at_and_refined_with(chromium, stage: Stage, told: Told) -> None:
    carl = Carl(chromium, stage, locale="en")
    page = carl.page
    carl.go("refine")
    assert page.is_hidden("#look")
    carl.open()
    for name in RUNS[:2]:
        page.click(f'#runs button[aria-label$="{name}"]')
    first, second = page.query_selector_all("#chosen .chosen")
    first.query_selector('[name="from"]').fill("2:00")
    first.query_selector('[name="to"]').fill("12:00")
    assert second.query_selector("select").input_value() == "judge"
    page.click("#look")
    page.wait_for_function("() => document.getElementById('work-said').textContent === 'done'")
    page.click("#refine")
    page.wait_for_function("() => true")
    page.wait_for_timeout(500)
    asked = [one for one in told.said if one.do in ("lacks", "refine")]
    assert [one.do for one in asked] == ["lacks", "refine"]
    assert {(one.windows, one.holdout) for one in asked} == {(f"{RUNS[0]}@2:00..12:00", RUNS[1])}
    assert carl.screen.complaints == []
    carl.screen.close()


def test_what_runs_is_there_again_after_a_reload_and_can_be_stopped(
    chromium, stage: Stage, told: Told, pictures: Path
) -> None:
    told.long = running("simulating the declared line", "R6: score 981535")
    carl = Carl(chromium, stage, locale="en", viewport={"width": 1280, "height": 800})
    carl.go("refine", "#long:not([hidden])")
    carl.open()
    carl.page.reload()
    carl.page.wait_for_selector("#long:not([hidden]) li >> nth=1")
    assert "12 min" in carl.screen.text("#long-for")
    carl.screen.picture(pictures / "refine-running.png")
    carl.page.click("#long-stop")
    carl.page.wait_for_function(
        "() => document.getElementById('work-said').textContent === 'done'"
    )
    assert [one.do for one in told.said][-1] == "stop_long"
    told.last = views.LastJob(do="refine", step=-1, ok=True, text="refinement 8: Traced: R6.")
    told.long = None
    carl.page.wait_for_selector("#long[hidden]", state="attached")
    carl.page.wait_for_function(
        "() => document.getElementById('long-last').textContent.includes('refinement 8')"
    )
    carl.screen.close()


def test_what_is_proposed_is_tried_with_the_hand_and_kept_with_a_reason(
    chromium, stage: Stage, told: Told, pictures: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    settings = replace(stage.desk.rules, ceiling=Role.COMMISSION)
    monkeypatch.setattr(stage.desk, "rules", settings)
    carl = Carl(chromium, stage, locale="en", viewport={"width": 1280, "height": 800})
    page = carl.page
    carl.go("refine")
    carl.open()
    page.click('#refined button[aria-label$=": 8"]')
    page.wait_for_selector("#try-refined")
    page.fill('#try-refined [name="reason"]', "the idler is named")
    press = "#try-refined button[type=submit]"
    page.wait_for_selector(f'{press}[disabled][title="take the hand first"]')
    page.click("#take")
    page.wait_for_selector("#release:not([hidden])")
    page.wait_for_selector(f"{press}:not([disabled])")
    page.click(press)
    page.wait_for_function("() => document.getElementById('work-said').textContent === 'done'")
    tried = told.said[-1]
    assert (tried.do, tried.number, tried.measured) == ("try_refined", 8, PROPOSAL.sha256)
    assert (tried.seconds, tried.reason) == (120, "the idler is named")
    told.trying = "settings 3f3f3f3f3f3f by carl"
    calm = stage.watch.moment
    assert calm.facts is not None
    status = replace(calm.facts.status, trying=told.trying)
    stage.show(replace(calm, facts=replace(calm.facts, status=status)))
    page.wait_for_selector("#trying:not([hidden])")
    page.wait_for_selector('#trying button[value="keep"]:not([disabled])')
    carl.screen.picture(pictures / "refine-trying.png")
    page.fill("#tried-why", "ripple fell by 30 dB")
    page.click('#trying button[value="keep"]')
    page.wait_for_timeout(500)
    kept = told.said[-1]
    assert (kept.do, kept.reason, kept.measured) == ("keep", "ripple fell by 30 dB", TRIED)
    page.click("#release")
    carl.screen.close()
    stage.calm()


def test_what_is_missing_is_said_with_the_command_for_another_machine(
    chromium, stage: Stage, told: Told, pictures: Path
) -> None:
    kept = told.refining
    told.refining = replace(
        kept,
        missing=("/line.yaml: the line file is not there; copy yours there",),
        runs=(),
        lacking=None,
        refined=(),
    )
    try:
        carl = Carl(chromium, stage, locale="de", viewport={"width": 768, "height": 1024})
        carl.go("refine", "#missing li")
        assert "die Modelldatei ist nicht da" in carl.screen.text("#missing")
        assert "sim-plant refine" in carl.screen.text("#command")
        carl.screen.picture(pictures / "refine-missing.png")
        looked_at(carl.screen, 768)
        carl.screen.close()
    finally:
        told.refining = kept


def test_an_exchange_is_noted_at_a_moment_of_the_browsers_clock(
    chromium, stage: Stage, told: Told
) -> None:
    carl = Carl(chromium, stage, locale="en", timezone_id="Europe/Berlin")
    page = carl.page
    carl.go("maintenance", "#lives td")
    assert page.is_hidden("#exchange")
    carl.open()
    page.wait_for_selector("#exchange:not([hidden])")
    page.select_option("#exchange-roll", "r6")
    page.fill("#exchange-on", "2026-01-20T08:30")
    page.fill("#exchange-why", "serial 4712")
    page.click("#exchange button[type=submit]")
    page.wait_for_function("() => document.getElementById('work-said').textContent === 'done'")
    said = told.said[-1]
    assert (said.do, said.roll, said.reason) == ("exchange", "r6", "serial 4712")
    assert said.on == "2026-01-20T07:30:00.000Z"
    page.click("#read")
    page.wait_for_timeout(500)
    assert told.said[-1].do == "add_runs"
    carl.screen.close()


def test_every_trend_has_a_table_behind_its_curve_and_keys_are_enough(
    chromium, stage: Stage, told: Told
) -> None:
    carl = Carl(chromium, stage, locale="en")
    page = carl.page
    carl.go("maintenance", "#chart canvas")
    page.focus("#trends tr:nth-child(2) button")
    page.keyboard.press("Enter")
    assert page.evaluate("() => document.activeElement.id") == "trend-title"
    page.focus("#as-table summary")
    page.keyboard.press("Enter")
    count = len(told.maintenance.trends[0].readings)
    assert page.evaluate("() => document.querySelectorAll('#table tr').length") == count + 1
    page.keyboard.press("g")
    page.keyboard.press("9")
    page.wait_for_selector("html[data-refining=shown]")
    page.keyboard.press("g")
    page.keyboard.press("0")
    page.wait_for_selector("html[data-maintenance=shown]")
    carl.screen.close()


@pytest.mark.parametrize("name", SHOWN)
def test_without_a_commissioner_it_is_said_since_when_what_is_shown_is_old(
    chromium, stage: Stage, told: Told, name: str
) -> None:
    carl = Carl(chromium, stage, locale="en")
    carl.go(name)
    carl.page.wait_for_selector("#seen-at:not(.bad)")
    told.is_there = False
    carl.page.wait_for_selector("#work-silent:not([hidden])")
    carl.page.wait_for_selector("#seen-at.bad", timeout=60_000)
    assert "no answer since" in carl.screen.text("#seen-at")
    carl.screen.close()


def test_an_answer_that_is_not_taken_says_why_beside_the_question(
    chromium, stage: Stage, told: Told
) -> None:
    ask = views.QuestionView(number=3, name="port", text="Port", default="", choices=(), rows=())
    complaint = views.SaidLine(kind="complain", text='"abc": write a whole number, 1 to 65535.')
    carl = Carl(chromium, stage, viewport={"width": 360, "height": 740}, locale="en")
    carl.page.goto(f"{stage.url}commission")
    carl.page.wait_for_selector("#open:not([hidden]), #opened:not([hidden])")
    carl.open()
    assert carl.page.is_visible("#find-words")
    told.job = views.JobView(do="words", step=-1, said=(complaint,), ask=ask)
    carl.page.wait_for_selector("#question:not([hidden])")
    assert carl.page.inner_text("#question #refused") == complaint.text
    assert not carl.page.is_visible("#find-words")  # one interview at a time
    told.job = replace(told.job, said=(), ask=replace(ask, number=4))
    carl.page.wait_for_function("() => document.getElementById('refused').textContent === ''")
    assert carl.screen.complaints == []
    carl.screen.close()
