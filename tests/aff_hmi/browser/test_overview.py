"""The overview in a real browser: widths, languages, themes, keys, offline, hostile names."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from tests.aff_hmi.browser.eyes import Page

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]


def test_it_shows_the_numbers_of_the_service(chromium, screen) -> None:
    page = Page(chromium, screen.url, locale="en")
    status = screen.service.status()
    seen = page.alive(
        ["h1", "#state", "#config", '[data-slot="tension:unwind_tension_N"]', "#why"]
    )
    assert seen[:3] == [status["line"], status["state"], status["config_hash"][:8]]
    assert abs(float(seen[3]) - 90.0) < 10.0
    assert "run the probe" in seen[4]
    page.close()


def test_german_has_its_comma_and_the_page_is_light_enough(chromium, screen) -> None:
    page = Page(chromium, screen.url, locale="de-DE")
    page.await_live()
    assert re.fullmatch(r"\d+,\d", page.text('[data-slot="tension:unwind_tension_N"]'))
    sizes = page.run("() => performance.getEntries().map(e => e.decodedBodySize ?? 0)")
    assert sum(sizes) < 150_000
    assert len(page.requests) <= 8
    page.close()


def test_keys_do_what_the_list_says(chromium, screen) -> None:
    page = Page(chromium, screen.url, locale="en", color_scheme="light")
    page.await_live()
    page.page.keyboard.press("t")
    assert page.run("() => document.documentElement.dataset.theme") == "dark"
    page.page.keyboard.press("?")
    assert page.run("() => document.getElementById('help').open") is True
    page.page.keyboard.press("Escape")
    assert page.run("() => document.getElementById('help').open") is False
    page.page.keyboard.press("a")
    assert page.run("() => document.activeElement.id") == "alarms"
    page.page.keyboard.press("l")
    page.await_selector('html[lang="de"][data-seq]')
    assert page.run("() => document.documentElement.dataset.theme") == "dark"
    page.close()


def test_every_control_is_reached_by_the_tabulator(chromium, screen) -> None:
    page = Page(chromium, screen.url, locale="en")
    page.await_live()
    reached = []
    for _ in range(6):
        page.page.keyboard.press("Tab")
        reached.append(
            page.run("() => document.activeElement.id || document.activeElement.className")
        )
    assert reached[:5] == ["skip", "language", "theme", "units", "keys"]
    page.close()


def test_units_are_the_readers_choice_and_stay(chromium, screen, pictures: Path) -> None:
    page = Page(chromium, screen.url, locale="en", viewport={"width": 1280, "height": 800})
    slot = '[data-slot="reference:unwind_tension_N"]'  # the tension itself swings meanwhile
    speed = '[data-slot="speed"]'
    newton, per_min = (float(text) for text in page.alive([slot, speed]))
    page.page.keyboard.press("u")
    page.await_selector("#units [data-unit='N']:text-is('lbf')")
    pound, feet = (float(text) for text in page.alive([slot, speed]))
    assert pound == pytest.approx(newton * 0.2248, rel=0.05)
    assert feet == pytest.approx(per_min * 3.281, rel=0.05)
    shown = page.run("() => [...document.querySelectorAll('main .unit')].map(e => e.textContent)")
    assert not [text for text in shown if re.match(r"(N|mm|m/min|mm/s)\b", text)]
    page.picture(pictures / "units-us.png")
    page.page.goto(screen.url + "scope")
    page.await_live()
    page.await_selector("#readout tbody tr")
    assert "[lbf]" in page.text("#readout")
    assert "[N]" not in page.run("() => document.getElementById('of').textContent")
    page.page.goto(screen.url + "trends")
    page.await_live()
    page.page.select_option("#group", "speed")
    page.page.wait_for_function(
        "() => document.getElementById('curves').textContent.includes('FPM')"
    )
    page.page.keyboard.press("u")
    page.await_selector("#units [data-unit='N']:text-is('N')")
    assert page.complaints == []
    page.close()


HOSTILE = '<img src=x onerror="window.owned=1"><script>window.owned=1</script>"\'&\u202e'


def test_a_hostile_frame_is_text_and_runs_nothing(chromium, screen, pictures: Path) -> None:
    page = Page(chromium, screen.url, locale="en")
    page.await_live()

    def spoil(socket) -> None:
        server = socket.connect_to_server()

        def pass_on(message: str) -> None:
            frame = json.loads(message)
            frame |= {"why": HOSTILE, "to_do": HOSTILE, "word": HOSTILE, "shape": HOSTILE}
            frame["config"] = HOSTILE
            frame["coming"] = [{"text": HOSTILE, "radius_mm": 154}]
            frame["alarms"] = [{"rank": 1, "name": HOSTILE, "text": HOSTILE, "to_do": HOSTILE}]
            frame["events"] = [{"name": HOSTILE, "text": HOSTILE, "ago_s": 1.0}]
            frame["notes"] = dict.fromkeys(frame["notes"], HOSTILE)
            socket.send(json.dumps(frame))

        server.on_message(pass_on)
        socket.on_message(server.send)

    page.page.route_web_socket(re.compile("/live"), spoil)
    page.page.reload()
    page.await_live()
    assert page.run("() => window.owned") is None
    assert page.run("() => document.querySelectorAll('img, script:not([src])').length") == 0
    assert HOSTILE.replace("\u202e", "") in page.text("#why").replace("\u202e", "")
    assert "<script>" in page.text("#alarms")
    assert page.run("() => document.documentElement.scrollWidth <= innerWidth")
    page.picture(pictures / "hostile.png")
    page.close()
