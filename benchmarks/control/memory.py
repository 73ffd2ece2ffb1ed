"""Does the law's memory grow? Minutes of ticks without a plant, watched outside and inside."""

from __future__ import annotations

import gc
import sys
import time
from typing import Any

from benchmarks.control.laws import shape_law
from benchmarks.control.timing import PERIOD_S, Steady

WEEK_TICKS = round(7 * 86400 / PERIOD_S)
CHECKS = 10


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
    line = Steady(shape_law("tyvek"))
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
        "case": "24 orders and S-wrap 1x", "ticks": ticks, "week_ticks": WEEK_TICKS,
        "objects": last[1], "objects_grown": last[1] - first[1], "bytes": last[2],
        "bytes_grown": last[2] - first[2], "blocks_grown": last[3] - first[3],
        "resident_kB": last[4], "resident_grown_kB": last[4] - first[4],
    }  # fmt: skip
