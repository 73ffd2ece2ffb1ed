"""Our step beside scipy's solvers on the same equations and ticks, by error and time.

A drive's torque jumps every millisecond, so a solver begins anew at every tick. All take the
compiled slope of the line; ours is inside one compiled call, theirs is called from Python, and how
often is said beside the time.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.runtime.facts import FactRow, Section
from sim_plant.base.arrays import Array, LineArrays, LineState
from sim_plant.base.jit import compiled
from sim_plant.line.equations.kernel import Work, measure, rk4, run_drives, run_loops, slope
from sim_plant.line.equations.layout import Layout
from sim_plant.line.open import make_line
from sim_plant.line.reading.load import load_declaration
from sim_plant.line.running.simulation import LineSimulation

LINE = Path(__file__).resolve().parents[2] / "config" / "lines" / "euclid_ripple.yaml"
SIMULATED_S = 0.5
REFERENCE = ("DOP853", 1e-12)
PEERS = tuple((name, at) for name in ("RK45", "DOP853", "LSODA") for at in (1e-6, 1e-9))
SMALL = 1e-3  # absolute tolerance over the relative one: strains are thousandths


@compiled
def rate(p: LineArrays, lay: Layout, s: LineState, w: Work, y: Array, dy: Array) -> None:
    """Write dy/dt; callable from Python."""
    slope(p, lay, s, w, y, dy)


@compiled
def step(p: LineArrays, lay: Layout, s: LineState, w: Work, dt_s: float) -> None:
    """Take our one step of a tick."""
    rk4(p, lay, s, w, dt_s)


@compiled
def before_tick(
    p: LineArrays, lay: Layout, s: LineState, speed_m_s: float, aff_m_s: Array, noise: Array
) -> None:
    """Run the drives."""
    run_drives(p, lay, s, speed_m_s, aff_m_s, noise)


@compiled
def before_frame(
    p: LineArrays, lay: Layout, s: LineState, tension_N: Array, period_s: float
) -> None:
    """Run the tension loops."""
    run_loops(p, lay, s, tension_N, period_s)


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """Tensions at every tick, what integrating took, and how many slopes a tick asked for."""

    tensions_N: Array
    took_s: float
    slopes: float


def run(method: str, tolerance: float) -> Run:
    """Run the settled line tick by tick; without ``method`` by that many steps of ours a tick."""
    line = make_line(load_declaration(LINE), seed=None)
    p, lay, s = line.arrays, line.layout, line.state
    timing, point = p.timing[0], line.declaration.operating_point
    tick_s, per_frame = float(timing["drive_tick_s"]), int(timing["ticks_per_frame"])
    frame_s = tick_s * per_frame
    loops = int(timing["frames_per_loop"])
    tension = np.full(p.loops.size, point.tension_N)
    still, noise = np.zeros(p.drives.size), np.zeros(p.drives.size + p.cells.size)
    advance, calls = way(line, method, tolerance)
    advance(0.0)  # compiled, nothing moves
    rows, took_s, calls[0] = [], 0.0, 0
    for frame in range(round(SIMULATED_S / frame_s)):
        if frame % loops == 0:
            before_frame(p, lay, s, tension, loops * frame_s)
        for _ in range(per_frame):
            before_tick(p, lay, s, point.line_speed_m_s, still, noise)
            begun_s = time.process_time()
            advance(tick_s)
            took_s += time.process_time() - begun_s
            rows.append(s.y[lay.cell : lay.cell + p.cells.size].copy())
        measure(p, lay, s, noise)
    return Run(tensions_N=np.array(rows), took_s=took_s, slopes=calls[0] / len(rows))


def way(
    line: LineSimulation, method: str, tolerance: float
) -> tuple[Callable[[float], None], list[int]]:
    """Return what integrates over a time, and a count of slopes."""
    p, lay, s, w = line.arrays, line.layout, line.state, line.work
    calls = [0]

    def ours(over_s: float) -> None:
        for _ in range(round(tolerance)):
            step(p, lay, s, w, over_s / tolerance)
            calls[0] += 4

    def derivative(_t: float, y: Array) -> Array:
        dy = np.zeros(y.size)
        rate(p, lay, s, w, np.ascontiguousarray(y), dy)
        calls[0] += 1
        return dy

    def theirs(over_s: float) -> None:
        if over_s > 0.0:
            found = solve_ivp(
                derivative, (0.0, over_s), s.y, method, rtol=tolerance, atol=SMALL * tolerance
            )
            s.y[:] = found.y[:, -1]

    return (theirs if method else ours), calls


def peers() -> Section:
    """Return error over ripple, time per tick and slopes per tick of each way."""
    truth = run(*REFERENCE).tensions_N
    ripple = np.std(truth, axis=0)
    best, fine = (
        min((run("", steps) for _ in range(5)), key=lambda one: one.took_s) for steps in (1.0, 4.0)
    )
    found = [("our step of 1 ms", best), ("ours of 0.25 ms", fine)]
    found += [(f"{method}, {tolerance:g}", run(method, tolerance)) for method, tolerance in PEERS]
    rows = []
    for name, one in found:
        error = np.sqrt(np.mean((one.tensions_N - truth) ** 2, axis=0))
        rows.append(
            FactRow(
                name=name,
                value=f"{one.took_s / len(truth) * 1e6:.1f} us a tick, {one.slopes:.1f} slopes",
                remark=f"error {np.max(error / ripple):.1e} of the ripple, "
                f"{one.took_s / best.took_s:.0f} x our time, {one.slopes / 4:.1f} x our slopes",
            )
        )
    return Section(
        title="Beside scipy's solvers",
        note=f"`config/lines/{LINE.name}`, {SIMULATED_S:g} s closed loop without noise, torques "
        f"jump every 1 ms and a solver begins anew; truth: {REFERENCE[0]} at {REFERENCE[1]:g}. "
        "Our time has the call from Python in it. Slopes tell what is left without Python.",
        rows=tuple(rows),
    )
