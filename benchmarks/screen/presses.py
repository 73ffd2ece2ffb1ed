"""From a press over HTTP to the guard, and what a scrape costs."""

from __future__ import annotations

import http.client
import json
import secrets
from urllib.parse import urlsplit

import numpy as np

from aff_runtime.base.errors import PlantError
from aff_runtime.base.events import BY_NAME
from benchmarks.runtime.facts import FactRow
from benchmarks.screen.pages import quantiles
from benchmarks.screen.rig import ACCOUNT, CLOCK, PASSWORD, Rig, pause, used
from benchmarks.screen.targets import target
from sim_plant.demo.processes import Child

SCRAPES = 20
BETWEEN_S = 0.05  # fifty requests a second are answered to one address


class Presser:
    """A browser that can only press."""

    def __init__(self, url: str) -> None:
        self._host = urlsplit(url).netloc
        self._line = http.client.HTTPConnection(self._host, timeout=30.0)
        self._cookie = ""
        self.post("/login", {"name": ACCOUNT, "password": PASSWORD})

    def post(self, path: str, said: dict[str, object]) -> int:
        """Return the status of a press."""
        headers = {
            "Origin": f"http://{self._host}",
            "Content-Type": "application/json",
            "Cookie": self._cookie,
        }
        self._line.request("POST", path, json.dumps(said), headers)
        answer = self._line.getresponse()
        answer.read()
        cookie = answer.getheader("Set-Cookie")
        self._cookie = cookie.partition(";")[0] if cookie else self._cookie
        return answer.status

    def bypass(self) -> int:
        """Press it."""
        ident = secrets.token_hex(16)
        return self.post("/act", {"action": "bypass", "id": ident, "seen": "", "frame": 0})

    def get(self, path: str) -> bytes:
        """Return what is at a path; a line that is silent for five seconds is made anew."""
        try:
            self._line.request("GET", path)
            return self._line.getresponse().read()
        except (ConnectionError, http.client.HTTPException):
            self._line.close()
            self._line.request("GET", path)
            return self._line.getresponse().read()


def presses(rig: Rig, url: str, name: str, target_ms: float, count: int) -> list[FactRow]:
    """Return P6, or P2 under a flood: from the press to the guard's own note of it."""
    presser = Presser(url)
    found = []
    for _ in range(count):
        if not rig.arm():
            break
        presser.get("/static/icon.svg")  # the line is there, as a browser's is
        rig.ring.poll().events.read_new()
        start_ns = CLOCK.now_ns()
        if presser.bypass() != http.client.OK:
            break
        at_ns = rig.ring.event_ns(BY_NAME["BYPASSED"].code)
        if at_ns is not None:
            found.append((at_ns - start_ns) * 1e-6)
    if not found:
        raise PlantError("not armed, or no press was taken")
    value = f"{quantiles(found)} ms"
    remark = target(f"p99 {target_ms:.0f} ms", (float(np.quantile(found, 0.99)), target_ms))
    return [FactRow(name=name, value=value, remark=remark)]


def scrapes(url: str, screen: Child) -> list[FactRow]:
    """Return P12: what a scrape costs, and how much it says."""
    presser = Presser(url)
    text = presser.get("/metrics")
    before_s, _ = used(screen.process.pid)
    start_ns = CLOCK.now_ns()
    for _ in range(SCRAPES):
        text = presser.get("/metrics")
        pause(BETWEEN_S)
    busy_s = used(screen.process.pid)[0] - before_s
    each_ms = 1e3 * busy_s / SCRAPES
    passed_s = (CLOCK.now_ns() - start_ns) * 1e-9
    series = sum(1 for line in text.splitlines() if line and not line.startswith(b"#"))
    return [
        FactRow(
            name="P12 a scrape",
            value=f"{each_ms:.1f} ms of processor, {series} series, {len(text) / 1000:.1f} kB",
            remark=target(
                "50 ms, 1500 series, 200 kB", (each_ms, 50.0), (series, 1500), (len(text), 200e3)
            )
            + f"; {SCRAPES} in {passed_s:.1f} s",
        )
    ]
