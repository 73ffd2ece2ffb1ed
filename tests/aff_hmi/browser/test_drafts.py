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

from aff_hmi.commission.in_language import line_in
from aff_hmi.words import say_in
from aff_runtime.app.commission.views import of_line as views
from tests.aff_hmi.browser import staged
from tests.aff_hmi.browser.desk import (
    CARD,
    ENTRY,
    LINE_VIEW,
    NOW_OPEN,
    PROBE_ROWS,
    STEP,
    Desk,
    asking,
    last,
)
from tests.aff_hmi.browser.eyes import Page
from tests.aff_hmi.browser.staged import FOLLOWER, PASSWORD, Stage, ready
from tests.aff_hmi.browser.test_not_known import JOB, STATE
from tests.aff_hmi.browser.told import Told
from tests.aff_hmi.moments import LINE

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]
ROW = 'details[data-step="12"]'
TYPED = f'{ROW} .measure input[name="promised"]'
REASON = f'{ROW} .signing input[name="reason"]'
DAY_MS = 24 * 3600 * 1000


@pytest.fixture
def stage(tmp_path: Path) -> Iterator[Stage]:
    found = Stage(tmp_path, keeps=True, commission=Told())
    yield found
    found.close()


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
    desk.run(last("step", 12, is_ok=True))
    page.page.wait_for_function(f"() => document.querySelector('{TYPED}').value === ''")
    page.page.reload()
    page.await_selector(f"{ROW} .measure")
    assert page.page.input_value(TYPED) == ""
    assert page.page.input_value(REASON) == "seen with two witn"
    page.page.click("#logout")
    page.await_selector('a[href^="/login"]')
    assert page.run("() => Object.keys(sessionStorage)") == []
    page.close()


def test_what_a_job_refuses_stays_typed_and_what_it_does_is_dropped(
    chromium, stage: Stage
) -> None:
    page = logged_in(chromium, stage)
    desk = Desk(page)
    at_the_card(page, stage)
    page.page.route("**/card/step?*", lambda route: route.fulfill(json={"ok": True, "text": ""}))
    measure = f"{ROW} .measure button[type=submit]"
    desk.state = {**NOW_OPEN, "last": last("step", 12, is_ok=True)}  # of the job before
    page.page.fill(TYPED, "12,5")
    page.page.click(measure)
    desk.run(last("step", 12, is_ok=False))
    assert page.page.input_value(TYPED) == "12,5"
    page.page.reload()
    page.await_selector(f"{ROW} .measure")
    assert page.page.input_value(TYPED) == "12,5"
    page.page.click(f"{ROW} > summary")
    page.page.click(measure)
    page.page.wait_for_selector("#work-said:has-text('sent; wait')", state="detached")
    page.page.fill(TYPED, "13")
    desk.run(last("step", 12, is_ok=True))
    assert page.page.input_value(TYPED) == "13"  # typed while the job ran: nobody has sent it
    page.page.click(measure)
    desk.run(last("step", 12, is_ok=True))
    page.page.wait_for_function(f"() => document.querySelector('{TYPED}').value === ''")
    page.close()


def test_what_is_half_typed_is_of_its_card_its_entry_and_its_day(chromium, stage: Stage) -> None:
    page = logged_in(chromium, stage)
    desk = Desk(page)
    at_the_card(page, stage)
    tried = f'{ROW} .trying input[name="reason"]'
    for field in (TYPED, REASON, tried):
        page.page.fill(field, "seen with two witnesses")
    values = (
        f"() => ['{TYPED}', '{REASON}', '{tried}'].map(one => document.querySelector(one).value)"
    )
    desk.card = replace(CARD, steps=(replace(STEP, entry=replace(ENTRY, sha256="5" * 64)),))
    page.page.wait_for_function(
        f"() => document.querySelector('{ROW} .hash').textContent.includes('555')"
    )
    assert page.run(values) == ["seen with two witnesses", "", ""]
    desk.card = replace(CARD, first="9" * 64)
    page.page.wait_for_function(
        f"() => document.querySelector('{ROW} .hash').textContent.includes('444')"
    )
    assert page.run(values) == ["", "seen with two witnesses", "seen with two witnesses"]
    desk.card = CARD
    page.page.reload()
    page.await_selector(f"{ROW} .measure")
    assert page.run(values) == ["seen with two witnesses"] * 3
    page.run(f"""() => {{ for (const [name, said] of Object.entries({{...sessionStorage}}))
      sessionStorage.setItem(name, said.replace(/^[0-9]+/, at => Number(at) - {DAY_MS})); }}""")
    page.page.reload()
    page.await_selector(f"{ROW} .measure")
    assert page.run(values) == [""] * 3
    assert page.run("() => Object.keys(sessionStorage)") == []
    page.close()


