"""Settings at the screen of a real service: edit, look, try, keep, undo, versions; two people."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from aff_runtime.app.hand import audit
from sim_plant.demo.wires import free_port
from tests.aff_hmi.browser.axe import grave_findings
from tests.aff_hmi.browser.commissioned import Technician
from tests.aff_hmi.browser.test_looks import looked_at
from tests.aff_runtime.app.service_run import ROOT

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]
WIDTHS = {360: 740, 768: 1024, 1280: 800, 1920: 1080}
START_S = 180.0
KEY = "actuators.unwind.soft_start_s"
OTHER = "actuators.unwind.active_above_m_s"
SEGMENT = "recording.segment_s"  # left to its default; waits for bypass
FIELD = f'.setting [name="{KEY}"]'


class RunningLine:
    """`sim-plant live --hands-off`: plant, service, commissioner and screen."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        port = free_port()
        self.url = f"http://127.0.0.1:{port}/"
        self.log = folder.parent / "live.log"
        command = (sys.executable, "-m", "sim_plant.cli.main", "live", "--hands-off")
        with self.log.open("w") as log:
            self.process = subprocess.Popen(
                [*command, "--out", str(folder), "--listen", f"127.0.0.1:{port}"],
                stdout=log,
                stderr=log,
                cwd=ROOT,
            )
        self.password = self._await(r"password (\w+)")
        self._await(r"(in another terminal)")
        (self.site,) = [
            path
            for path in folder.glob("*.yaml")
            if "gateway" in yaml.safe_load(path.read_text(encoding="utf-8"))
        ]

    def _await(self, pattern: str) -> str:
        end_s = time.monotonic() + START_S
        while time.monotonic() < end_s and self.process.poll() is None:
            if (found := re.search(pattern, self.log.read_text())) is not None:
                return found[1]
            time.sleep(0.2)
        raise AssertionError(self.log.read_text())

    def text(self) -> str:
        return self.site.read_text(encoding="utf-8")

    def close(self) -> None:
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(60.0)


@pytest.fixture(scope="module")
def line(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningLine]:
    found = RunningLine(tmp_path_factory.mktemp("settings") / "line")
    yield found
    found.close()


class Tuner(Technician):
    """Somebody at the page of settings."""

    def settings(self, language: str = "en") -> None:
        self.go("settings", language)
        self.page.wait_for_selector("html[data-settings=shown]")
        self.page.wait_for_selector("#versions td")

    def edit(self, value: str, field: str = FIELD) -> None:
        self.page.fill(field, value)

    def look(self) -> str:
        self.page.click("#edit button[type=submit]")
        self.page.wait_for_selector("#difference:not([hidden])")
        return self.screen.text("#changes")

    def try_for(self, seconds: int, why: str) -> None:
        self.page.fill("#try-seconds", str(seconds))
        self.page.fill("#try-why", why)
        self.page.click("#try button[type=submit]:not([disabled])")
        self.page.wait_for_selector("#trying:not([hidden])")

    def last(self, said: str) -> None:
        self.page.wait_for_function(
            "said => document.getElementById('job-last').textContent.includes(said)", arg=said
        )

    def newest(self, verb: str, why: str) -> list[str]:
        """Wait until the newest version has come so, and for this reason; return its row."""
        row = "#versions tr:nth-child(2)"
        self.page.wait_for_function(
            """([row, verb, why]) => {
                const cells = document.querySelector(row)?.children;
                return cells?.[2].textContent === verb && cells[4].textContent.includes(why);
            }""",
            arg=[row, verb, why],
        )
        return [str(cell) for cell in self.page.locator(f"{row} > *").all_text_contents()]


def value_of(text: str) -> Any:
    return yaml.safe_load(text)["actuators"]["unwind"]["soft_start_s"]


