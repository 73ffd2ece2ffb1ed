"""Every page in every state of the line: four widths, two languages, two themes, by axe too.

The screen server is the real one; what it sees of a line is given. The page's clock stands, so a
busy machine makes nothing stale here.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import pytest

from aff_hmi import doorkeeper
from tests.aff_hmi.browser.axe import grave_findings
from tests.aff_hmi.browser.eyes import Page
from tests.aff_hmi.browser.sights import CLIPPED, CONTRAST, MIN_CONTRAST, OVERLAPS, SMALL
from tests.aff_hmi.browser.staged import PASSWORD, STATES, Stage, moment

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]
WIDTHS = {360: 740, 768: 1024, 1280: 800, 1920: 1080}
STANDS = "performance.now = () => 1000"
PICTURED = ("ACTIVE", "FAULT", "RESTING")


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    """A screen for looking only."""
    found = Stage()
    yield found
    found.close()


@pytest.fixture(scope="module")
def pressed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stage]:
    """A screen with a hand, at which one may log in as often as there are tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(doorkeeper, "PER_ACCOUNT", 1000)
        patch.setattr(doorkeeper, "PER_ADDRESS", 1000)
        found = Stage(tmp_path_factory.mktemp("hand"))
        yield found
        found.close()


@pytest.fixture(autouse=True)
def _calm(stage: Stage, pressed: Stage) -> None:
    """Every page is opened at a line at work."""
    stage.calm()
    pressed.calm()


def looked_at(page: Page, width: int) -> None:
    """Assert what no page may get wrong."""
    assert page.run("() => document.documentElement.scrollWidth") <= width
    assert page.run(CLIPPED) == []
    assert page.run(OVERLAPS) == []
    assert page.run(SMALL) == []
    ratio, where = page.run(CONTRAST)
    assert ratio >= MIN_CONTRAST, where


def show(stage: Stage, page: Page, state: str) -> None:
    """Have a page show a state, and wait until it does."""
    number = stage.show(moment(state)) + 1  # one may be in the making
    page.page.wait_for_function(f"() => document.documentElement.dataset.seq > {number}")


COMBINATIONS = list(product(WIDTHS, ("en", "de"), ("light", "dark")))


@pytest.mark.parametrize(("width", "language", "theme"), COMBINATIONS)
def test_it_fits_is_readable_and_stays_on_the_host_in_every_state(
    chromium, stage: Stage, pictures: Path, width: int, language: str, theme: str
) -> None:
    view = {"width": width, "height": WIDTHS[width]}
    page = Page(chromium, stage.url, STANDS, viewport=view, locale=language, color_scheme=theme)
    page.await_live()
    assert page.run("() => document.documentElement.lang") == language
    for state in STATES if theme == "light" else PICTURED:
        show(stage, page, state)
        looked_at(page, width)
        if state in PICTURED:
            page.picture(pictures / f"look-{state}-{width}-{language}-{theme}.png")
    assert page.complaints == []
    assert {re.sub(r"/[^/]*$", "", url) for url in page.requests} <= {
        stage.url.rstrip("/"),
        f"{stage.url}static",
    }
    page.close()


@pytest.mark.parametrize(("width", "language", "theme"), COMBINATIONS)
def test_the_hand_leaves_room_for_the_values_and_the_login_fits(
    chromium, pressed: Stage, pictures: Path, width: int, language: str, theme: str
) -> None:
    view = {"width": width, "height": WIDTHS[width]}
    named = f"{width}-{language}-{theme}.png"
    page = Page(
        chromium, f"{pressed.url}login", STANDS, viewport=view, locale=language, color_scheme=theme
    )
    looked_at(page, width)
    page.picture(pictures / f"login-{named}")
    page.page.fill("#name", "anna")
    page.page.fill("#password", PASSWORD)
    page.page.press("#password", "Enter")
    page.await_selector("#arm")
    page.await_live()
    tops = set()
    for state in PICTURED:
        show(pressed, page, state)
        looked_at(page, width)
        tops.add(page.run("() => document.getElementById('bypass').getBoundingClientRect().top"))
        bar = page.run("() => document.getElementById('hand').getBoundingClientRect().height")
        assert bar <= 0.33 * view["height"], state
        page.page.screenshot(path=str(pictures / f"hand-{state}-{named}"))
    assert len(tops) == 1  # a finger on its way finds it where it was
    bypass, arm = (
        page.run(f"() => document.getElementById('{one}').getBoundingClientRect().toJSON()")
        for one in ("bypass", "arm")
    )
    assert min(bypass["height"], arm["height"]) >= 64.0
    assert arm["left"] - bypass["right"] >= 24.0
    assert page.complaints == []
    page.close()


@pytest.mark.parametrize(
    ("width", "language", "theme"), [(360, "de", "dark"), (1280, "en", "light")]
)
def test_axe_finds_nothing_serious(
    chromium, stage: Stage, pressed: Stage, width: int, language: str, theme: str
) -> None:
    view = {"width": width, "height": WIDTHS[width]}
    given = {"viewport": view, "locale": language, "color_scheme": theme}
    page = Page(chromium, stage.url, STANDS, **given)
    page.await_live()
    for state in ("ACTIVE", "FAULT", "GONE"):
        show(stage, page, state)
        assert grave_findings(page.page) == []
    page.page.keyboard.press("?")
    assert grave_findings(page.page) == []
    page.close()
    page = Page(chromium, f"{pressed.url}login", STANDS, **given)
    assert grave_findings(page.page) == []
    page.page.fill("#name", "anna")
    page.page.fill("#password", PASSWORD)
    page.page.press("#password", "Enter")
    page.await_selector("#arm")
    page.await_live()
    for state in ("READY", "FAULT"):
        show(pressed, page, state)
        assert grave_findings(page.page) == []
    page.close()


@pytest.mark.parametrize("sight", ["achromatopsia", "deuteranopia", "protanopia", "tritanopia"])
def test_every_state_can_be_told_without_some_colours(
    chromium, stage: Stage, pictures: Path, sight: str
) -> None:
    page = Page(chromium, stage.url, STANDS, locale="en", viewport={"width": 1280, "height": 800})
    page.await_live()
    session = page.context.new_cdp_session(page.page)
    session.send("Emulation.setEmulatedVisionDeficiency", {"type": sight})
    told = set()
    for state in STATES:
        show(stage, page, state)
        told.add((page.text("#shape").strip(), page.text("#state"), page.text("#alarms")))
    assert len(told) == len(STATES) - 1  # a probe changes what is said, not the state's word
    page.picture(pictures / f"sight-{sight}.png")
    page.close()