def test_the_reason_for_one_try_is_not_offered_for_the_next(chromium, stage: Stage) -> None:
    page = logged_in(chromium, stage)
    desk = Desk(page)

    def trying(sha256: str) -> dict[str, Any]:
        service = {**NOW_OPEN["service"], "trying": f"settings {sha256[:2]}", "tried": sha256}  # type: ignore[dict-item]
        return {**NOW_OPEN, "service": service, "left_s": 40}

    desk.state = trying("7" * 64)
    page.page.goto(f"{stage.url}card")
    page.await_selector("#trying:not([hidden])")
    page.page.fill("#tried-why", "ripple fell by 30 dB")
    page.page.reload()
    page.await_selector("#trying:not([hidden])")
    assert page.page.input_value("#tried-why") == "ripple fell by 30 dB"
    desk.state = trying("8" * 64)
    page.await_selector("#tried:has-text('settings 88')")
    assert page.page.input_value("#tried-why") == ""
    page.close()


def test_of_an_exchange_only_the_reason_is_kept(chromium, stage: Stage) -> None:
    page = logged_in(chromium, stage)
    desk = Desk(page)
    page.page.goto(f"{stage.url}maintenance")
    page.await_selector("#exchange:not([hidden])")
    page.await_selector("#exchange-roll option")
    shown = "() => ['on', 'why'].map(one => document.getElementById(`exchange-${one}`).value)"
    typed = ["2026-01-20T08:30", "serial 4712"]
    page.page.fill("#exchange-on", typed[0])
    page.page.fill("#exchange-why", typed[1])
    page.page.reload()
    page.await_selector("#exchange:not([hidden])")
    page.await_selector("#exchange-roll option")
    assert page.run(shown) == ["", typed[1]]  # an exchange cannot be taken back
    page.page.fill("#exchange-on", typed[0])
    page.page.click("#exchange button[type=submit]")
    desk.run(last("exchange", -1, is_ok=False))
    assert page.run(shown) == typed
    page.page.click("#exchange button[type=submit]")
    desk.run(last("exchange", -1, is_ok=True))
    page.page.wait_for_function("() => document.getElementById('exchange-why').value === ''")
    assert page.run(shown) == ["", ""]
    page.close()


def test_another_line_speed_leaves_open_what_probes_have_found(chromium, stage: Stage) -> None:
    page = logged_in(chromium, stage)
    Desk(page)
    now = {"line": LINE_VIEW}
    page.page.route(
        "**/data/line?*",
        lambda route: route.fulfill(
            json={"ok": True, "line": asdict(line_in(now["line"], say_in("en")))}
        ),
    )
    page.page.goto(f"{stage.url}commission")
    page.await_selector("#found .response")
    page.page.click("#found summary")
    page.run("() => { document.querySelector('#found details').mine = true; }")
    (row,) = PROBE_ROWS
    probe = replace(LINE_VIEW.probe, rows=(replace(row, amplitude=0.0123),))  # type: ignore[type-var]
    now["line"] = replace(LINE_VIEW, probe=probe)
    page.await_selector("#bounds:has-text('0.0123')")
    details = "document.querySelector('#found details')"
    assert page.run(f"() => [{details}.mine, {details}.open]") == [True, True]
    again = replace(LINE_VIEW.responses[0], measured_at="2026-01-06T06:00:00")
    now["line"] = replace(LINE_VIEW, responses=(again,))
    page.await_selector("#found .title:has-text('2026-01-06')")
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
    desk.state = {**STATE, "job": asking(3, text="Höchste Geschwindigkeit")}
    page.page.goto(f"{stage.url}commission?lang=de")
    page.await_selector("#asked:has-text('Höchste')")
    assert page.page.input_value("#answer") == "4."
    page.page.route(
        "**/commission/answer?*", lambda route: route.fulfill(json={"ok": True, "text": ""})
    )
    page.page.press("#answer", "Enter")
    refused = [{"kind": "complain", "text": "a unit is missing"}]
    desk.state = {**STATE, "job": {**asking(4), "said": refused}}
    page.await_selector("#refused:has-text('a unit is missing')")
    assert page.page.input_value("#answer") == "4."
    page.page.press("#answer", "Enter")
    desk.state = {**STATE, "job": asking(5)}  # taken, and asked for once more
    page.page.wait_for_function("() => document.getElementById('answer').value === ''")
    another = {**JOB, "ask": {**JOB["ask"], "number": 6, "name": "speed_min"}}  # type: ignore[dict-item]
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
