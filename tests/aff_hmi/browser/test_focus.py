"""The keyboard stays where it is while what a page tells goes on."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from aff_hmi.watch import News, Observed
from tests.aff_hmi.browser.eyes import Page
from tests.aff_hmi.browser.staged import Stage
from tests.aff_hmi.see.test_rolls_part import moment, order

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]


@pytest.fixture
def stage() -> Iterator[Stage]:
    found = Stage(keeps=True)
    yield found
    found.close()


def learned(mm: float) -> Observed:
    """Return a roll whose shape was learned: one eccentric by so much."""
    return moment(*(order("unwind", n, mm if n == 1 else 0.0, 30.0) for n in (1, 2, 3)))


@pytest.mark.parametrize("place", ["details summary", ".roll > .scroll", ".angle input"])
def test_a_roll_that_is_learned_on_leaves_the_keyboard_where_it_is(
    chromium, stage: Stage, place: str
) -> None:
    stage.show(learned(0.6))
    page = Page(chromium, f"{stage.url}rolls", locale="en", viewport={"width": 360, "height": 800})
    page.await_live()
    page.await_selector("svg.polar")
    page.page.click("details summary")
    page.page.fill(".angle input", "45")
    page.run("() => { document.querySelector('.roll > .scroll').scrollLeft = 60; }")
    page.page.focus(place)
    stays = place != ".angle input"  # what is drawn of a shape has its data: it is made anew
    page.run(f"() => {{ document.querySelector('{place}').mine = {str(stays).lower()}; }}")
    for mm in (0.3, 0.9):
        stage.show(learned(mm))
        page.page.wait_for_function(
            "text => document.querySelector('.roll > .scroll').textContent.includes(text)",
            arg=f"{mm:.3f} mm",
        )
        assert page.run(f"() => document.activeElement.matches('{place}')")
        assert page.run("() => document.activeElement.mine === true") is stays
    assert page.run("() => document.querySelector('details').open") is True
    assert page.run("() => document.querySelector('.roll > .scroll').scrollLeft") == 60
    page.page.focus(".angle input")
    page.page.keyboard.press("ArrowRight")
    assert page.text(".angle output").startswith("48°: ")
    assert page.complaints == []
    page.close()


def test_the_times_of_the_ticks_leave_the_keyboard_where_it_is(chromium, stage: Stage) -> None:
    stage.calm()
    page = Page(chromium, f"{stage.url}timing", locale="en")
    page.await_live()
    page.await_selector(".time .scroll")
    page.page.focus(".time .scroll")
    page.run("() => { window.was = document.querySelector('.time table'); }")
    columns = ("wake_us", "io_us", "tick_us", "age_s")
    stage.watch.news = News(columns=columns, records=[(9.0, 90.0, 200.0, 2e-3)])  # type: ignore[misc]
    page.page.wait_for_function("() => document.querySelector('.time table') !== window.was")
    assert page.run("() => document.activeElement.matches('.time .scroll')")
    page.close()
