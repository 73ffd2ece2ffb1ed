"""The hand in a real browser: a login, bypass by key, the reason on the button, two people."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from aff_runtime.app.hand.accounts import Account, secret_of
from aff_runtime.app.hand.may import Role
from tests.aff_hmi.browser.axe import grave_findings
from tests.aff_hmi.browser.conftest import PATIENCE_S, Screen
from tests.aff_hmi.browser.eyes import Page
from tests.aff_hmi.browser.sights import CLIPPED, CONTRAST, MIN_CONTRAST, OVERLAPS, SMALL
from tests.aff_runtime.app.service_run import ServiceRun
from tests.processes import until

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]
PASSWORD = "tension, 90 N"
SWALLOWED = ("no fresh data", "nothing was done", "let go")
NAMES = ("anna", "bert", "dora")  # five logins a minute are heard of one


@pytest.fixture(scope="module")
def with_hand(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Screen]:
    """A screen that may arm, of a service that hears it."""
    folder = tmp_path_factory.mktemp("hand")
    (folder / "state").mkdir()
    service = ServiceRun(
        *(folder, "--hand", "operate", "--state-dir", str(folder / "state")),
        patience_s=PATIENCE_S,
        cycle_ms=5,
    )
    accounts = folder / "accounts"
    secret = secret_of(PASSWORD)
    rows = [Account(name=name, role=Role.OPERATE, secret=secret).line for name in NAMES]
    accounts.write_text("\n".join(rows) + "\n")
    accounts.chmod(0o600)
    hand = str(service.runtime_dir / "hand.sock")
    screen = Screen(service, "--hand-socket", hand, "--accounts", str(accounts))
    yield screen
    screen.close()
    service.close()


def logged_in(chromium: object, screen: Screen, name: str, **context: object) -> Page:
    """Return the overview of somebody who has typed name and password."""
    page = Page(chromium, f"{screen.url}login", **context)
    page.page.fill("#name", name)
    page.page.fill("#password", PASSWORD)
    page.page.press("#password", "Enter")
    page.await_selector("#arm")
    page.await_live()
    return page


def test_bypass_is_one_key_and_is_done_when_the_line_shows_it(chromium, with_hand: Screen) -> None:
    page = logged_in(chromium, with_hand, "anna")
    page.page.keyboard.press("F9")
    page.await_selector("html[data-state='BYPASS']")
    until("bypassed", lambda: with_hand.service.status()["state"] == "BYPASS")


def test_the_place_on_a_page_is_kept_by_way_of_language_and_login(
    chromium, with_hand: Screen
) -> None:
    page = Page(chromium, f"{with_hand.url}rolls?lang=en#unwind%20unwind")
    page.await_live()
    page.page.click("#language")
    page.page.wait_for_url("**/rolls?lang=de#unwind%20unwind")
    page.await_live()
    page.page.click(".who a.button")
    page.page.wait_for_url("**/login?lang=de&from=/rolls#unwind%20unwind")
    page.page.fill("#name", "bert")
    page.page.fill("#password", PASSWORD)
    page.page.press("#password", "Enter")
    page.page.wait_for_url("**/rolls?lang=de#unwind%20unwind")
    page.close()


def held(page: Page, button: str) -> None:
    """Hold a button long enough, again where a busy machine made the page stale."""
    before = page.page.text_content("#hand-said")
    page.page.wait_for_selector(f"{button}:enabled")
    page.page.hover(button)
    for _ in range(10):
        page.page.mouse.down()
        page.page.wait_for_timeout(1500)
        page.page.mouse.up()
        now = page.page.text_content("#hand-said")
        if now not in (before, "") and not any(one in now for one in SWALLOWED):
            return
    raise AssertionError(f"{button} could not be held")


def take_the_hand(page: Page) -> None:
    """Take it, over from whoever has it: a second press does that."""
    page.page.click("#take")
    page.page.wait_for_selector("#release:not([hidden]), #take[data-do='take over']")
    if page.page.is_hidden("#release"):
        page.page.click("#take")
    page.page.wait_for_selector("#release:not([hidden])")


def said(page: Page, words: str) -> None:
    """Wait until the page says something of a press."""
    page.page.wait_for_function(
        f"() => document.getElementById('hand-said').textContent.includes({json.dumps(words)})"
    )


def test_of_a_silent_plc_arm_says_so_itself(chromium, with_hand: Screen) -> None:
    page = Page(chromium, with_hand.url, locale="en")
    page.await_live()
    with_hand.service.tell_plc("freeze")
    try:
        page.page.wait_for_function(
            "() => document.documentElement.dataset.broken === 'plc' && "
            "document.getElementById('arm-why').textContent.includes('PLC_STALE')"
        )
    finally:
        with_hand.service.tell_plc("thaw")
    page.close()


def test_shadow_begins_and_ends_and_a_roll_is_forgotten_by_holding(
    chromium, with_hand: Screen
) -> None:
    page = logged_in(chromium, with_hand, "dora", locale="en")
    take_the_hand(page)
    page.page.goto(f"{with_hand.url}timing")
    page.await_live()
    page.page.wait_for_function(
        "() => document.getElementById('end-shadow-why').textContent === 'it is not in shadow'"
    )
    assert page.page.is_disabled("#end-shadow")
    held(page, "#shadow")
    page.await_selector("html[data-state='SHADOW']")
    said(page, "done, and seen in the line")
    assert with_hand.service.status()["state"] == "SHADOW"
    held(page, "#end-shadow")
    page.page.wait_for_function("() => document.documentElement.dataset.state !== 'SHADOW'")
    said(page, "done, and seen in the line")
    page.page.goto(f"{with_hand.url}rolls")
    page.await_live()
    held(page, "#forget")
    said(page, "done")
    page.page.keyboard.press("F9")
    page.await_selector("html[data-state='BYPASS']")
    page.close()


def test_at_the_panel_bypass_needs_no_login_and_everything_else_does(
    chromium, with_hand: Screen
) -> None:
    page = Page(chromium, f"{with_hand.url}timing", locale="en")
    page.await_live()
    assert page.page.is_enabled("#bypass")
    for button in ("#arm", "#shadow", "#end-shadow"):
        assert page.page.is_disabled(button)
    page.page.click("#bypass")
    said(page, "done, and seen in the line")
    assert with_hand.service.status()["state"] == "BYPASS"
    page.close()


@pytest.mark.parametrize("path", ["", "alarms", "rolls", "trends", "scope", "timing"])
def test_a_bypass_is_confirmed_on_every_page(chromium, with_hand: Screen, path: str) -> None:
    page = Page(chromium, with_hand.url + path, locale="en")
    page.await_live()
    bypass_is_seen(page)
    assert page.complaints == []
    page.close()


def bypass_is_seen(page: Page) -> None:
    """Press it, again where a busy machine made the line show it too late."""
    for _ in range(5):
        page.page.keyboard.press("F9")
        page.page.wait_for_function(
            "() => /seen in the line|NOT CONFIRMED|does not answer/"
            ".test(document.getElementById('hand-said').textContent)"
        )
        if "BYPASS: done, and seen in the line" in str(page.page.text_content("#hand-said")):
            return
    raise AssertionError(page.page.text_content("#hand-said"))


@pytest.mark.parametrize(("width", "dress"), [(360, ("de", "dark")), (1280, ("en", "light"))])
@pytest.mark.parametrize("name", ["timing", "rolls"])
def test_its_other_commands_fit_and_can_be_read(
    chromium, with_hand: Screen, pictures: Path, name: str, width: int, dress: tuple[str, str]
) -> None:
    language, theme = dress
    view = {"width": width, "height": 800}
    page = Page(chromium, with_hand.url + name, viewport=view, locale=language, color_scheme=theme)
    page.await_live()
    page.await_selector(".held-button")
    page.picture(pictures / f"hand-{name}-{width}-{language}-{theme}.png")
    assert page.run("() => document.documentElement.scrollWidth") <= width
    ratio, where = page.run(CONTRAST)
    assert ratio >= MIN_CONTRAST, where
    for found in (SMALL, CLIPPED, OVERLAPS):
        assert page.run(found) == []
    assert grave_findings(page.page) == []
    assert page.complaints == []
    page.close()


def test_two_keys_go_to_a_page_and_one_to_its_first_choice(chromium, with_hand: Screen) -> None:
    page = Page(chromium, with_hand.url, locale="en")
    page.await_live()
    for key, path in (("4", "/trends"), ("2", "/alarms"), ("1", "/")):
        page.page.keyboard.press("g")
        page.page.keyboard.press(key)
        page.page.wait_for_url(lambda url, path=path: url.partition("?")[0].endswith(path))
        page.await_live()
    page.page.keyboard.press("3")  # a digit alone is nothing
    page.page.keyboard.press("g")
    page.page.keyboard.press("9")  # nor is a page that there is not
    assert page.page.url.partition("?")[0] == with_hand.url
    page.page.goto(f"{with_hand.url}alarms")
    page.await_live()
    page.page.keyboard.press("/")
    assert page.run("() => document.activeElement.id") == "kind"
    page.page.keyboard.press("g")
    page.page.keyboard.press("1")
    assert "/alarms" in page.page.url  # what is pressed in a field is for the field
    page.close()


def test_the_reason_stands_on_the_button_and_the_hand_changes_hands(
    chromium, with_hand: Screen
) -> None:
    anna = logged_in(chromium, with_hand, "anna")
    bert = logged_in(chromium, with_hand, "bert")
    take_the_hand(anna)
    wanted = json.dumps("anna has the hand")
    bert.page.wait_for_function(
        f"() => document.getElementById('arm-why').textContent.startsWith({wanted})"
    )
    bert.page.click("#take")
    bert.page.wait_for_selector("#take[data-do='take over']")
    anna.page.click("#release")  # whoever is asked about has it no more
    bert.page.wait_for_selector("#take[data-do='take']")
    take_the_hand(anna)
    bert.page.click("#take")
    bert.page.wait_for_selector("#take[data-do='take over'][data-whose='anna']")
    bert.page.click("#take")
    anna.page.wait_for_selector("#hand-of.lost")
    assert anna.page.is_disabled("#arm")
    assert not anna.page.is_disabled("#bypass")


def test_what_is_typed_into_a_field_is_text_and_no_command(chromium, with_hand: Screen) -> None:
    page = logged_in(chromium, with_hand, "anna", locale="en", color_scheme="light")
    page.page.goto(f"{with_hand.url}scope")
    page.await_live()
    page.await_selector("#readout tbody tr")
    page.page.click("#keep-open")
    page.page.keyboard.type("at last, little? util")
    assert page.run("() => document.getElementById('keep-name').value") == "at last, little? util"
    assert page.run("() => document.documentElement.lang") == "en"
    assert page.run("() => document.documentElement.dataset.theme") is None
    page.page.keyboard.press("Escape")
    assert page.run("() => document.activeElement.id") == "keep-open"
    page.close()


@pytest.mark.parametrize(("path", "opens"), [("", "?"), ("scope", "#keep-open")])
@pytest.mark.parametrize("width", [360, 1280])
def test_no_box_stands_before_the_bypass(
    chromium, with_hand: Screen, path: str, opens: str, width: int
) -> None:
    name = "anna" if width == 360 else "bert"  # five logins a minute are heard of one
    page = logged_in(
        chromium, with_hand, name, locale="en", viewport={"width": width, "height": 740}
    )
    page.page.goto(with_hand.url + path)
    page.await_live()
    if opens == "?":
        page.page.keyboard.press(opens)
    else:
        page.await_selector("#readout tbody tr")
        page.page.click(opens)
    page.page.wait_for_selector("dialog[open]")
    box, hand = (
        page.run(f"() => document.querySelector('{one}').getBoundingClientRect().toJSON()")
        for one in ("dialog[open]", "#hand")
    )
    assert box["bottom"] <= hand["top"] + 1
    assert box["right"] <= width + 1
    page.page.click("#bypass", timeout=10_000)
    page.page.wait_for_function(
        "() => document.getElementById('hand-said').textContent.includes('seen in the line')"
    )
    assert page.run("() => document.querySelector('dialog[open]') !== null")
    page.close()
