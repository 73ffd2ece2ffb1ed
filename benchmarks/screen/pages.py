"""What a person sees in a real Chromium: how soon, how old, how heavy."""

from __future__ import annotations

import os
import shutil
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from aff_runtime.base.errors import PlantError
from benchmarks.runtime.facts import FactRow
from benchmarks.screen.rig import ACCOUNT, PASSWORD, Rig, pause, used
from benchmarks.screen.targets import target
from sim_plant.demo.processes import Child

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or ""
PATIENCE_MS = 60_000.0
THROTTLE = 6
# keeps when the page first was whole, the bound of every frame's age, and when breaks were shown
WATCH = """(() => {
  window.watched = {live: null, ages: [], broken: {}, state: {}};
  new MutationObserver(() => {
    const {broken, seq, state} = document.documentElement?.dataset ?? {};
    const now = performance.now();
    if (seq && broken === "") window.watched.live ??= now;
    if (broken) window.watched.broken[broken] ??= now;
    if (state) window.watched.state[state] ??= now;
  }).observe(document, {attributes: true, childList: true, subtree: true,
    attributeFilter: ["data-broken", "data-seq", "data-state"]});
  document.addEventListener("frame", ({detail}) => detail && window.watched.ages.push(
    performance.now() - detail.echo + 1000 * (detail.tick_age_s ?? 0)));
})()"""
LOADED = """() => {
  const found = performance.getEntries();
  const files = found.filter(e => ["navigation", "resource"].includes(e.entryType));
  return {paint: found.find(e => e.name === "first-contentful-paint")?.startTime ?? NaN,
    live: window.watched.live, requests: files.length,
    bytes: files.reduce((sum, e) => sum + (e.decodedBodySize ?? 0), 0)};
}"""


def reason_not() -> str:
    """Return why there is no browser; empty where there is one."""
    try:
        import playwright.sync_api  # noqa: F401
    except ImportError:
        return "playwright is not installed"
    return "" if CHROMIUM else "no Chromium on this machine: apt-get install chromium"


@contextmanager
def browser() -> Iterator[Any]:
    """Run a Chromium that reaches this machine alone."""
    from playwright.sync_api import sync_playwright

    arguments = ["--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1", "--disable-gpu"]
    if os.geteuid() == 0:
        arguments.append("--no-sandbox")
    with sync_playwright() as running:
        found = running.chromium.launch(executable_path=CHROMIUM, args=arguments)
        yield found
        found.close()


@contextmanager
def page_of(chromium: Any, url: str, throttle: int = 1) -> Iterator[Any]:
    """Open a page with an empty cache, and wait until it is live."""
    context = chromium.new_context(viewport={"width": 1280, "height": 800}, locale="en")
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    page.add_init_script(WATCH)
    if throttle > 1:
        session = context.new_cdp_session(page)
        session.send("Emulation.setCPUThrottlingRate", {"rate": throttle})
    page.goto(url)
    page.wait_for_function("() => window.watched.live !== null")
    yield page
    context.close()


def loads(chromium: Any, url: str, count: int) -> list[FactRow]:
    """Return P7: how soon a page is there, and what it weighs."""
    rows = []
    slow = f"live, processor {THROTTLE} times slower"
    for throttle, name, most_ms in ((1, "live, cold", 1000.0), (THROTTLE, slow, 2000.0)):
        found = []
        for _ in range(count):
            with page_of(chromium, url, throttle) as page:
                found.append(page.evaluate(LOADED))
        live = quantiles([one["live"] for one in found])
        paint = quantiles([one["paint"] for one in found])
        p99_ms = float(np.quantile([one["live"] for one in found], 0.99))
        remark = target(f"p99 {most_ms:g} ms", (p99_ms, most_ms))
        rows.append(FactRow(name=f"P7 {name}", value=f"{live} ms", remark=remark))
        if throttle == 1:
            p99_ms = float(np.quantile([one["paint"] for one in found], 0.99))
            remark = target("p99 300 ms", (p99_ms, 300.0))
            rows.append(FactRow(name="P7 first content", value=f"{paint} ms", remark=remark))
    rows.append(_weight("P7 a page", found[0], 150.0))
    with page_of(chromium, f"{url}trends") as page:
        rows.append(_weight("P7 a page with charts", page.evaluate(LOADED), 220.0))
    return rows


def _weight(name: str, loaded: dict[str, float], most_kB: float) -> FactRow:
    kB, requests = loaded["bytes"] / 1000.0, loaded["requests"]
    remark = target(f"{most_kB:g} kB, 8 requests", (kB, most_kB), (requests, 8))
    return FactRow(name=name, value=f"{kB:.1f} kB in {requests} requests", remark=remark)


