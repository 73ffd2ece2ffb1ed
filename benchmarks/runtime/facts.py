"""What was measured, as rows of a table, and on which machine."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import numpy as np


@dataclass(frozen=True, slots=True, kw_only=True)
class FactRow:
    """One line of a table: what, how much, and beside it a remark."""

    name: str
    value: str
    remark: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """One table with its heading; ``note`` says what was measured and how, ``head`` what it is."""

    title: str
    note: str
    rows: tuple[FactRow, ...]
    head: str = "measured"


def quantiles_us(durations_ns: Sequence[int]) -> tuple[float, float, float]:
    """Return p50, p99 and the largest of some durations, us; NaN when there are none."""
    if not len(durations_ns):
        return float("nan"), float("nan"), float("nan")
    found = np.quantile(np.asarray(durations_ns, dtype=float) * 1e-3, [0.5, 0.99, 1.0])
    return float(found[0]), float(found[1]), float(found[2])


def timing_row(name: str, durations_ns: Sequence[int], remark: str = "") -> FactRow:
    """Return p50, p99 and the maximum as a row."""
    p50, p99, most = quantiles_us(durations_ns)
    return FactRow(
        name=name, value=f"p50 {p50:.0f} us, p99 {p99:.0f} us, max {most:.0f} us", remark=remark
    )


def machine() -> Section:
    """Return the facts of the machine without which no number means anything."""
    load = " ".join(f"{value:.1f}" for value in os.getloadavg())
    rows = (
        FactRow(name="processor", value=_processor()),
        FactRow(name="cores", value=str(len(os.sched_getaffinity(0)))),
        FactRow(
            name="kernel", value=f"{platform.system()} {platform.release()}", remark=_preemption()
        ),
        FactRow(name="Python", value=platform.python_version()),
        FactRow(name="numpy", value=version("numpy")),
        FactRow(name="numba", value=version("numba")),
        FactRow(name="load average", value=load, remark="1, 5, 15 min at the start"),
    )
    return Section(title="Machine", note="", rows=rows)


def _processor() -> str:
    for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.machine()


def _preemption() -> str:
    realtime = Path("/sys/kernel/realtime")
    return "PREEMPT_RT" if realtime.exists() else "not PREEMPT_RT"
