"""The overview in a real browser: widths, languages, themes, keys, offline, hostile names."""

from __future__ import annotations

import json
import re
from itertools import product
from pathlib import Path

import pytest

from tests.aff_hmi.browser.eyes import Page

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]
WIDTHS = (360, 800, 1280, 1920)
CONTRAST = """() => {
  const lum = (c) => {
    const [r, g, b] = c.match(/[0-9.]+/g).slice(0, 3).map(Number)
      .map(v => v / 255).map(v => v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const ground = (e) => {
    for (; e; e = e.parentElement) {
      const c = getComputedStyle(e).backgroundColor;
      if (!/rgba\\(.*, 0\\)/.test(c)) return c;
    }
    return "rgb(255, 255, 255)";
  };
  let worst = [99, ""];
  for (const e of document.querySelectorAll("body *")) {
    const text = [...e.childNodes].some(n => n.nodeType === 3 && n.textContent.trim());
    if (!text || !e.getClientRects().length) continue;
    const [a, b] = [lum(getComputedStyle(e).color), lum(ground(e))].sort((x, y) => y - x);
    const ratio = (a + 0.05) / (b + 0.05);
    if (ratio < worst[0]) worst = [ratio, e.outerHTML.slice(0, 120)];
  }
  return worst;
}"""
ACTIVE = "document.activeElement"
SMALL = """() => [...document.querySelectorAll('a:not(.skip), button')]
  .filter(e => e.getClientRects().length)
  .map(e => [e.textContent, e.getBoundingClientRect()])
  .filter(([, r]) => r.width < 48 || r.height < 48).map(([t]) => t)"""


@pytest.mark.parametrize(
    ("width", "language", "theme"), list(product(WIDTHS, ("en", "de"), ("light", "dark")))
)
def test_it_fits_is_readable_and_stays_on_the_host(
    chromium, screen, pictures: Path, width: int, language: str, theme: str
) -> None:
    view = {"width": width, "height": 800}
    page = Page(chromium, screen.url, viewport=view, locale=language, color_scheme=theme)
    page.await_live()
    page.picture(pictures / f"overview-{width}-{language}-{theme}.png")
    assert page.run("() => document.documentElement.lang") == language
    assert page.run("() => document.documentElement.scrollWidth") <= width
    ratio, where = page.run(CONTRAST)
    assert ratio >= 4.5, where
    assert page.run(SMALL) == []
    assert page.complaints == []
    assert {re.sub(r"/[^/]*$", "", url) for url in page.requests} <= {
        screen.url.rstrip("/"),
        f"{screen.url}static",
    }
    page.close()


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
    for _ in range(5):
        page.page.keyboard.press("Tab")
        reached.append(
            page.run("() => document.activeElement.id || document.activeElement.className")
        )
    assert reached[:4] == ["skip", "language", "theme", "keys"]
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
            frame["coming"] = [HOSTILE]
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


@pytest.mark.parametrize("sight", ["achromatopsia", "deuteranopia", "protanopia", "tritanopia"])
def test_it_can_be_looked_at_without_some_colours(
    chromium, screen, pictures: Path, sight: str
) -> None:
    page = Page(chromium, screen.url, locale="en")
    page.await_live()
    session = page.context.new_cdp_session(page.page)
    session.send("Emulation.setEmulatedVisionDeficiency", {"type": sight})
    page.picture(pictures / f"sight-{sight}.png")
    shape = page.text("#shape")
    assert shape.strip() not in ("", "?")
    page.close()
