"""What ``aff-runtime compare`` takes for two windows of 10 min: ``python -m benchmarks.compare``.

A run of 20 minutes at 5 ms with the columns of the shipped Modbus site, its law's too, is written
by the recorder's own folder from a formula; then the command is run as it is typed. What counts is
the processor time of that process, all of it: start, imports, reading, page.
"""

from __future__ import annotations

import argparse
import math
import resource
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from aff_runtime.app.wiring.site_to_law import site_params
from aff_runtime.base.python_child import module_command
from aff_runtime.base.signals import Outcome, State
from aff_runtime.config.loader import load_site
from aff_runtime.core.controller import Controller
from aff_runtime.loop.record import record_columns
from aff_runtime.telemetry.header import RingHeader, RunMeta
from aff_runtime.telemetry.recorder_messages import RunContext
from aff_runtime.telemetry.run_folder import RunFolder

SITE = Path("config/euclid.yaml")
CYCLE_S, WINDOW_S, MOST_S = 0.005, 600.0, 10.0
BATCH = 12_000
SPEED_M_S, ROLL_M, ROLLER_M = 1.0, 0.2032, 0.15367


def write_run(folder: Path) -> tuple[Path, int]:
    """Return a run of two windows, and its number of columns."""
    site = load_site(SITE)
    law = Controller(site_params(site), {})
    outputs = [f"{name}_m_s" for name in site.actuators]
    columns = record_columns(tuple(site.gateway.read.channels), outputs, law.telemetry_names())
    head = RingHeader(
        columns=tuple(columns),
        capacity=1,
        event_capacity=1,
        signals_at=4096,
        events_at=8192,
        writer_pid=1,
        start_utc="2026-01-02T03:04:05.000+00:00",
        meta=RunMeta(),
    )
    context = RunContext(name="Euclid", site_text=SITE.read_text(encoding="utf-8"), segment_s=60.0)
    run = RunFolder(folder, replace(head, columns=tuple(columns)), context)
    rng = np.random.default_rng(1)
    total = round(2.0 * WINDOW_S / CYCLE_S)
    for begin in range(0, total, BATCH):
        tick = np.arange(begin, min(begin + BATCH, total), dtype=np.float64)
        time_s, on = CYCLE_S * tick, tick >= total / 2
        roll = SPEED_M_S / ROLL_M * time_s
        known = {name: rng.standard_normal(tick.size) for name in columns} | {
            **{name: np.zeros(tick.size) for name in ("status", "roll_id", "alarm", "state_bits")},
            "time_s": time_s,
            "tick": tick,
            "fresh": np.ones(tick.size),
            "outcome": np.full(tick.size, float(Outcome.OK)),
            "state": np.where(on, float(State.ACTIVE), float(State.READY)),
            "line_speed_m_s": SPEED_M_S + 0.001 * rng.standard_normal(tick.size),
            "unwind_radius_m": np.full(tick.size, ROLL_M),
            "unwind_angle_rad": roll,
            "swrap_follower_angle_rad": SPEED_M_S / ROLLER_M * time_s,
            "swrap_follower_speed_m_s": np.full(tick.size, SPEED_M_S),
            "correction_unwind_m_s": np.where(on, 1e-3 * np.cos(roll), 0.0),
            "correction_swrap_follower_m_s": np.zeros(tick.size),
        }
        swing = np.where(on, 0.05, 1.0) * np.cos(
            2.0 * math.pi * np.arange(1, 5)[:, None] / 7 + roll
        )
        for name in ("unwind_tension_N", "pullroll_tension_N"):
            known[name] = 90.0 + swing.sum(axis=0) + 0.25 * rng.standard_normal(tick.size)
        rows = np.stack([known[name] for name in columns], axis=1)
        run.add([tuple(row) for row in rows.tolist()])
    run.finish(ring_overruns=0)
    return run.path, len(columns)


def main() -> int:
    """Print processor and wall time of one command; 1 above the target."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        run, columns = write_run(folder)
        windows = [f"{run}@0..{WINDOW_S:g}", f"{run}@{WINDOW_S:g}..{2.0 * WINDOW_S:g}"]
        command = [*module_command("aff_runtime.cli.main"), "compare", *windows]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([*command, "--out", str(folder / "out")], check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        found_s = (after.ru_utime - before.ru_utime) + (after.ru_stime - before.ru_stime)
    rows = round(WINDOW_S / CYCLE_S)
    print(
        f"compare of two windows of {WINDOW_S:g} s, {rows} rows of {columns} columns each: "
        f"{found_s:.1f} s of one core, {1e-3 * after.ru_maxrss:.0f} MB (asked: {MOST_S:g} s)"
    )
    return 0 if found_s <= MOST_S else 1


if __name__ == "__main__":
    sys.exit(main())
