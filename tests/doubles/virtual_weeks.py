"""Weeks of runs from a formula, written by the recorder's own folder: what a roller is, is known.

A run a day: a short stretch at the start, a few rows at its end. The segments between are gone, as
they are where the disk is bound; the line ran on at its speed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np

from aff_runtime.base.signals import State
from aff_runtime.core.monitor import OrderState
from aff_runtime.loop.record import record_columns
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.recorder_messages import RunContext
from aff_runtime.telemetry.run_folder import RunFolder
from tests.aff_runtime.telemetry.heads import head_of

CYCLE_S, STRETCH_S, TAIL_S = 0.02, 40.0, 0.2
RUN_S = 36_000.0
SPEED_M_S = 1.0
RADIUS_M = {"r6": 0.0381, "healthy": 0.05}
BEGAN = datetime(2026, 1, 5, 6, tzinfo=UTC)
KM_A_DAY = 1e-3 * SPEED_M_S * RUN_S
N_PER_M = 5e4
CHANNELS = ("unwind_tension_N", "line_speed_m_s")
SITE = """line: { name: Weeks, speed: line_speed_m_s }
gateway: { read: { channels: { unwind_tension_N: {}, line_speed_m_s: {} } } }
rolls:
  r6: { radius_m: 0.0381 }
  healthy: { radius_m: 0.05 }
actuators:
  unwind:
    error: { signal: unwind_tension_N }
    limit_m_s: 0.05
    blocks:
      - { roll: r6, orders: [1], settle_s: 4, amp_limit_m_s: 0.002 }
      - { roll: healthy, orders: [1], settle_s: 4 }
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Weeks:
    """What the plant had.

    Attributes
    ----------
    r6_m : eccentricity of R6 over the web that ran, km, and the day.
    scatter_m : standard deviation from day to day, of both rollers. ``healthy_m``: of the other.
    correcting : AFF cancels all but a twentieth, and learns; else it is off.
    noise_N : of one reading.
    """

    r6_m: Callable[[float, int], float]
    scatter_m: float = 0.0
    healthy_m: float = 2e-5
    correcting: bool = True
    noise_N: float = 0.05
    speed_m_s: float = SPEED_M_S
    seed: int = 1


def write_weeks(weeks: Weeks, runs: Path, days: range) -> Iterator[Path]:
    """Yield the run of each day as it is written."""
    rng = np.random.default_rng(weeks.seed)
    for day in range(days.stop):
        off_m = weeks.scatter_m * rng.standard_normal(2)
        km = day * 1e-3 * weeks.speed_m_s * RUN_S
        sizes = {"r6": weeks.r6_m(km, day) + off_m[0], "healthy": weeks.healthy_m + off_m[1]}
        if day in days:
            yield write_run(weeks, runs, BEGAN + timedelta(days=day), sizes, rng)


def write_run(
    weeks: Weeks, runs: Path, begin: datetime, sizes_m: dict[str, float], rng: np.random.Generator
) -> Path:
    """Write one run; ``sizes_m``: eccentricity of each roller."""
    law = [f"unwind.{r}_1x.{c}" for r in RADIUS_M for c in ("amplitude_m_s", "phase_deg", "state")]
    columns = record_columns(CHANNELS, ("unwind_m_s",), law)
    folder = RunFolder(
        runs,
        replace(head_of(RunMeta(), begin.isoformat()), columns=tuple(columns)),
        RunContext(name="Weeks", site_text=SITE, segment_s=STRETCH_S),
    )
    n, tail = round(STRETCH_S / CYCLE_S), round(TAIL_S / CYCLE_S)
    time_s = np.concatenate([np.arange(n), np.arange(tail) + round(RUN_S / CYCLE_S) - tail])
    rows = dict.fromkeys(columns, np.zeros(n + tail)) | {"time_s": time_s * CYCLE_S}
    rows |= {"tick": time_s, "fresh": np.ones(n + tail), "state": np.full(n + tail, State.ACTIVE)}
    rows |= {f"{name}_us": 200.0 + 20.0 * rng.random(n + tail) for name in ("wake", "io", "tick")}
    rows["line_speed_m_s"] = np.full(n + tail, weeks.speed_m_s)
    tension = 90.0 + weeks.noise_N * rng.standard_normal(n + tail)
    for roll, radius_m in RADIUS_M.items():
        omega = weeks.speed_m_s / radius_m
        left = 0.05 if weeks.correcting else 1.0
        swing = np.cos(omega * rows["time_s"] + rng.uniform(0.0, math.tau))
        tension += left * N_PER_M * sizes_m[roll] * swing
        if weeks.correcting:
            name = f"unwind.{roll}_1x"
            rows["correction_unwind_m_s"] = rows["correction_unwind_m_s"] + 0.001
            wander = 1.0 + 0.002 * rng.standard_normal(n + tail)
            rows[f"{name}.amplitude_m_s"] = omega * sizes_m[roll] * wander
            rows[f"{name}.state"] = np.full(n + tail, OrderState.SETTLED)
    rows["unwind_tension_N"] = tension
    folder.add([tuple(row) for row in np.stack([rows[c] for c in columns], axis=1).tolist()])
    folder.finish(ring_overruns=0)
    return folder.path
