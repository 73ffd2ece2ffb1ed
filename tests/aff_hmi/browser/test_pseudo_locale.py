"""On a phone every page has room for words that are longer by two fifths."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.aff_hmi.browser.eyes import Page
from tests.aff_hmi.browser.staged import PASSWORD, Stage
from tests.aff_hmi.browser.test_looks import STANDS, looked_at, show
from tests.aff_hmi.pseudo import BEGIN, speaks

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]
PAGES = ("", "alarms", "rolls", "trends", "scope", "timing")


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stage]:
    """A screen with a hand and history that speaks the language of these tests."""
    with pytest.MonkeyPatch.context() as patch:
        speaks(patch)
        found = Stage(tmp_path_factory.mktemp("hand"), keeps=True)
        yield found
        found.close()


def test_no_page_is_too_narrow_for_longer_words(chromium, stage: Stage, pictures: Path) -> None:
    view = {"width": 360, "height": 740}
    page = Page(chromium, f"{stage.url}login", STANDS, viewport=view, locale="en")
    page.page.fill("#name", "anna")
    page.page.fill("#password", PASSWORD)
    page.page.press("#password", "Enter")
    page.await_selector("#arm")
    wrong: dict[str, str] = {}
    for name in PAGES:
        stage.calm()
        page.page.goto(f"{stage.url}{name}")
        page.await_live()
        assert BEGIN in page.text("#state")
        for state in ("FAULT", "RESTING"):
            show(stage, page, state)
            try:
                looked_at(page, view["width"])
            except AssertionError as error:
                wrong[f"{name} {state}"] = str(error)[:400]
            page.picture(pictures / f"pseudo-{name or 'overview'}-{state}.png")
    assert wrong == {}
    page.close()