def test_settings_are_edited_tried_kept_undone_and_gone_back_to(
    chromium, line: RunningLine, pictures: Path
) -> None:
    first = line.text()
    before = value_of(first)
    who = Tuner(chromium, line, viewport={"width": 1280, "height": 800})
    page = who.page
    who.settings()
    assert page.input_value(FIELD) == str(before)
    assert page.is_hidden('.setting[data-path="line.cycle_ms"]')
    page.check("#all")
    page.fill("#find", "line.cycle_ms")
    waits = who.screen.text('.setting[data-path="line.cycle_ms"]')
    assert "takes effect at the next bypass" in waits
    page.uncheck("#all")
    page.fill("#find", "")
    who.open()

    # what the check refuses stands at its field, and nothing can be tried
    who.edit("-3")
    who.look()
    assert "refuses this" in who.screen.text("#changes")
    assert page.is_visible(f'.setting[data-path="{KEY}"] .of li')
    assert page.get_attribute(FIELD, "aria-invalid") == "true"
    assert page.is_hidden("#try")
    who.edit("4,5")
    page.click("#edit button[type=submit]")
    page.wait_for_function(
        "() => document.getElementById('work-said').textContent.includes('not a comma')"
    )

    # what will happen is said with units; without the hand the button says why it is grey
    who.edit("4.5")
    assert f"{KEY}: {before} s -> 4.5 s (applies at once)" in who.look()
    press = "#try button[type=submit]"
    page.wait_for_selector(f'{press}[disabled][title="take the hand first"]')
    assert line.text() == first
    who.take_the_hand()
    page.wait_for_selector(f"{press}:not([disabled])")
    who.screen.picture(pictures / "settings-difference.png")

    # a try counts down and returns by itself
    who.try_for(6, "softer when armed")
    page.wait_for_function(
        "() => /^[0-6] s until/.test(document.getElementById('tried-left').textContent)"
    )
    who.screen.picture(pictures / "settings-trying.png")
    assert line.text() == first
    page.wait_for_selector("#trying[hidden]", state="attached")
    row = who.newest("returned after a try", "its time is up")
    assert (row[3], row[4]) == ("the service", "its time is up")
    assert page.input_value(FIELD) == "4.5"  # the edit is still there

    # taken back by hand
    who.try_for(300, "softer when armed")
    page.fill("#tried-why", "felt in the web")
    page.click('#trying button[value="undo"]:not([disabled])')
    who.last("undone")
    who.newest("returned after a try", "felt in the web (demo at the screen)")

    # kept: one value in the file is another one, and its comments stand
    who.try_for(300, "softer when armed")
    page.fill("#tried-why", "not felt any more")
    page.click('#trying button[value="keep"]:not([disabled])')
    who.last("kept")
    kept = line.text()
    changed = [(a, b) for a, b in zip(first.split("\n"), kept.split("\n"), strict=True) if a != b]
    assert changed == [(changed[0][0], changed[0][0].replace(f": {before}", ": 4.5", 1))]
    who.newest("kept", "not felt any more (demo at the screen)")
    page.wait_for_selector("[data-edit][hidden]", state="attached")  # nothing is left to edit

    # two versions of the history: what each changed, and back to the first
    page.click("#versions tr:nth-child(2) button")
    page.wait_for_selector("#version .plus")
    assert "4.5" in who.screen.text("#version .plus")
    assert "this is what runs" in who.screen.text("#version-against")
    page.click("#versions tr:last-child button")
    page.wait_for_selector("#back:not([hidden])")
    assert f"{KEY}: 4.5 s -> {before} s (applies at once)" in who.screen.text("#back-changes")
    who.screen.picture(pictures / "settings-version.png")
    page.fill("#back-why", "as in spring")
    page.click("#back button[type=submit]:not([disabled])")
    who.last("version 1 is saved")
    assert line.text() == first
    who.newest("went back to it", "as in spring (demo at the screen) (version 1)")

    found = list(line.folder.rglob("commissioning/*/audit.jsonl"))
    assert [audit.verify(path).wrong for path in found] == [""]
    said = found[0].read_text(encoding="utf-8")
    assert said.count('"commissioning: try_settings"') == 6  # asked and done, three times
    assert said.count('"commissioning: go_back"') == 2
    assert [text for text in who.screen.complaints if "409" not in text] == []
    page.click("#release")
    page.click("#close-work")
    who.screen.close()


