"""What a person sees on the page, read off the DOM."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

PATIENCE_MS = 120_000.0  # on a machine that others use too
WATCH = """() => {
  window.watched = {broken: {}, gap: 0};
  let last = performance.now();
  setInterval(() => {
    const now = performance.now();
    window.watched.gap = Math.max(window.watched.gap, now - last - 20);
    last = now;
  }, 20);
  new MutationObserver(() => {
    const name = document.documentElement.dataset.broken;
    if (name) window.watched.broken[name] ??= performance.now();
  }).observe(document.documentElement, {attributes: true, attributeFilter: ["data-broken"]});
}"""


@dataclass
class Stale:
    """How a break was shown: which link, after how long, and how late the page itself was."""

    link: str
    after_ms: float
    page_late_ms: float


class Page:
    """One page of the screen.

    Parameters
    ----------
    first : script that runs before any of the page's.

    Attributes
    ----------
    complaints : of the browser: violations of the policy, errors of scripts.
    requests : addresses that were asked for.
    """

    def __init__(self, browser: Any, url: str, first: str = "", **context: Any) -> None:
        self.context = browser.new_context(**context)
        self.context.set_default_timeout(PATIENCE_MS)
        self.page = self.context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", lambda m: self.complaints.append(m.text))
        self.page.on("pageerror", lambda e: self.complaints.append(str(e)))
        self.page.on("request", lambda r: self.requests.append(r.url))
        if first:
            self.page.add_init_script(first)
        self.page.goto(url)

    def await_live(self) -> None:
        """Wait for a frame that is shown with all links whole."""
        self.page.wait_for_selector('html[data-seq][data-broken=""]', state="attached")

    def await_selector(self, selector: str) -> None:
        self.page.wait_for_selector(selector, state="attached")

    def text(self, selector: str) -> str:
        return str(self.page.inner_text(selector))

    def alive(self, selectors: list[str]) -> list[str]:
        """Return texts read at one moment in which nothing is stale; a starved machine has few."""
        script = f"""() => document.documentElement.dataset.broken !== "" ? null :
          {json.dumps(selectors)}.map(s => document.querySelector(s).textContent)"""
        for _ in range(100):
            self.await_live()
            if (found := self.run(script)) is not None:
                return list(found)
        raise AssertionError("the page was stale a hundred times")

    def run(self, script: str) -> Any:
        return self.page.evaluate(script)

    def watch(self) -> float:
        """Begin to watch for a break; return the page's own time, ms."""
        self.run(WATCH)
        return float(self.run("() => performance.now()"))

    def stale_since(self, start_ms: float, link: str) -> Stale:
        """Wait until the break of a link is shown; a starved machine may show another first."""
        self.await_selector(f"html[data-broken='{link}']")
        at_ms = self.run(f"() => window.watched.broken.{link}")
        return Stale(link, at_ms - start_ms, float(self.run("() => window.watched.gap")))

    def dead(self, source: str) -> list[bool]:
        """Return for everything that comes from a source whether it is crossed out."""
        return list(
            self.run(
                f"""() => [...document.querySelectorAll('.live[data-from="{source}"]')]
                .map(e => e.classList.contains('dead'))"""
            )
        )

    def crossed_out(self, selector: str) -> bool:
        """Return whether the browser draws a line through a text."""
        style = f"getComputedStyle(document.querySelector({json.dumps(selector)}))"
        return "line-through" in str(self.run(f"() => {style}.textDecorationLine"))

    def picture(self, path: Path) -> None:
        self.page.screenshot(path=str(path), full_page=True)

    def close(self) -> None:
        self.context.close()
