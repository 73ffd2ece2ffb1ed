"""Nothing stale looks alive: every link of the chain is stopped in turn, on real processes.

Within 1.0 s after the break what it brings is grey and crossed out with its age. The page's own
clock is read; by how much a busy machine held up the page itself is added.
"""

from __future__ import annotations

import json
import os
import re
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.aff_hmi.browser.eyes import Page, Stale
from tests.processes import kill, pause, until

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]
WITHIN_MS = 1000.0
NUMBER = '[data-slot="tension:unwind_tension_N"]'


@pytest.fixture
def page(chromium, screen) -> Iterator[Page]:
    found = Page(chromium, screen.url, locale="en", viewport={"width": 1280, "height": 800})
    found.await_live()
    pause(0.5)
    yield found
    found.close()


@pytest.fixture(scope="module")
def figures(pictures: Path) -> Iterator[dict[str, Stale]]:
    """What was measured, left in a file."""
    found: dict[str, Stale] = {}
    yield found
    text = json.dumps({name: vars(one) for name, one in found.items()}, indent=1)
    (pictures / "stale.json").write_text(text + "\n")


def judge(stale: Stale) -> None:
    assert stale.after_ms <= WITHIN_MS + stale.page_late_ms, stale


def test_a_plc_that_falls_silent(page: Page, screen, pictures: Path, figures) -> None:
    start_ms = page.watch()
    screen.service.tell_plc("freeze")
    try:
        figures["plc"] = stale = page.stale_since(start_ms, "plc")
        judge(stale)
        pause(0.4)
        assert all(page.dead("plc"))
        assert not any(page.dead("service"))
        assert page.crossed_out(NUMBER)
        assert "The PLC is silent:" in page.text("#broken")
        assert " old" in page.text(".tension .stale")
        page.picture(pictures / "stale-plc.png")
    finally:
        screen.service.tell_plc("thaw")
    page.await_live()
    assert not page.crossed_out(NUMBER)


def test_a_service_that_hangs(page: Page, screen, pictures: Path, figures) -> None:
    control = screen.service.status()["control_pid"]
    start_ms = page.watch()
    os.kill(control, signal.SIGSTOP)
    try:
        figures["service"] = stale = page.stale_since(start_ms, "service")
        judge(stale)
        pause(0.4)
        assert all(page.dead("plc"))
        assert all(page.dead("service"))
        assert page.text("#state") == "UNKNOWN"
        assert page.text("#was").startswith("was ")
        assert page.crossed_out("#was")
        assert "The service is silent:" in page.text("#broken")
        page.picture(pictures / "stale-service.png")
    finally:
        os.kill(control, signal.SIGCONT)
    page.await_live()
    assert page.text("#was") == ""


def test_a_service_that_is_killed_comes_back_idle_and_is_shown_so(
    page: Page, screen, figures
) -> None:
    control = screen.service.status()["control_pid"]
    start_ms = page.watch()
    kill(control)
    figures["service killed"] = stale = page.stale_since(start_ms, "service")
    judge(stale)
    # from its last tick, and not from a break before that
    said = re.search(r"Silent for ([\d.]+) (s|min)", page.text("#broken"))
    assert said is None or (said[2] == "s" and float(said[1]) < 10.0)
    page.await_live()
    assert page.text("#state") == "FAULT"
    assert screen.service.status()["control_pid"] != control


def test_a_tension_that_stands_still_is_not_shown_as_alive(
    page: Page, screen, pictures: Path
) -> None:
    def spoil(socket) -> None:
        server = socket.connect_to_server()

        def pass_on(message: str) -> None:
            frame = json.loads(message)
            frame["doubted"] = ["tension:unwind_tension_N", "rms:unwind_tension_N"]
            socket.send(json.dumps(frame))

        server.on_message(pass_on)
        socket.on_message(server.send)

    page.page.route_web_socket(re.compile("/live"), spoil)
    page.page.reload()
    page.await_live()
    assert page.crossed_out(NUMBER)
    assert not page.crossed_out('[data-slot="speed"]')
    page.picture(pictures / "doubted.png")


def test_a_screen_server_that_hangs(page: Page, screen, pictures: Path, figures) -> None:
    start_ms = page.watch()
    screen.process.send_signal(signal.SIGSTOP)
    try:
        figures["hmi"] = stale = page.stale_since(start_ms, "hmi")
        judge(stale)
        pause(0.4)
        assert all(page.dead("plc"))
        assert all(page.dead("service"))
        assert page.crossed_out(NUMBER)
        assert "No data from the screen server" in page.text("#broken")
        page.picture(pictures / "stale-hmi.png")
        assert screen.service.status()["state"] == "FAULT"  # and the service has felt nothing
    finally:
        screen.process.send_signal(signal.SIGCONT)
    page.await_live()


def test_a_cable_that_is_pulled(page: Page, screen, pictures: Path, figures) -> None:
    start_ms = page.watch()
    screen.cable.cut()
    try:
        figures["network"] = stale = page.stale_since(start_ms, "hmi")
        judge(stale)
        pause(5.0)
        assert all(page.dead("plc"))
        assert page.text("#state") == "UNKNOWN"
        page.picture(pictures / "stale-network.png")
    finally:
        screen.cable.mend()
    page.await_live()
    assert not any(page.dead("plc"))


def test_a_supervisor_that_hangs_is_told_and_the_numbers_go_on(
    page: Page, screen, pictures: Path, figures
) -> None:
    start_ms = page.watch()
    screen.service.process.send_signal(signal.SIGSTOP)
    try:
        figures["supervisor"] = stale = page.stale_since(start_ms, "supervisor")
        judge(stale)
        pause(0.4)
        assert all(page.dead("supervisor"))
        assert page.crossed_out("#config")
        assert "The supervisor is silent:" in page.text("#broken")
        assert page.text("#state") != "UNKNOWN"
        page.picture(pictures / "stale-supervisor.png")
        page.await_selector("#alarms li[data-rank]")
        until("the notice", lambda: "SUPERVISOR" in page.text("#alarms"))
        assert not any(page.dead("plc"))
    finally:
        screen.service.process.send_signal(signal.SIGCONT)
    until("the end of the notice", lambda: "SUPERVISOR" not in page.text("#alarms"))


def test_a_tab_that_slept_shows_nothing_until_something_new_has_come(page: Page) -> None:
    hide = """(hidden) => {
      Object.defineProperty(document, "hidden", {get: () => hidden, configurable: true});
      document.dispatchEvent(new Event("visibilitychange"));
    }"""
    page.page.evaluate(hide, True)
    assert page.text(NUMBER) == "—"
    assert page.text("#state") == "UNKNOWN"
    pause(1.0)
    assert page.text(NUMBER) == "—"
    page.page.evaluate(hide, False)
    page.await_live()
    assert page.text(NUMBER) != "—"


def test_a_screen_server_that_was_started_anew_is_followed_by_itself(page: Page, screen) -> None:
    before = page.run("() => document.documentElement.dataset.boot")
    screen.restart()
    page.await_selector(f"html:not([data-boot='{before}'])[data-seq]")
    page.await_live()
