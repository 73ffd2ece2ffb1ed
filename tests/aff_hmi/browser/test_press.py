"""Presses in a real browser on a staged line: beside the login, and without fresh data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from aff_runtime.app.hand.may import Action
from aff_runtime.app.hand.messages import NOBODY
from tests.aff_hmi.browser.axe import grave_findings
from tests.aff_hmi.browser.eyes import Page
from tests.aff_hmi.browser.sights import CLIPPED, CONTRAST, MIN_CONTRAST, OVERLAPS, SMALL
from tests.aff_hmi.browser.staged import PASSWORD, Stage, moment

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]
OLD_S = 5.0


@pytest.fixture
def stage(tmp_path: Path) -> Iterator[Stage]:
    found = Stage(tmp_path, keeps=True)
    yield found
    found.close()


def logged_in(chromium: object, stage: Stage, name: str, **context: object) -> Page:
    page = Page(chromium, f"{stage.url}login", **context)
    page.page.fill("#name", name)
    page.page.fill("#password", PASSWORD)
    page.page.press("#password", "Enter")
    page.await_selector("#arm")
    page.await_live()
    return page


def said(page: Page, words: str) -> None:
    page.page.wait_for_function(
        "words => document.getElementById('hand-said').textContent.includes(words)", arg=words
    )


def pressed(stage: Stage) -> list[tuple[str, str]]:
    return [(one.action, one.account) for one in stage.desk.said]


def test_who_types_his_password_bypasses_by_key_and_comes_back_to_his_page(
    chromium, stage: Stage
) -> None:
    page = Page(chromium, f"{stage.url}alarms", locale="en")
    page.await_live()
    page.page.click(".who a.button")
    page.page.wait_for_selector("#login")
    page.page.fill("#name", "anna")
    page.page.press("#name", "F9")
    page.page.wait_for_function("() => document.getElementById('hand-said').textContent !== ''")
    assert pressed(stage) == [(Action.BYPASS, NOBODY)]
    assert page.run("() => document.getElementById('name').value") == "anna"
    page.page.fill("#password", PASSWORD)
    page.page.press("#password", "Enter")
    page.await_selector("#logout")
    assert page.page.url.partition("?")[0] == f"{stage.url}alarms"
    assert page.complaints == []
    page.close()


@pytest.mark.parametrize(("width", "language"), [(360, "de"), (1280, "en")])
def test_the_page_of_the_login_fits_with_its_bypass(
    chromium, stage: Stage, pictures: Path, width: int, language: str
) -> None:
    view = {"width": width, "height": 740}
    page = Page(chromium, f"{stage.url}login", viewport=view, locale=language)
    page.await_live()
    page.picture(pictures / f"login-bypass-{width}-{language}.png")
    assert page.run("() => document.documentElement.scrollWidth") <= width
    for found in (SMALL, CLIPPED, OVERLAPS):
        assert page.run(found) == []
    assert grave_findings(page.page) == []
    page.close()


def test_a_press_that_the_line_does_not_show_is_told_by_shape_word_and_colour(
    chromium, stage: Stage, pictures: Path
) -> None:
    """The service says yes, and the line stays as it was: nothing was confirmed."""
    stage.show(moment("ACTIVE"))
    page = logged_in(chromium, stage, "anna", locale="en", color_scheme="light")
    assert page.text("#hand-of") == "nobody has the hand"
    page.page.click("#take")
    page.page.wait_for_function(
        "() => /^you have the hand, since \\d\\d:\\d\\d, at the panel$/"
        ".test(document.getElementById('hand-of').textContent)"
    )
    page.page.keyboard.press("F9")
    said(page, "BYPASS: NOT CONFIRMED: use the switch at the line")
    look = """() => { const told = document.getElementById('hand-said');
      const high = getComputedStyle(document.documentElement).getPropertyValue('--high').trim();
      const one = document.createElement('i'); one.style.color = high; document.body.append(one);
      const { color, borderTopColor, borderTopWidth } = getComputedStyle(told);
      return [color === getComputedStyle(one).color, color === borderTopColor, borderTopWidth,
        getComputedStyle(told, '::before').content]; }"""
    assert page.run(look) == [True, True, "4px", '"✖ "']
    assert page.run(CONTRAST)[0] >= MIN_CONTRAST
    page.picture(pictures / "not-confirmed.png")
    stage.show(moment("BYPASS"))
    page.page.keyboard.press("F9")
    said(page, "BYPASS: done, and seen in the line")
    assert page.run("() => document.getElementById('hand-said').className") == ""
    other = logged_in(chromium, stage, "bert", locale="de-DE")
    other.page.wait_for_function(
        "() => /^anna hat die Hand, seit \\d\\d:\\d\\d, am Bedienfeld$/"
        ".test(document.getElementById('hand-of').textContent)"
    )
    page.close()
    other.close()


@pytest.mark.parametrize("in_the_hold", [False, True])
def test_a_press_without_fresh_data_says_so_is_never_done_and_can_be_repeated(
    chromium, stage: Stage, in_the_hold: bool
) -> None:
    fresh = moment("BYPASS")
    stale = replace(fresh, tick_age_s=OLD_S)
    stage.show(fresh)
    page = logged_in(chromium, stage, "anna", locale="en")
    page.page.click("#take")
    page.page.wait_for_selector("#arm:enabled")
    page.page.hover("#arm")
    if in_the_hold:
        page.page.mouse.down()
        stage.show(stale)
    else:
        stage.show(stale)
        page.await_selector("html[data-broken='service']")
        page.page.mouse.down()
    said(page, "ARM: no fresh data: nothing is done")
    page.page.mouse.up()
    stage.show(fresh)
    said(page, "ARM: nothing was done; the data is fresh again: press once more")
    page.page.wait_for_timeout(1500)
    assert pressed(stage) == []
    page.page.mouse.down()
    page.page.wait_for_timeout(1500)
    page.page.mouse.up()
    page.page.wait_for_function(
        "() => !document.getElementById('hand-said').textContent.includes('fresh')"
    )
    assert pressed(stage) == [(Action.ARM, "anna")]
    page.close()