def test_what_waits_for_bypass_says_so_is_saved_and_added_at_its_place(
    chromium, line: RunningLine, pictures: Path
) -> None:
    who = Tuner(chromium, line, viewport={"width": 1280, "height": 800})
    page = who.page
    who.settings()
    who.open()
    who.take_the_hand()
    before = line.text()
    page.check("#all")
    page.fill("#find", SEGMENT)
    field = f'.setting [name="{SEGMENT}"]'
    assert page.input_value(field) == ""
    assert page.get_attribute(field, "placeholder") == "60 s"
    who.edit("0", field)
    who.look()
    assert page.is_visible(f'.setting[data-path="{SEGMENT}"] .of li')
    assert page.is_hidden("#save")
    who.edit("30", field)
    assert f"{SEGMENT}: 60 s -> 30 s (waits for bypass)" in who.look()
    assert page.is_hidden("#try")
    assert "takes effect at the next bypass" in who.screen.text("#save")
    who.screen.picture(pictures / "settings-save.png")
    page.fill("#save-why", "a crash loses less")
    page.click("#save button[type=submit]:not([disabled])")
    who.last("saved as the site file, and runs")  # no correction goes out
    who.newest("edited in the file", "a crash loses less (demo at the screen)")
    lines = line.text().split("\n")
    lines.remove("  segment_s: 30")
    assert lines == before.split("\n")
    page.wait_for_selector("[data-edit][hidden]", state="attached")
    page.click("#release")
    page.click("#close-work")
    who.screen.close()


def test_another_persons_edit_is_noticed_and_never_overwritten(
    chromium, line: RunningLine, pictures: Path
) -> None:
    who = Tuner(chromium, line, viewport={"width": 1280, "height": 800})
    page = who.page
    who.settings()
    who.open()
    who.take_the_hand()
    who.edit("7.5")
    who.look()
    page.wait_for_selector("#try:not([hidden])")
    before = line.text()
    theirs = before.replace("active_above_m_s: ", "active_above_m_s: 0.2 # ours was ", 1)
    assert theirs != before
    line.site.write_text(theirs, encoding="utf-8")
    page.wait_for_selector("#changed:not([hidden])")
    assert "Nothing of yours was sent" in who.screen.text("#changed-said")
    assert page.is_hidden("#try")
    assert page.input_value(FIELD) == "7.5"
    who.screen.picture(pictures / "settings-changed.png")
    # a browser that has not noticed is refused at the press
    stale = page.evaluate(
        """async ([key, token]) => {
          const body = JSON.stringify({base: "0".repeat(64), edits: `${key}: 7.5`, text: ""});
          const headers = {"content-type": "application/json", "x-aff-token": token};
          return (await fetch("/settings/diff", {method: "POST", headers, body})).json();
        }""",
        [KEY, page.get_attribute("#hand", "data-token")],
    )
    assert stale["code"] == "changed"
    page.click("#rebase")
    page.wait_for_selector("#changed[hidden]", state="attached")
    assert "somebody has changed it" in who.screen.text(f'.setting[data-path="{OTHER}"]')
    changes = who.look()
    assert f"{KEY}: " in changes
    assert OTHER not in changes
    who.try_for(300, "two at one line")
    page.fill("#tried-why", "both are kept")
    page.click('#trying button[value="keep"]:not([disabled])')
    who.last("kept")
    assert value_of(line.text()) == 7.5
    assert "active_above_m_s: 0.2 # ours was " in line.text()
    page.click("#release")
    page.click("#close-work")
    who.screen.close()


def test_it_fits_is_readable_and_works_by_keys(
    chromium, line: RunningLine, pictures: Path
) -> None:
    who = Tuner(chromium, line)
    page = who.page
    for language in ("en", "de"):
        for width, height in WIDTHS.items():
            page.set_viewport_size({"width": width, "height": height})
            who.settings(language)
            who.edit("9")
            page.wait_for_selector("[data-edit]:not([hidden])")
            looked_at(who.screen, width)
            who.screen.picture(pictures / f"settings-{width}-{language}.png")
            if width in (360, 1280):
                assert grave_findings(page) == []
    assert "gilt sofort" in who.screen.text(f'.setting[data-path="{KEY}"]')
    who.settings()
    page.focus(FIELD)
    page.keyboard.press("Control+a")
    page.keyboard.type("8")
    page.keyboard.press("Enter")
    page.wait_for_selector("#difference:not([hidden])")
    page.wait_for_function("() => document.activeElement.id === 'difference-title'")
    page.keyboard.press("Tab")
    page.fill("#find", "soft_start")
    assert page.locator(".setting:visible").count() >= 1
    assert page.is_hidden(f'.setting[data-path="{OTHER}"]')
    who.screen.close()
