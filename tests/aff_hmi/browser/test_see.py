"""The pages beside the overview in a real browser: widths, languages, themes, what is stale."""

from __future__ import annotations

import os
import re
import signal
import time
from itertools import product
from pathlib import Path

import pytest

from tests.aff_hmi.browser.axe import grave_findings
from tests.aff_hmi.browser.eyes import Page
from tests.aff_hmi.browser.sights import CLIPPED, CONTRAST, MIN_CONTRAST, OVERLAPS, SMALL

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]
SHOWN = {
    "alarms": "#log tr",
    "rolls": ".roll",
    "trends": "#chart canvas",
    "scope": "#readout tbody tr",
    "timing": "#times .time",
}
DRESSES = (("en", "light"), ("de", "dark"))
CASES = list(product(SHOWN, (360, 768, 1280, 1920), DRESSES))
MOST_REQUESTS = 8
MOST_BYTES = {"trends": 220_000, "scope": 220_000}


@pytest.mark.parametrize(("name", "width", "dress"), CASES)
def test_it_fits_is_readable_and_stays_on_the_host(
    chromium, screen, pictures: Path, name: str, width: int, dress: tuple[str, str]
) -> None:
    language, theme = dress
    view = {"width": width, "height": 800}
    page = Page(chromium, screen.url + name, viewport=view, locale=language, color_scheme=theme)
    page.await_live()
    page.await_selector(SHOWN[name])
    page.picture(pictures / f"{name}-{width}-{language}-{theme}.png")
    assert page.run("() => document.documentElement.lang") == language
    assert page.run("() => document.documentElement.scrollWidth") <= width
    ratio, where = page.run(CONTRAST)
    assert ratio >= MIN_CONTRAST, where
    assert page.run(SMALL) == []
    assert page.run(CLIPPED) == []
    assert page.run(OVERLAPS) == []
    assert page.complaints == []
    assert {re.sub(r"/[^/]*$", "", url) for url in page.requests} <= {
        screen.url.rstrip("/"),
        f"{screen.url}static",
        f"{screen.url}data",
    }
    page.close()


@pytest.mark.parametrize("name", SHOWN)
def test_nothing_stale_looks_alive(chromium, screen, pictures: Path, name: str) -> None:
    page = Page(chromium, screen.url + name, locale="en", viewport={"width": 1280, "height": 800})
    page.await_live()
    page.await_selector(SHOWN[name])
    control = screen.service.status()["control_pid"]
    os.kill(control, signal.SIGSTOP)
    try:
        page.await_selector("html[data-broken='service']")
        page.await_selector(".see .live.dead > .stale:not(:empty)")
        assert all(page.dead("service"))
        assert all(page.dead("supervisor"))
        page.picture(pictures / f"stale-{name}.png")
    finally:
        os.kill(control, signal.SIGCONT)
    page.await_live()
    page.close()


@pytest.mark.parametrize("name", SHOWN)
def test_every_page_is_light_and_comes_in_few_requests(chromium, screen, name: str) -> None:
    page = Page(chromium, screen.url + name, locale="en")
    page.await_live()
    page.await_selector(SHOWN[name])
    sizes = page.run("() => performance.getEntries().map(e => e.decodedBodySize ?? 0)")
    assert sum(sizes) < MOST_BYTES.get(name, 150_000)
    once = {url for url in page.requests if "/data/scope?" not in url}  # asked again and again
    assert len(once) + 1 <= MOST_REQUESTS
    page.close()


@pytest.mark.parametrize("name", SHOWN)
def test_axe_finds_nothing_serious(chromium, screen, name: str) -> None:
    page = Page(chromium, screen.url + name, locale="en", viewport={"width": 1280, "height": 800})
    page.await_live()
    page.await_selector(SHOWN[name])
    assert grave_findings(page.page) == []
    page.close()


def test_events_are_filtered_by_kind(chromium, screen) -> None:
    page = Page(chromium, screen.url + "alarms", locale="en")
    page.await_live()
    page.await_selector("#log tr")
    page.page.select_option("#kind", "state")
    page.page.wait_for_function(
        "() => [...document.querySelectorAll('#log tr td:nth-child(2)')]"
        ".every(cell => cell.textContent === 'state')"
    )
    assert "kind=state" in page.run("() => document.getElementById('save').href")
    page.close()


def test_what_happened_is_a_flag_over_the_curves_and_a_line_of_words(
    chromium, screen, pictures: Path
) -> None:
    page = Page(
        chromium, screen.url + "trends", locale="en", viewport={"width": 1280, "height": 800}
    )
    page.await_live()
    page.await_selector("#chart canvas")
    flag = {"utc_s": time.time() - 60.0, "name": "PROBE", "text": "the probe begins <b>"}
    many = [flag | {"utc_s": time.time() - 120.0 + n} for n in range(15)]

    def add(route: object) -> None:
        answer = route.fetch()  # type: ignore[attr-defined]
        said = answer.json()
        said["trend"]["flags"] = [*many, flag]
        route.fulfill(response=answer, json=said)  # type: ignore[attr-defined]

    page.page.route("**/data/trend?*", add)
    page.page.select_option("#group", "tension")
    page.await_selector("#flags li:nth-child(12)")
    assert page.run("() => document.querySelectorAll('#flags li').length") == 12
    last = page.run("() => document.querySelector('#flags li:last-child').textContent")
    assert last.endswith("PROBE the probe begins <b>")
    assert page.run("() => document.getElementById('earlier').textContent").startswith("4 ")
    page.picture(pictures / "trends-flags.png")
    assert grave_findings(page.page) == []
    page.close()
