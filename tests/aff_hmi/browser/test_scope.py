"""The scope in a real browser: cursors, a trigger, a window that is kept, shown and let go."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from aff_runtime.app.hand.accounts import Account, secret_of
from aff_runtime.app.hand.may import Role
from tests.aff_hmi.browser.conftest import Screen
from tests.aff_hmi.browser.eyes import Page
from tests.processes import until

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]
PASSWORD = "tension, 90 N"
HOSTILE = '<img src=x onerror="window.owned=1">'


@pytest.fixture(scope="module")
def with_hand(service, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Screen]:
    """A screen of the service at which one logs in; the service hears no hand."""
    folder = tmp_path_factory.mktemp("accounts")
    accounts = folder / "accounts"
    row = Account(name="anna", role=Role.OPERATE, secret=secret_of(PASSWORD)).line
    accounts.write_text(f"{row}\n")
    accounts.chmod(0o600)
    found = Screen(service, "--hand-socket", str(folder / "none"), "--accounts", str(accounts))
    yield found
    found.close()


def opened(chromium: object, url: str, **context: object) -> Page:
    page = Page(chromium, url, locale="en", **context)
    page.await_live()
    page.await_selector("#readout tbody tr")
    return page


def test_two_cursors_read_off_what_lies_between_them(chromium, screen) -> None:
    page = opened(chromium, screen.url + "scope")
    for name, place in (("a", 200), ("b", 700)):
        page.page.evaluate(
            """([id, value]) => { const e = document.getElementById(id); e.value = value;
            e.dispatchEvent(new Event("input")); }""",
            [f"cursor-{name}", str(place)],
        )
    # a service that has just begun has fewer ticks than the five seconds that are asked for
    page.page.wait_for_function(
        """() => { const text = document.getElementById("between").textContent;
        const said = /: ([0-9.,]+) ms/.exec(text);
        return said && Number(said[1].replace(",", "")) > 2450; }"""
    )
    page.page.click("#run")
    page.page.wait_for_function("() => document.getElementById('run').textContent === 'Go on'")
    found = re.search(r": ([\d.,]+) ms, ([\d.,]+) Hz", page.text("#between"))
    assert found
    apart_ms, rate_hz = (float(one.replace(",", "")) for one in found.groups())
    assert apart_ms == pytest.approx(2500.0, rel=0.02)  # the half of five seconds
    assert rate_hz == pytest.approx(1000.0 / apart_ms, rel=0.01)
    before = page.text("#between")
    page.page.focus("#cursor-b")
    page.page.keyboard.press("End")
    assert page.text("#between") != before
    page.close()


def test_over_turns_there_are_orders_and_a_table(chromium, screen, pictures: Path) -> None:
    page = opened(chromium, screen.url + "scope")
    page.page.select_option("#seconds", "20")
    page.page.select_option("#roll", index=1)
    page.page.wait_for_selector("#orders:not([hidden])")
    page.page.click("#orders summary")
    page.await_selector("#order-table tbody tr:nth-child(12)")
    assert "turns" in page.text("#between")
    page.page.click("#lines summary")
    page.await_selector("#line-table tbody tr")
    assert (
        page.run("() => document.querySelector('#line-table th:nth-child(2)').textContent") == "Hz"
    )
    page.picture(pictures / "scope-turns.png")
    assert page.complaints == []
    page.close()


def test_a_trigger_stops_the_picture_around_it(chromium, screen, pictures: Path) -> None:
    page = opened(chromium, screen.url + "scope")
    cell = "document.querySelector('#readout tbody tr td:nth-child(6)')"
    mean = float(page.run(f"() => {cell}.textContent"))
    page.page.select_option("#seconds", "1")
    page.page.select_option("#on", "rise")
    page.page.fill("#level", str(mean))
    page.page.press("#level", "Tab")
    page.page.wait_for_function(
        "() => document.getElementById('shot').textContent.startsWith('trigger at')"
    )
    page.page.wait_for_function("() => document.getElementById('run').textContent === 'Go on'")
    page.picture(pictures / "scope-trigger.png")
    page.page.fill("#level", "1e6")
    page.page.press("#level", "Tab")
    page.page.wait_for_function(
        "() => document.getElementById('shot').textContent === 'waits for the trigger'"
    )
    page.close()


def test_what_stands_is_not_crossed_out_when_the_service_hangs(chromium, screen) -> None:
    page = opened(chromium, screen.url + "scope")
    assert "live" in page.run("() => document.getElementById('picture').className")
    page.page.click("#run")
    page.page.wait_for_function("() => document.getElementById('run').textContent === 'Go on'")
    assert page.run("() => document.getElementById('picture').className") == ""
    page.close()


def test_a_file_has_the_ticks_that_are_shown(chromium, screen) -> None:
    page = opened(chromium, screen.url + "scope")
    page.page.select_option("#seconds", "1")
    page.page.click("#run")
    page.page.wait_for_function(
        "() => document.getElementById('shot').textContent.startsWith('stopped')"
    )
    last = re.search(r"tick (\d+)", page.text("#shot"))
    assert last
    with page.page.expect_download() as told:
        page.page.click("#save")
    lines = Path(told.value.path()).read_text().splitlines()
    assert len(lines) == 201
    assert int(lines[-1].split(",")[1]) == int(last.group(1))
    page.close()


def test_a_window_is_kept_with_a_hostile_name_shown_and_let_go(
    chromium, with_hand: Screen, pictures: Path
) -> None:
    page = Page(chromium, f"{with_hand.url}login", locale="en")
    page.page.fill("#name", "anna")
    page.page.fill("#password", PASSWORD)
    page.page.press("#password", "Enter")
    page.await_selector("#arm")
    page.page.goto(with_hand.url + "scope")
    page.await_live()
    page.await_selector("#readout tbody tr")
    page.page.click("#keep-open")
    page.page.fill("#keep-name", HOSTILE)
    page.page.fill("#keep-note", "second shift")
    page.page.click("#keep-do")
    page.page.wait_for_selector("#windows strong")
    assert page.text("#windows strong") == HOSTILE
    assert page.run("() => window.owned") is None
    page.page.click("#windows button:first-child")
    page.page.wait_for_function(
        f"() => document.getElementById('shot').textContent.includes({json.dumps(HOSTILE)})"
    )
    page.picture(pictures / "scope-kept.png")
    page.page.click("#run")
    page.page.click("#windows button:nth-child(2)")
    page.page.wait_for_function(
        "() => document.getElementById('curves').textContent.includes('kept: ')"
    )
    page.page.wait_for_function(
        "() => [...document.querySelectorAll('#readout tbody tr')].map(row => row.cells)"
        ".some(([name, a]) => name.textContent.includes('kept: ') && a.textContent !== '—')"
    )
    page.picture(pictures / "scope-overlay.png")
    page.page.keyboard.press("c")
    assert page.run("() => document.activeElement.id") == "cursor-a"
    page.page.keyboard.press("c")
    assert page.run("() => document.activeElement.id") == "cursor-b"
    page.page.keyboard.press("End")
    assert page.run("() => document.activeElement.value") == "1000"
    with page.page.expect_download() as told:
        page.page.click("#save-picture")
    saved = Path(told.value.path()).read_bytes()
    assert saved[:8] == b"\x89PNG\r\n\x1a\n"
    (pictures / "scope-saved.png").write_bytes(saved)
    page.page.click("#windows button:nth-child(2)")
    page.page.wait_for_function(
        "() => !document.getElementById('curves').textContent.includes('kept: ')"
    )
    for _ in range(2):  # once more is asked: it cannot be had back
        page.page.click("#windows button:last-child")
    page.page.wait_for_function("() => !document.querySelector('#windows strong')")
    assert page.complaints == []
    page.close()


def test_the_archive_of_the_timing_page_is_one_file(chromium, screen) -> None:
    page = Page(chromium, screen.url + "timing", locale="en")
    page.await_live()
    page.await_selector("#times .time")
    until("ticks", lambda: page.text('[data-of="ticks"]') not in ("—", "0"))
    with page.page.expect_download() as told:
        page.page.click("#support")
    assert told.value.suggested_filename == "aff-support.zip"
    assert Path(told.value.path()).read_bytes()[:2] == b"PK"
    page.close()
