"""Does the law's memory grow? Minutes of ticks without a plant, watched outside and inside.

The line is a sine and noise: what a tick keeps does not depend on where its numbers come from. It
ramps, crawls, loses samples, changes its roll, is bypassed and armed again, over and over.
"""

from __future__ import annotations

import gc
import sys
import time
from typing import Any

import numpy as np

from aff_runtime.base.signals import Outcome, Snapshot
from benchmarks.control.laws import shape_law
from benchmarks.control.lockstep import LawBuilder
from benchmarks.control.timing import PERIOD_S, Steady

WEEK_TICKS = round(7 * 86400 / PERIOD_S)
CHECKS = 10
ROUND_TICKS = 2000  # of events, over and over
SPEED_AT = ([0, 400, 700, 1000, 1150, 1300, 1500], [1.0, 1.0, 1.5, 1.5, 0.05, 0.05, 1.0])
BYPASSED = range(1700, 1900)
MISSED_EVERY = 97


class Eventful(Steady):
    """The same line with a life: ramps, a crawl, missed samples, new rolls, bypass and arm."""

    def __init__(self, build: LawBuilder, seed: int = 0) -> None:
        super().__init__(build, seed)
        self._turned_m = 0.0
        self.splices = 0

    def prepare(self) -> None:
        """Set the signals of the next tick; the rolls' angles follow."""
        k = self._tick
        self._tick += 1
        at = k % ROUND_TICKS
        speed = float(np.interp(at, *SPEED_AT))
        self._turned_m += speed * PERIOD_S
        theta = self._turned_m / 0.2032
        fresh = k % MISSED_EVERY != 0
        tension = 88.96 + float(np.sin(theta)) + 0.25 * float(self._noise[k % 4096])
        values = (tension, 88.96, speed, 0.2032, 90.0, theta, self._turned_m / 0.15367, speed)
        snapshot = Snapshot(
            tick=k,
            t_ns=0,
            outcome=Outcome.OK,
            fresh=fresh,
            age_s=0.0,
            plc_heartbeat=k,
            status=255,
            roll_id=1 + k // ROUND_TICKS,
            values=values,
        )
        if self._phases.step(snapshot, PERIOD_S):
            for roll in self._phases.spliced:
                self.law.reset_roll(roll)
                self.splices += 1
        given = self._given
        given.signal, given.reference, given.line_speed_m_s = tension, 88.96, speed
        given.fresh, given.adapt = fresh, at not in BYPASSED
        given.applied_ratio = 1.0 if given.adapt else 0.0


def resident_kB() -> int:
    """Return what the process holds in memory now, kB; -1 where /proc is not there."""
    try:
        with open("/proc/self/status") as lines:
            return next((int(t.split()[1]) for t in lines if t.startswith("VmRSS:")), -1)
    except OSError:
        return -1


def footprint(root: object) -> tuple[int, int]:
    """Return how many containers and arrays hang on ``root``, and their size in bytes.

    Bare numbers and texts are left out: Python shares some of them and not others.
    """
    seen: dict[int, object] = {}
    todo = [root]
    while todo:
        item = todo.pop()
        known = id(item) in seen or isinstance(item, type | int | float | complex | str | None)
        if known or hasattr(item, "__spec__") or hasattr(item, "__code__"):
            continue
        seen[id(item)] = item
        todo += gc.get_referents(item)
    return len(seen), sum(sys.getsizeof(o) + int(getattr(o, "nbytes", 0)) for o in seen.values())


def watch_memory(duration_s: float) -> dict[str, Any]:
    """Run the shape law for a time; return ticks and growth of objects, blocks and process.

    Growth is from after the first tenth (every buffer has been used) to the end; blocks are what
    the interpreter has allocated, of any kind.
    """
    line = Eventful(shape_law("tyvek"))
    ticks = 0
    started = time.perf_counter()
    found: list[tuple[int, int, int, int, int]] = []
    for check in range(1, CHECKS + 1):
        while time.perf_counter() - started < duration_s * check / CHECKS:
            for _ in range(1000):
                line.prepare()
                line.step()
            ticks += 1000
        gc.collect()
        objects, size = footprint(line)
        found.append((ticks, objects, size, sys.getallocatedblocks(), resident_kB()))
    first, last = found[0], found[-1]
    return {
        "case": "24 orders and S-wrap 1x; events every 10 s",
        "ticks": ticks,
        "week_ticks": WEEK_TICKS,
        "objects": last[1],
        "objects_grown": last[1] - first[1],
        "bytes": last[2],
        "bytes_grown": last[2] - first[2],
        "blocks_grown": last[3] - first[3],
        "resident_kB": last[4],
        "resident_grown_kB": last[4] - first[4],
    }