def ages(chromium: Any, url: str, seconds: float) -> list[FactRow]:
    """Return P4 and P9: how old a shown frame can be at most, and what the page costs."""
    with page_of(chromium, url) as page:
        session = page.context.new_cdp_session(page)
        session.send("Performance.enable")
        session.send("HeapProfiler.collectGarbage")
        before, before_s = _heap_bytes(session), _drawing_s(chromium)
        page.evaluate("() => { window.watched.ages.length = 0; }")
        pause(seconds)
        found = page.evaluate("() => window.watched.ages")
        used_s = _drawing_s(chromium) - before_s
        session.send("HeapProfiler.collectGarbage")
        after = _heap_bytes(session)
    return [
        FactRow(
            name="P4 frames",
            value=f"{len(found) / seconds:.1f} per s",
            remark=target("10 ± 10 %", (9.0, len(found) / seconds), (len(found) / seconds, 11.0)),
        ),
        FactRow(
            name="P4 tick to page, at most",
            value=f"{quantiles(found)} ms",
            remark=target("p99 150 ms", (float(np.quantile(found, 0.99)), 150.0))
            + "; bound by the page's own echoed stamp",
        ),
        FactRow(
            name="P9 the page",
            value=f"{100.0 * used_s / seconds:.1f} % of a core, {after * 1e-6:.1f} MB of heap",
            remark=target("5 %, 60 MB", (100.0 * used_s / seconds, 5.0), (after * 1e-6, 60.0))
            + f"; processes that run and draw it; {(after - before) * 1e-3:+.0f} kB in "
            f"{seconds:g} s",
        ),
    ]


def _heap_bytes(session: Any) -> float:
    said = session.send("Performance.getMetrics")["metrics"]
    return next(float(one["value"]) for one in said if one["name"] == "JSHeapUsedSize")


def _drawing_s(chromium: Any) -> float:
    """Return the processor time of all pages so far, s: a busy machine does not lengthen it."""
    found = chromium.new_browser_cdp_session().send("SystemInfo.getProcessInfo")["processInfo"]
    return float(sum(one["cpuTime"] for one in found if one["type"] == "renderer"))


LINKS = ("hmi", "service", "plc")


def breaks(
    chromium: Any, url: str, rig: Rig, screen: Child, link: str, count: int
) -> list[FactRow]:
    """Return P5: how soon a stopped process is shown as such."""
    stopped: dict[str, Callable[[], int]] = {
        "hmi": lambda: screen.process.pid,
        "service": lambda: rig.control_pid,
        "plc": lambda: rig.plant.process.pid,
    }
    found = []
    for _ in range(count):
        pid = stopped[link]()
        with page_of(chromium, url) as page:
            start_ms = page.evaluate("() => (window.watched.broken = {}, performance.now())")
            os.kill(pid, signal.SIGSTOP)
            try:
                page.wait_for_function(f"() => '{link}' in window.watched.broken")
            finally:
                os.kill(pid, signal.SIGCONT)
            at_ms = page.evaluate(f"() => window.watched.broken.{link}")
        found.append(at_ms - start_ms)
        pause(1.0)
    value = f"{quantiles(found)} ms"
    p99_ms = float(np.quantile(found, 0.99))
    remark = target("p99 1000 ms, largest 1500 ms", (p99_ms, 1000.0), (max(found), 1500.0))
    return [FactRow(name=f"P5 {link} stopped", value=value, remark=remark)]


def scope(chromium: Any, url: str, screen: Child, seconds: float) -> list[FactRow]:
    """Return P8: what a page of the scope costs the screen server, beside the overview's."""
    shares = {}
    for path in ("", "scope"):
        with page_of(chromium, f"{url}{path}"):
            pause(2.0)
            before_s, _ = used(screen.process.pid)
            pause(seconds)
            shares[path] = 100.0 * (used(screen.process.pid)[0] - before_s) / seconds
    return [
        FactRow(
            name="P8 a page of the scope",
            value=f"{shares['scope']:.1f} % of a core",
            remark=target("3 %", (shares["scope"], 3.0))
            + f"; an overview {shares['']:.1f} %, the poll of the line in both",
        )
    ]


def keys(chromium: Any, url: str, rearm: Callable[[], bool], count: int) -> list[FactRow]:
    """Return P6: from F9 to the word BYPASS on the page.

    Parameters
    ----------
    rearm : arms the line again, False where it cannot be armed.
    """
    found = []
    with page_of(chromium, f"{url}") as page:
        page.goto(f"{url}login")
        page.fill("#name", ACCOUNT)
        page.fill("#password", PASSWORD)
        page.press("#password", "Enter")
        page.wait_for_selector("#arm", state="attached")
        for _ in range(count):
            if not rearm():
                break
            page.wait_for_function(
                "() => /^(ARMED|ACTIVE)$/.test(document.documentElement.dataset.state)"
            )
            page.evaluate("() => { window.watched.state = {}; }")
            page.evaluate(
                """() => document.addEventListener("keydown", () => {
                  window.pressed = performance.now(); }, {capture: true, once: true})"""
            )
            page.keyboard.press("F9")
            page.wait_for_function("() => 'BYPASS' in window.watched.state")
            found.append(page.evaluate("() => window.watched.state.BYPASS - window.pressed"))
    if not found:
        raise PlantError("the line cannot be armed")
    value = f"{quantiles(found)} ms"
    remark = target("p99 250 ms", (float(np.quantile(found, 0.99)), 250.0))
    return [FactRow(name="P6 F9 to BYPASS on the page", value=value, remark=remark)]


def quantiles(found: list[float]) -> str:
    """Return p50, p99 and the largest, as words."""
    p50, p99, most = np.quantile(np.asarray(found, dtype=float), [0.5, 0.99, 1.0])
    return f"p50 {p50:.0f}, p99 {p99:.0f}, max {most:.0f} of {len(found)}"
