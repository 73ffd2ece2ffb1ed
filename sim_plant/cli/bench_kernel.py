"""How fast the compiled line runs, at a step whose convergence is measured beside it."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.line.declared.declaration import Declaration, LoadCell
from sim_plant.line.open import make_line
from sim_plant.line.reading.load import load_declaration
from sim_plant.line.running.simulation import LineSimulation

LINES = Path(__file__).resolve().parents[2] / "config" / "lines"
REPEATS = 40
SIMULATED_S = 2.0
CONVERGED_S = 6.0
TARGET_TIMES_REAL_TIME = 100.0
TARGET_CONVERGENCE = 1e-3


def bench_kernel(line_path: Path = LINES / "euclid_ripple.yaml") -> dict[str, float | str]:
    """Time the line with its out-of-round roll, print a table and return its rows.

    Speed is simulated time over elapsed time, warm, noise on, the best of many short runs: what
    else the machine does only makes a run slower. Beside it stands the share of the processor
    that the best run had. Convergence is the rms difference of each measured tension to a run at
    a quarter of the step, over the rms ripple of that tension; the worst channel counts.
    """
    line = load_declaration(line_path)
    warm = make_line(line)
    _run(warm, 0.1)
    wall_s, cpu_s = _best(warm)
    error = convergence(line)
    rate = SIMULATED_S / wall_s
    step_s = float(warm.arrays.timing["drive_tick_s"][0] / warm.arrays.timing["substeps"][0])
    found: dict[str, float | str] = {
        "line": line_path.stem,
        "rollers": len(line.rollers),
        "shaped_bodies": int(np.sum(warm.arrays.bodies["shape_row"] >= 0)),
        "step_s": step_s,
        "simulated_s": SIMULATED_S,
        "runs": REPEATS,
        "times_real_time": rate,
        "microseconds_per_step": wall_s / SIMULATED_S * step_s * 1e6,
        "processor_share": cpu_s / wall_s,
        "convergence": error,
        "passed": float(rate >= TARGET_TIMES_REAL_TIME and error <= TARGET_CONVERGENCE),
    }
    print(table(found))
    return found


def _run(line: LineSimulation, duration_s: float) -> dict[str, Array]:
    samples = round(duration_s / line.sample_time_s)
    point = line.declaration.operating_point
    return line.simulate(
        np.full(samples, point.line_speed_m_s), np.full(samples, point.tension_N), {}
    )


def _best(line: LineSimulation) -> tuple[float, float]:
    """Return elapsed and processor time of the fastest of several runs, s."""
    best = (float("inf"), 0.0)
    for _ in range(REPEATS):
        wall, cpu = time.perf_counter(), time.process_time()
        _run(line, SIMULATED_S)
        best = min(best, (time.perf_counter() - wall, time.process_time() - cpu))
    return best


def convergence(line: Declaration, duration_s: float = CONVERGED_S) -> float:
    """Return the tension error of the shipped step over the tension's ripple, worst cell."""
    cells = [s.channel for s in line.sensors if isinstance(s, LoadCell)]
    runs = []
    for substeps in (1, 4):
        rows = _run(make_line(line, seed=None, substeps=substeps), duration_s)
        runs.append(np.column_stack([rows[name] for name in cells]))
    late = runs[0].shape[0] // 3
    error = np.sqrt(np.mean((runs[0] - runs[1])[late:] ** 2, axis=0))
    return float(np.max(error / np.std(runs[1][late:], axis=0)))


def table(found: dict[str, float | str]) -> str:
    """Return the result as text, one row each, with the targets."""
    rows = [
        (
            "line",
            f"{found['line']}: {found['rollers']} rollers, {found['shaped_bodies']} not round",
        ),
        ("step", f"{float(found['step_s']) * 1e3:g} ms, Runge-Kutta of order 4"),
        (
            "speed",
            f"{found['times_real_time']:.0f} x real time (target {TARGET_TIMES_REAL_TIME:.0f}), "
            f"best of {found['runs']} runs of {found['simulated_s']:g} s",
        ),
        (
            "one step",
            f"{found['microseconds_per_step']:.2f} us, with {found['processor_share']:.0%} of a "
            "core",
        ),
        (
            "convergence",
            f"{found['convergence']:.1e} of the tension ripple (target {TARGET_CONVERGENCE:g})",
        ),
    ]
    return "\n".join(f"{name:<12} {text}" for name, text in rows)
