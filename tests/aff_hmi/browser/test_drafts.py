"""What is half typed stays: over a new limit, a missed answer, a page that begins anew.

The screen server is the real one; what its commissioner tells is given.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("pyarrow")

from aff_hmi.commission.in_language import card_in
from aff_hmi.words import say_in
from aff_runtime.app.commission import views
from tests.aff_hmi.browser import staged
from tests.aff_hmi.browser.eyes import Page
from tests.aff_hmi.browser.staged import FOLLOWER, PASSWORD, Stage, ready
from tests.aff_hmi.browser.test_not_known import JOB, STATE
from tests.aff_hmi.browser.told import Told
from tests.aff_hmi.moments import LINE

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]
ENTRY = views.EntryView(
    number=4,
    utc="2026-01-05T06:00:00",
    sha256="4" * 64,
    by="carl",
    release="1",
    reason="",
    figures=(views.FigureView(name="share", value="1 %", span="", limit="", good=None),),
    missing=("a longer record",),
    proposals=("settle_s: 6 -> 5",),
    remarks=("one remark",),
    typed=(),
    windows=(),
)
STEP = views.StepView(
    number=12,
    title="Proof on the running web",
    measured="ripple",
    limit="promised",
    seconds=0.0,
    stand="again",
    why=("machine: pc 1, now pc 2",),
    typed_names=("promised", "settle"),
    earlier=0,
    can_sign=True,
    entry=ENTRY,
    signed=None,
)
CARD = views.CardView(
    line="Euclid",
    newest="3" * 64,
    entries=3,
    utc="2026-01-05T06:00:00",
    remarks=(),
    undone=(),
    steps=(STEP,),
    proof=views.ProofTimes(off_s=25.0, on_s=43.0),
)
ROW = 'details[data-step="12"]'
TYPED = f'{ROW} .measure input[name="promised"]'
REASON = f'{ROW} .signing input[name="reason"]'
NOW_OPEN = {**STATE, "job": None}


@pytest.fixture
def stage(tmp_path: Path) -> Iterator[Stage]:
    found = Stage(tmp_path, keeps=True, commission=Told())
    yield found
    found.close()


class Desk:
    """What the commissioner tells a page: a card and how it stands; None: nothing comes."""

    def __init__(self, page: Page, language: str = "en") -> None:
        self._say = say_in(language)
        self.card: views.CardView = CARD
        self.state: dict[str, Any] | None = NOW_OPEN
        page.page.route("**/data/commissioning?*", self._tell_state)
        page.page.route("**/data/card?*", self._tell_card)

    def _tell_state(self, route: Any) -> None:
        if self.state is None:
            route.abort()
        else:
            route.fulfill(json=self.state)

    def _tell_card(self, route: Any) -> None:
        route.fulfill(json={"ok": True, "card": asdict(card_in(self.card, self._say))})


def logged_in(chromium: Any, stage: Stage, name: str = "carl", language: str = "en") -> Page:
    page = Page(chromium, f"{stage.url}login", locale=language)
    log_in(page, name)
    return page


def log_in(page: Page, name: str) -> None:
    page.page.fill("#name", name)
    page.page.fill("#password", PASSWORD)
    page.page.press("#password", "Enter")
    page.await_selector("#arm")
    page.await_live()


def at_the_card(page: Page, stage: Stage) -> None:
    page.page.goto(f"{stage.url}card")
    page.await_selector(f"{ROW} .measure")
    page.page.click(f"{ROW} > summary")


def test_a_limit_that_a_try_changes_is_filled_in_and_nothing_begins_anew(
    chromium, stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = logged_in(chromium, stage)
    stage.show(ready())
    page.page.click("#take")
    page.run("() => { window.stays = 'the same page'; }")
    limits = "() => [...document.querySelectorAll('.limit')].map(one => one.textContent)"
    assert page.run(limits) == ["150", "40"]
    tried = replace(LINE, outputs=(replace(LINE.outputs[0], limit=0.0025), FOLLOWER))
    monkeypatch.setattr(staged, "SITE", tried)
    stage.show(ready())
    page.page.wait_for_function(f"() => ({limits})()[0] === '2.5'")
    page.await_selector('#arm[aria-disabled="false"]')
    page.page.hover("#arm")
    page.page.mouse.down()
    said = page.text("#hand-said")
    page.page.mouse.up()
    assert "unwind ≤ 2.5 mm/s, swrap follower ≤ 40 mm/s, configuration " in said
    assert page.run("() => window.stays") == "the same page"
    assert page.complaints == []
    page.close()


def test_another_line_speed_moves_the_times_of_the_proof_and_no_field(
    chromium, stage: Stage
) -> None:
    page = logged_in(chromium, stage)
    desk = Desk(page)
    at_the_card(page, stage)
    assert page.text(f"{ROW} .times").startswith("off for 25 s, on for 43 s")
    page.page.fill(TYPED, "12")
    page.run(f"() => {{ document.querySelector('{TYPED}').mine = true; }}")
    desk.card = replace(CARD, proof=views.ProofTimes(off_s=250.0, on_s=268.0))
    page.page.wait_for_function(
        f"() => document.querySelector('{ROW} .times').textContent.startsWith('off for 250 s')"
    )
    desk.card = replace(CARD, proof=None)
    page.page.wait_for_function(f"() => document.querySelector('{ROW} .times').textContent === ''")
    assert page.run(f"() => document.querySelector('{TYPED}').mine") is True
    assert page.page.input_value(TYPED) == "12"
    assert page.run("() => document.activeElement.name") == "promised"
    page.close()


def test_a_missed_answer_of_the_commissioner_empties_no_form_and_sends_nothing(
    chromium, stage: Stage
) -> None:
    page = logged_in(chromium, stage)
    desk = Desk(page)
    at_the_card(page, stage)
    page.page.fill(TYPED, "12 dB")
    page.run(f"() => {{ document.querySelector('{TYPED}').mine = true; }}")
    desk.state = None
    page.await_selector("#work-silent:not([hidden])")
    page.await_selector(f"{ROW} .measure button[type=submit]:disabled")
    assert page.run(f"() => document.querySelector('{TYPED}').mine") is True
    desk.state = NOW_OPEN
    page.await_selector(f"{ROW} .measure button[type=submit]:enabled")
    assert page.run(f"() => document.querySelector('{TYPED}').mine") is True
    assert page.page.input_value(TYPED) == "12 dB"
    page.close()


def test_what_is_half_typed_on_the_card_outlives_page_and_session_until_it_is_sent(
    chromium, stage: Stage
) -> None:
    page = logged_in(chromium, stage)
    desk = Desk(page)
    at_the_card(page, stage)
    page.page.fill(TYPED, "12 dB")
    page.page.fill(REASON, "seen with two witn")
    page.page.fill(f'{ROW} .signing input[name="password"]', "secret words")
    desk.state = {**NOW_OPEN, "is_open": False}  # nobody has pressed for 15 min
    page.page.wait_for_selector(f"{ROW} .measure", state="detached")
    desk.state = NOW_OPEN
    page.await_selector(f"{ROW} .measure")
    assert page.page.input_value(TYPED) == "12 dB"
    page.page.context.clear_cookies()  # the session has ended
    page.page.reload()
    assert "secret words" not in page.run("() => JSON.stringify({...sessionStorage})")
    page.page.goto(f"{stage.url}login")
    log_in(page, "anna")
    at_the_card(page, stage)
    assert page.page.input_value(TYPED) == ""  # of another account
    page.page.context.clear_cookies()
    page.page.goto(f"{stage.url}login")
    log_in(page, "carl")
    at_the_card(page, stage)
    assert page.page.input_value(TYPED) == "12 dB"
    assert page.page.input_value(REASON) == "seen with two witn"
    page.page.route("**/card/step?*", lambda route: route.fulfill(json={"ok": True, "text": ""}))
    page.page.click(f"{ROW} .measure button[type=submit]")
    page.page.wait_for_function(f"() => document.querySelector('{TYPED}').value === ''")
    page.page.reload()
    page.await_selector(f"{ROW} .measure")
    assert page.page.input_value(TYPED) == ""
    assert page.page.input_value(REASON) == "seen with two witn"
    page.page.click("#logout")
    page.await_selector('a[href^="/login"]')
    assert page.run("() => Object.keys(sessionStorage)") == []
    page.close()


def test_an_answer_that_is_half_typed_outlives_the_page(chromium, stage: Stage) -> None:
    page = logged_in(chromium, stage)
    desk = Desk(page)
    desk.state = {**STATE, "job": JOB}
    page.page.goto(f"{stage.url}commission")
    page.await_selector("#question:not([hidden])")
    page.page.fill("#answer", "4.")
    page.page.reload()  # as it does by itself where the screen server has begun anew
    page.await_selector("#question:not([hidden])")
    assert page.page.input_value("#answer") == "4."
    another = {**JOB, "ask": {**JOB["ask"], "number": 4, "name": "speed_min"}}  # type: ignore[dict-item]
    desk.state = {**STATE, "job": another}
    page.page.wait_for_function(
        "() => document.getElementById('question').dataset.name === 'speed_min'"
    )
    assert page.page.input_value("#answer") == ""
    page.close()


def test_on_a_german_card_only_what_is_english_is_marked_as_english(
    chromium, stage: Stage
) -> None:
    page = logged_in(chromium, stage, language="de")
    Desk(page, "de")
    at_the_card(page, stage)
    told = ", ".join(f"{ROW} {one}" for one in ("li", "th", "td"))
    english = f"""() => Object.fromEntries([...document.querySelectorAll('{told}')]
      .filter(one => one.textContent)
      .map(one => [one.textContent, one.closest('[lang]').lang]))"""
    assert page.run(english) == {
        "Rechner: pc 1, jetzt pc 2": "de",
        "Größe": "de",
        "Wert": "de",
        "95 %, oder Fehler": "de",
        "Grenze": "de",
        "share": "en",
        "1 %": "en",
        "a longer record": "en",
        "settle_s: 6 -> 5": "en",
        "one remark": "en",
    }
    page.close()


def test_the_key_of_the_first_choice_finds_one_that_is_seen_and_the_tenth_and_settings_have_keys(
    chromium, stage: Stage
) -> None:
    page = logged_in(chromium, stage)
    desk = Desk(page)
    desk.state = {**NOW_OPEN, "is_open": False}
    page.page.goto(f"{stage.url}commission")
    page.await_selector("#open:not([hidden])")
    page.page.keyboard.press("/")
    assert page.run("() => document.activeElement.id") == "open-password"
    page.run("() => document.activeElement.blur()")
    for key, path in (("0", "/maintenance"), ("s", "/settings"), ("7", "/commission")):
        page.page.keyboard.press("g")
        page.page.keyboard.press(key)
        page.page.wait_for_url(f"**{path}?*")
        page.await_live()
    assert page.page.inner_text("#help kbd:text-is('s')", timeout=1000) is not None
    page.close()
