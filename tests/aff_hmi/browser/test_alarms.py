"""Alarms in a real browser: seen by a key, heard where it is switched on, shown where they are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.events import BY_NAME
from tests.aff_hmi.browser.eyes import Page
from tests.aff_hmi.browser.staged import PASSWORD, Stage, moment

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]
BEEPS = """window.beeps = 0;
const Tone = window.OscillatorNode;
window.OscillatorNode = class extends Tone {
  start(at) { window.beeps += 1; super.start(at); }
};"""


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stage]:
    """A screen with a hand and history."""
    found = Stage(tmp_path_factory.mktemp("hand"), keeps=True)
    yield found
    found.close()


def rose() -> object:
    """Return a moment in which an alarm of high priority stands."""
    fault = moment("FAULT")
    assert fault.row is not None
    values = {**fault.row.values, "alarm": float(BY_NAME["RIPPLE_ROSE"].code)}
    return replace(fault, row=TickRow(values))


def test_an_alarm_is_heard_until_a_key_says_that_it_was_seen(
    chromium, stage: Stage, pictures: Path
) -> None:
    stage.calm()
    view = {"width": 1280, "height": 800}
    page = Page(chromium, f"{stage.url}login", BEEPS, locale="en", viewport=view)
    page.page.fill("#name", "anna")
    page.page.fill("#password", PASSWORD)
    page.page.press("#password", "Enter")
    page.await_selector("#arm")
    page.page.goto(f"{stage.url}alarms")
    page.await_live()
    stage.show(rose())  # type: ignore[arg-type]
    page.await_selector("#book li[data-rank='1'][data-life='active']")
    assert "off" in page.text("[data-sound]")
    assert page.run("() => window.beeps") == 0
    page.page.keyboard.press("m")
    page.page.wait_for_function("() => window.beeps >= 4")  # the one that says on, and the alarm
    assert page.text("#sound") == "Sound off"
    page.picture(pictures / "alarm-loud.png")
    page.page.keyboard.press("a")
    assert page.run("() => document.activeElement.dataset.key") == "RIPPLE_ROSE"
    page.page.keyboard.press("a")
    page.await_selector("#book li[data-life='seen']")
    assert page.run("() => document.activeElement.dataset.key") == "RIPPLE_ROSE"
    page.page.wait_for_timeout(300)
    before = page.run("() => window.beeps")
    page.page.wait_for_timeout(2500)
    assert page.run("() => window.beeps") == before
    assert page.complaints == []
    page.page.keyboard.press("m")
    assert "off" in page.text("[data-sound]")
    page.close()


def test_where_the_ticks_of_a_link_are_gone_no_others_are_shown(chromium, screen) -> None:
    page = Page(chromium, f"{screen.url}scope?end=12&tick=10&at=1000.5", locale="en")
    page.await_live()
    page.page.wait_for_function(
        "() => document.getElementById('shot').textContent.includes('not kept any more')"
    )
    assert page.run("() => document.querySelector('#chart canvas')") is None
    assert page.complaints == []
    page.close()
