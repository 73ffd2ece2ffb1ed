"""What is not known is not shown as if it were: holes in curves, a tab that comes back, no answer.

The screen server is the real one; what it sees of a line, keeps or is told is given.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("pyarrow")

from aff_hmi.watch import News
from tests.aff_hmi.browser import staged
from tests.aff_hmi.browser.eyes import Page
from tests.aff_hmi.browser.staged import FOLLOWER, PASSWORD, Stage, moment, ready
from tests.aff_hmi.browser.told import SERVICE, Told
from tests.aff_hmi.moments import LINE

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]
T0_S = 1_800_000_000
OLD_S = 3.0
NUMBER = '[data-slot="tension:unwind_tension_N"]'
HIDE = """(hidden) => {
  Object.defineProperty(document, "hidden", {get: () => hidden, configurable: true});
  document.dispatchEvent(new Event("visibilitychange"));
}"""
INKED = """(tone) => {
  const canvas = document.querySelector("#chart canvas");
  const { width, height } = canvas;
  const { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
  const wanted = tone.match(/../g).map((two) => parseInt(two, 16));
  const columns = new Set();
  for (let n = 0; n < data.length; n += 4) {
    const isNear = wanted.every((value, c) => Math.abs(data[n + c] - value) < 8);
    if (isNear && data[n + 3] > 200) columns.add(((n / 4) % width) / width);
  }
  return [...columns].sort((a, b) => a - b);
}"""


@pytest.fixture
def stage(tmp_path: Path) -> Iterator[Stage]:
    found = Stage(tmp_path, keeps=True, commission=Told())
    yield found
    found.close()


def trend() -> dict[str, Any]:
    """Return ten minutes of which the middle half was not kept, and one lonely point in it."""
    t_s = [*range(T0_S, T0_S + 150, 2), T0_S + 300, *range(T0_S + 450, T0_S + 600, 2)]
    mean = [90.0 + n % 7 for n in range(len(t_s))]
    curve = {"label": "tension", "unit": "N", "dashed": False, "mean": mean}
    curve |= {"least": [v - 1 for v in mean], "largest": [v + 1 for v in mean]}
    times = {"from_s": T0_S, "to_s": T0_S + 600, "bin_s": 2, "t_s": t_s, "wide_s": [2] * len(t_s)}
    states = {"active": [0.0] * len(t_s), "fault": [0.0] * len(t_s), "flags": [], "good": ""}
    return {"ok": True, "trend": {**times, "curves": [curve], **states}}


def test_no_line_is_drawn_where_nothing_was_kept_and_the_table_says_so(
    chromium, stage: Stage, pictures: Path
) -> None:
    page = Page(chromium, "about:blank", locale="en", color_scheme="light")
    page.page.route("**/data/trend?*", lambda route: route.fulfill(json=trend()))
    page.page.goto(f"{stage.url}trends")
    page.await_selector("#chart canvas")
    page.page.wait_for_timeout(300)
    page.picture(pictures / "trends-hole.png")
    tone = page.run("() => getComputedStyle(document.documentElement).getPropertyValue('--now')")
    columns = page.page.evaluate(INKED, tone.strip().removeprefix("#"))
    first, last = columns[0], columns[-1]
    share = [(one - first) / (last - first) for one in columns]  # of ten minutes
    hole = [one for one in share if 0.27 < one < 0.73]
    assert len([one for one in share if one <= 0.27]) > 50
    assert hole  # the lonely point is seen, and nothing beside it
    assert all(abs(one - 0.5) < 0.02 for one in hole)
    page.page.click("#as-table summary")
    page.await_selector("#table tbody tr")
    rows = page.page.locator("#table tbody tr").all_text_contents()
    assert len([row for row in rows if row.endswith("from here nothing was kept")]) == 2
    assert page.complaints == []
    page.close()


def test_trends_opened_before_the_line_is_known_are_shown_once_it_is(
    chromium, stage: Stage
) -> None:
    page = Page(
        chromium, f"{stage.url}trends", locale="en"
    )  # no column was read from the ring yet
    page.await_live()
    count = "() => document.getElementById('group').options.length"
    assert page.run(count) == 0
    row = moment("ACTIVE").row
    assert row is not None
    stage.watch.news = News(columns=tuple(row.values), records=[tuple(row.values.values())])  # type: ignore[misc]
    page.await_selector("#chart canvas")
    assert page.run(count) > 0
    assert page.run("() => document.getElementById('curves').children.length") > 0
    assert page.complaints == []
    page.close()


def test_what_was_dead_stays_crossed_out_in_a_tab_that_comes_back_without_a_link(
    chromium, stage: Stage
) -> None:
    page = Page(chromium, stage.url, locale="en")
    page.await_live()
    assert page.text("#config") != "—"
    page.page.route_web_socket("**/live*", lambda socket: None)  # it opens, and says nothing
    fill = "document.querySelectorAll('[data-bar]').forEach(b => b.setAttribute('width', '40'))"
    page.page.evaluate(f"hidden => {{ {fill}; ({HIDE})(hidden); }}", True)
    page.page.evaluate(HIDE, False)
    page.page.wait_for_timeout(500)
    assert page.text(NUMBER) == "—"
    assert page.text("#config") == "—"
    for source in ("plc", "service", "supervisor"):
        assert all(page.dead(source))
    bars = "() => [...document.querySelectorAll('[data-bar]')].map(b => b.getAttribute('width'))"
    assert set(page.run(bars)) == {"0"}
    notes = "() => [...document.querySelectorAll('[data-note]')].map(n => n.textContent).join('')"
    assert page.run(notes) == ""
    assert page.text(".stale").endswith(" old")
    page.close()


def test_a_tab_that_comes_back_without_a_link_offers_nothing_that_it_does_not_know(
    chromium, stage: Stage
) -> None:
    page = Page(chromium, f"{stage.url}login", locale="en")
    page.page.fill("#name", "anna")
    page.page.fill("#password", PASSWORD)
    page.page.press("#password", "Enter")
    page.await_selector("#arm")
    page.await_live()
    stage.show(ready())
    page.page.click("#take")
    page.await_selector('#arm[aria-disabled="false"]')
    whose = page.text("#hand-of")
    assert whose.startswith("you have the hand")
    page.page.route_web_socket("**/live*", lambda socket: None)
    page.page.evaluate(HIDE, True)
    page.page.evaluate(HIDE, False)
    page.await_selector('#arm[aria-disabled="true"]')
    assert page.text("#arm-why") == "no fresh data"
    assert page.text("#hand-of") == "—"
    assert page.page.is_enabled("#bypass")
    page.page.unroute_all()
    page.close()


def test_an_alert_is_said_once_and_its_age_beside_it(chromium, stage: Stage) -> None:
    page = Page(chromium, stage.url, locale="en")
    page.await_live()
    assert not page.page.is_visible("#broken")
    page.run(
        """() => { window.said = [];
          const alert = document.querySelector('[role="alert"]');
          new MutationObserver(() => window.said.push(alert.textContent))
            .observe(alert, {childList: true, characterData: true, subtree: true}); }"""
    )
    stage.show(replace(moment("ACTIVE"), tick_age_s=OLD_S))
    page.await_selector("html[data-broken='service']")
    page.page.wait_for_function(
        "() => /^Silent for /.test(document.getElementById('broken-age').textContent)"
    )
    first = page.text("#broken-age")
    stage.show(replace(moment("ACTIVE"), tick_age_s=OLD_S + 1.0))  # a moment on stage does not age
    page.page.wait_for_function(
        "first => document.getElementById('broken-age').textContent !== first", arg=first
    )
    said = page.run("() => window.said")
    assert len(said) == 1
    assert said[0].startswith("The service is silent: crossed out is what it said last.")
    assert page.run("() => document.querySelector('[role=alert] #broken-age')") is None
    assert page.run("() => document.getElementById('broken-age').ariaHidden") == "true"
    page.close()


def test_a_limit_is_not_rounded_to_whole_numbers(
    chromium, stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    outputs = (replace(LINE.outputs[0], limit=0.0025), replace(FOLLOWER, limit=0.0004))
    monkeypatch.setattr(staged, "SITE", replace(LINE, outputs=outputs))
    stage.show(moment("ACTIVE"))
    page = Page(chromium, stage.url, locale="de")
    page.await_live()
    limits = "() => [...document.querySelectorAll('.limit')].map(one => one.textContent)"
    page.page.wait_for_function(f"() => ({limits})()[0] === '2,5'")
    assert page.run(limits) == ["2,5", "0,4"]
    page.close()


QUESTION = {
    "number": 3,
    "name": "speed_max",
    "text": "Most line speed",
    "default": "",
    "choices": [],
    "rows": [],
}
HANGS = {"says": "nothing"}
HUNG_MS = 60_000.0  # far more than a page waits, and less than it waits for a job
JOB = {"do": "words", "step": -1, "name": "find", "seconds": 1.0, "said": [], "ask": QUESTION}
STATE = {
    "ok": True,
    "by": "carl",
    "is_open": True,
    "may": True,
    "site": {"path": "/site.yaml", "there": True, "sha256": "0" * 64},
    "service": {**asdict(SERVICE), "probing": True, "answers": True},
    "card": True,
    "job": JOB,
    "last": None,
    "long": None,
    "long_last": None,
    "left_s": None,
}


@pytest.mark.parametrize("silence", ["refused", "nothing", "hangs"])
def test_without_an_answer_of_the_commissioner_nothing_is_stated_and_what_is_typed_stays(
    chromium, stage: Stage, silence: str
) -> None:
    page = Page(chromium, f"{stage.url}login", locale="en")
    page.page.fill("#name", "carl")
    page.page.fill("#password", PASSWORD)
    page.page.press("#password", "Enter")
    page.await_selector("#arm")
    said: dict[str, Any] = {"now": STATE}

    def tell(route: Any) -> None:
        if said["now"] == HANGS:
            return  # no answer, and no end: its process was stopped
        if said["now"] is None:
            route.abort()
        else:
            route.fulfill(json=said["now"])

    page.page.route("**/data/commissioning?*", tell)
    page.page.goto(f"{stage.url}commission")
    page.await_selector("#question:not([hidden])")
    page.page.fill("#answer", "4.")
    told = {name: page.text(f'[data-says="{name}"]') for name in ("file", "contact", "probe")}
    assert told["probe"] == "a probe is under way; BYPASS ends it"
    assert told["file"].startswith("/site.yaml, ")
    assert page.run("() => document.documentElement.dataset.probed") == "now"
    refused = {"ok": False, "text": "no answer"}
    said["now"] = {"nothing": None, "hangs": HANGS, "refused": refused}[silence]
    page.page.wait_for_selector("#work-silent:not([hidden])", timeout=HUNG_MS)
    for name in told:
        assert page.text(f'[data-says="{name}"]') == "—"
    assert page.text('[data-says="sign"]') == "—"
    assert page.run("() => document.documentElement.dataset.probed") == "now"
    assert page.page.is_visible("#question")
    assert page.page.input_value("#answer") == "4."
    said["now"] = STATE
    page.await_selector("#work-silent[hidden]")
    assert page.page.input_value("#answer") == "4."
    assert page.text('[data-says="probe"]') == told["probe"]
    page.close()
