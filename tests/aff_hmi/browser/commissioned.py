"""A person who commissions at the screen alone, and the line that is commissioned."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeAlias

from sim_plant.demo.wires import free_port
from tests.aff_hmi.browser.eyes import Page
from tests.aff_runtime.app.service_run import ROOT
from tests.aff_runtime.app.setup.machine_answers import MACHINE_ANSWERS

START_S = 180.0
Given: TypeAlias = Mapping[str, str | Callable[[], str]]
# what the displays of the simulated Euclid line show at 200 FPM, and where its manual has words
ANSWERS = {
    "host": "127.0.0.1",
    "count": "24",
    "name": "Euclid",
    "second": "swrap_follower",
    "second.tension": "pullroll_tension_N",
    "unwind_tension_N.display": "89.5 N",  # word 6, a radius, fits it as well at any second
    "tension_ref_N.display": "88.96 N",
    "tension_ref_N.pick": "w4",
    "line_speed_m_s.display": "200 FPM",
    "line_speed_m_s.pick": "w5",
    "unwind_radius_m.pick": "w6",
    "swrap_follower_speed_m_s.display": "200 FPM",
    "swrap_follower_speed_m_s.pick": "w7",
    "pullroll_tension_N.display": "91 N",
    "pullroll_tension_N.pick": "w9",
    "speed_max": "300 FPM",
    **MACHINE_ANSWERS,
    "probe": "0.02",
    "status.word": "1",
    "roll_id": "8",
    "echo": "15",
    "applied.unwind": "16",
    "applied.swrap_follower": "17",
}


class FreshLine:
    """`sim-plant live --fresh`: plant, service that waits, commissioner and screen."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        port = free_port()
        self.url = f"http://127.0.0.1:{port}/"
        command = (sys.executable, "-m", "sim_plant.cli.main", "live", "--fresh")
        self.log = folder.parent / "live.log"
        with self.log.open("w") as log:
            self.process = subprocess.Popen(
                [*command, "--out", str(folder), "--listen", f"127.0.0.1:{port}"],
                stdout=log,
                stderr=log,
                cwd=ROOT,
            )
        said = self._await(r"PLC to commission: 127\.0\.0\.1:(\d+)")
        self.plc_port = said[1]
        self.password = self._await(r"password (\w+)")[1]

    def _await(self, pattern: str) -> re.Match[str]:
        end_s = time.monotonic() + START_S
        while time.monotonic() < end_s:
            found = re.search(pattern, self.log.read_text())
            if found is not None:
                return found
            if self.process.poll() is not None:
                break
            time.sleep(0.2)
        raise AssertionError(self.log.read_text())

    def tell(self, *words: str) -> str:
        command = (sys.executable, "-m", "sim_plant.cli.main", "tell")
        socket = str(self.folder / "plant.sock")
        done = subprocess.run(
            [*command, socket, *words], capture_output=True, text=True, cwd=ROOT, check=True
        )
        return done.stdout

    def radius_shown(self) -> str:
        """Return what the display shows now of the unwind roll, which grows smaller."""
        return f"{json.loads(self.tell('value', 'unwind_radius_m'))['value'] * 1e3:.1f} mm"

    def close(self) -> None:
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(60.0)


class Technician:
    """Somebody with a password and a browser."""

    def __init__(self, chromium: Any, line: FreshLine, **context: Any) -> None:
        self.line = line
        self.screen = Page(chromium, f"{line.url}login?lang=en", **context)
        self.page = self.screen.page
        self.page.fill("#name", "demo")
        self.page.fill("#password", line.password)
        self.page.press("#password", "Enter")
        self.page.wait_for_selector("#arm", state="attached")

    def go(self, path: str, language: str = "en") -> None:
        self.page.goto(f"{self.line.url}{path}?lang={language}")
        self.page.wait_for_selector("#opened:not([hidden]), #open:not([hidden])")

    def open(self) -> None:
        self.page.fill("#open-password", self.line.password)
        self.page.press("#open-password", "Enter")
        self.page.wait_for_selector("#opened:not([hidden])")

    def answers(self, given: Given, until: str = "") -> list[str]:
        """Answer what is asked until ``until`` is, or nothing more; return the names.

        Parameters
        ----------
        given : answers by name, or what reads them off a display that moves.
        """
        names: list[str] = []
        while True:
            self.page.wait_for_selector("#question:not([hidden]), #job[hidden]", state="attached")
            if self.page.is_hidden("#question"):
                if self.page.is_hidden("#job"):
                    return names
                self.page.wait_for_timeout(100)
                continue
            name = str(self.page.get_attribute("#question", "data-name"))
            if name == until:
                return names
            names.append(name)
            answer = given.get(name, "")
            self.answer(answer() if callable(answer) else answer)

    def answer(self, text: str) -> None:
        """Answer what is asked now; return when the next question stands there, or none."""
        before = [
            self.page.get_attribute("#question", "data-name"),
            self.page.text_content("#asked"),
            self.page.text_content("#refused"),
        ]
        self.page.fill("#answer", text)
        self.page.click("#question button[type=submit]")
        self.page.wait_for_function(
            """before => {
                const [name, asked, refused] = before;
                const box = document.getElementById('question');
                return box.hidden || box.dataset.name !== name ||
                    document.getElementById('asked').textContent !== asked ||
                    document.getElementById('refused').textContent !== refused;
            }""",
            arg=before,
        )

    def hold(self, button: str) -> None:
        """Hold a button for its second."""
        self.page.wait_for_selector(f"{button}:enabled")
        self.page.locator(button).scroll_into_view_if_needed()
        self.page.hover(button)
        self.page.mouse.down()
        self.page.wait_for_timeout(1300)
        self.page.mouse.up()

    def take_the_hand(self) -> None:
        """Take the hand, over from whoever has it."""
        self.screen.await_live()
        while not self.page.is_visible("#release"):
            if self.page.is_visible("#take"):
                self.page.click("#take")
            self.page.wait_for_timeout(300)

    def step(self, number: int, typed: dict[str, str], *, stand: str) -> None:
        """Measure a step of the card until it stands as one of ``stand``."""
        row = f'details[data-step="{number}"]'
        self.page.wait_for_selector(f"{row} .measure", state="attached")
        if self.page.get_attribute(row, "open") is None:
            self.page.click(f"{row} > summary")
        for name, value in typed.items():
            self.page.fill(f'{row} input[name="{name}"]', value)
        self.page.click(f"{row} .measure button[type=submit]")
        ends = ", ".join(f'{row}[data-stand="{one}"]' for one in stand.split("|"))
        self.page.wait_for_selector(ends, state="attached")

    def sign(self, number: int, reason: str) -> None:
        row = f'details[data-step="{number}"]'
        if self.page.get_attribute(row, "open") is None:
            self.page.click(f"{row} > summary")
        self.page.fill(f'{row} .signing input[name="reason"]', reason)
        self.page.fill(f'{row} .signing input[name="password"]', self.line.password)
        self.page.click(f"{row} .signing button[type=submit]")
        self.page.wait_for_selector(f"{row}:not(:has(.signing))")
