"""Alarms in a real browser: seen by a key, heard where it is switched on, shown where they are."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.events import BY_NAME
from tests.aff_hmi.browser.eyes import Page
from tests.aff_hmi.browser.staged import PASSWORD, Stage, moment
from tests.aff_hmi.scope.played import cut_of
from tests.aff_hmi.see.test_rolls_part import ECCENTRIC
from tests.aff_hmi.see.test_rolls_part import moment as of_orders

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


def test_a_link_to_ticks_that_are_gone_opens_the_window_that_was_kept_of_them(
    chromium, stage: Stage
) -> None:
    """Of 500 ticks, the 300th brought the alarm: the cursor stands there and reads its number."""
    sources = stage._hub.sources
    assert sources is not None
    stage.calm()
    cut = cut_of(500, float)
    sources.windows.keep_of("PLC_STALE", cut)
    at_s = cut.utc_s + float(cut.time_s[300])
    page = Page(chromium, f"{stage.url}scope?end=499&tick=300&at={at_s:.3f}", locale="en")
    page.await_live()
    page.page.wait_for_function(
        "() => document.getElementById('shot').textContent.includes('kept window PLC_STALE')"
    )
    assert page.text("#windows strong") == "PLC_STALE"
    assert "this screen, at an alarm" in page.text("#windows")
    place = float(page.run("() => document.getElementById('cursor-a').value"))
    assert round(place / 1000 * 499) == 300
    assert page.complaints == []
    page.close()


@pytest.mark.parametrize(
    ("language", "shown"), [("en", "WEB_INTACT=0: the PLC sees no web"), ("de", "WEB_INTACT=0")]
)
def test_all_that_stands_in_the_way_is_listed_under_the_state(
    chromium, stage: Stage, pictures: Path, language: str, shown: str
) -> None:
    off = moment("OFF")
    assert off.facts is not None
    others = ("WEB_INTACT=0", "SPLICE", "unwind: no measured response; run the probe")
    stage.show(replace(off, facts=replace(off.facts, blocked="LINE_RUN=0", also_blocking=others)))
    page = Page(chromium, stage.url, locale=language, viewport={"width": 360, "height": 800})
    page.await_live()
    page.page.wait_for_function("() => document.querySelectorAll('#also li').length === 3")
    assert shown in page.text("#also li")
    assert page.run("() => document.documentElement.scrollWidth") <= 360
    page.picture(pictures / f"all-reasons-{language}.png")
    stage.calm()
    page.page.wait_for_function("() => document.getElementById('also-part').hidden")
    assert page.complaints == []
    page.close()


def test_a_cursor_on_a_roll_reads_angle_and_deviation(
    chromium, stage: Stage, pictures: Path
) -> None:
    """An eccentric roll: 0.6 mm times the cosine of the angle and 30 deg, with a comma."""
    stage.show(of_orders(*ECCENTRIC))
    view = {"width": 360, "height": 800}
    page = Page(chromium, f"{stage.url}rolls", locale="de-DE", viewport=view)
    page.page.set_default_timeout(20_000)
    page.await_live()
    page.await_selector(".angle input")
    for deg in (0, 45, 150, 330):
        page.page.fill(".angle input", str(deg))
        told = re.match(
            rf"{deg}°: ([+-]?\d,\d+) mm", page.text(".angle output").replace("\u2212", "-")
        )
        assert told, page.text(".angle output")
        mm = 0.6 * math.cos(math.radians(deg + 30.0))
        assert float(told[1].replace(",", ".")) == pytest.approx(mm, abs=1.1e-3)
    page.page.locator("svg.polar").first.scroll_into_view_if_needed()
    box = page.page.locator("svg.polar").first.bounding_box()
    page.page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 0.2 * box["height"])
    assert page.text(".angle output").startswith("90°: ")  # straight above the middle
    page.page.focus(".angle input")
    page.page.keyboard.press("ArrowRight")
    assert page.text(".angle output").startswith("93°: ")
    assert page.run("() => document.documentElement.scrollWidth") <= 360
    page.picture(pictures / "roll-cursor.png")
    assert page.complaints == []
    page.close()
    wide = {"width": 1280, "height": 1100}
    page = Page(chromium, f"{stage.url}rolls", locale="en", viewport=wide)
    page.await_live()
    page.await_selector("svg.polar")
    drawn = page.page.locator("svg.polar").first.text_content()
    assert "+0.60 mm" in drawn
    page.picture(pictures / "roll-1280-en.png")
    page.close()
