"""A person with a password and a browser, who commissions at the screen."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from benchmarks.wizard.fresh_line import FreshLine

Answer = Callable[[str, bool], str]
"""From the name of a question, and whether setup has an answer of its own, to what is typed."""
CHANGED = """before => {
    const [name, asked, refused] = before;
    const box = document.getElementById('question');
    return box.hidden || box.dataset.name !== name ||
        document.getElementById('asked').textContent !== asked ||
        document.getElementById('refused').textContent !== refused;
}"""
ENTRIES = "async () => (await (await fetch('/data/card?lang=en')).json()).card?.entries ?? 0"
STEP_S, LOOK_S = 300.0, 0.5
"""How long a step of the card may take, and how often is looked whether it has been measured."""


def by_name(given: Mapping[str, str | Callable[[], str]]) -> Answer:
    """Return answers by name alone, or what reads them off a display that moves."""

    def answer(name: str, is_sure: bool) -> str:
        del is_sure
        found = given.get(name, "")
        return found() if callable(found) else found

    return answer


class Technician:
    """Somebody at a page of the screen, who has logged in.

    Parameters
    ----------
    page : Playwright's; it stands at the login.
    """

    def __init__(self, page: Any, line: FreshLine) -> None:
        self.line = line
        self.page = page
        page.fill("#name", "demo")
        page.fill("#password", line.password)
        page.press("#password", "Enter")
        page.wait_for_selector("#arm", state="attached")

    def go(self, path: str, language: str = "en") -> None:
        """Open a page of commissioning."""
        self.page.goto(f"{self.line.url}{path}?lang={language}")
        self.page.wait_for_selector("#opened:not([hidden]), #open:not([hidden])")

    def open(self) -> None:
        """Let the commissioner take him in."""
        self.page.fill("#open-password", self.line.password)
        self.page.press("#open-password", "Enter")
        self.page.wait_for_selector("#opened:not([hidden])")

    def answers(self, given: Answer, until: str = "") -> list[str]:
        """Answer what is asked until ``until`` is, or nothing more; return the names."""
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
            self.answer(given(name, bool(self.page.text_content("#default"))))

    def answer(self, text: str) -> None:
        """Answer what is asked now; return when the next question stands there, or none."""
        before = [
            self.page.get_attribute("#question", "data-name"),
            self.page.text_content("#asked"),
            self.page.text_content("#refused"),
        ]
        self.page.fill("#answer", text)
        self.page.click("#question button[type=submit]")
        self.page.wait_for_function(CHANGED, arg=before)

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
        self.page.wait_for_selector('html[data-seq][data-broken=""]', state="attached")
        while not self.page.is_visible("#release"):
            if self.page.is_visible("#take"):
                self.page.click("#take")
            self.page.wait_for_timeout(300)

    def state(self) -> str:
        """Return the guard's state as the screen shows it."""
        return str(self.page.get_attribute("html", "data-state"))

    def begin_card(self) -> None:
        """Begin a card, and have all of it there."""
        self.go("card")
        self.page.click("#begin")
        self.page.wait_for_selector("#card:not([hidden])")

    def step(self, number: int, typed: Mapping[str, str], *, stand: str) -> str:
        """Measure a step of the card; return how it stands then, one of ``stand``."""
        row = f'details[data-step="{number}"]'
        self.page.wait_for_selector(f"{row} .measure", state="attached")
        if self.page.get_attribute(row, "open") is None:
            self.page.click(f"{row} > summary")
        for name, value in typed.items():
            self.page.fill(f'{row} input[name="{name}"]', value)
        before = self.page.evaluate(ENTRIES)
        self.page.click(f"{row} .measure button[type=submit]")
        for _ in range(int(STEP_S / LOOK_S)):
            if self.page.evaluate(ENTRIES) > before:
                break
            self.page.wait_for_timeout(1e3 * LOOK_S)
        ends = ", ".join(f'{row}[data-stand="{one}"]' for one in stand.split("|"))
        self.page.wait_for_selector(ends, state="attached")
        return str(self.page.get_attribute(row, "data-stand"))

    def sign(self, number: int, reason: str) -> None:
        """Sign the measurement of a step."""
        row = f'details[data-step="{number}"]'
        if self.page.get_attribute(row, "open") is None:
            self.page.click(f"{row} > summary")
        self.page.fill(f'{row} .signing input[name="reason"]', reason)
        self.page.fill(f'{row} .signing input[name="password"]', self.line.password)
        self.page.click(f"{row} .signing button[type=submit]")
        self.page.wait_for_selector(f"{row}:not(:has(.signing))")
