"""Run a machine under references and write what a logger would: CSV with late stamps."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from scipy.signal import lfilter

from benchmarks.campaign import line as short
from benchmarks.campaign.contact import Array, IntArray, start_vertex
from benchmarks.campaign.motion import STEPS_PER_TICK, run, start
from benchmarks.campaign.sensing import TICK_S, TICKS_PER_SCAN
from benchmarks.campaign.state import Machine

SETTLE_S = 40.0
COLOUR_SHARE, COLOUR_POLE = 0.05, 0.7
GUST_POLE = 0.995
LATEST_STEPS = 1
"""A scan comes up to this many half milliseconds late."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class References:
    """What the line is told: speed m/s and tension N, (rows,) each."""

    speed_m_s: Array
    tension_N: Array


def references(
    rows: int, rng: np.random.Generator, *, speeds: int = 3, commensurate: bool = False
) -> References:
    """Return plateaus of speed with ramps between, and two tension steps.

    ``speeds`` 1 holds one speed. ``commensurate`` takes a speed at which a line in time and
    one in travel cannot be told apart and the S-wrap turns a whole number of times a second.
    """
    time_s = np.arange(rows) * short.SAMPLE_S
    end = time_s[-1]
    levels = rng.uniform(0.7, 1.7, size=3)
    while np.min(np.abs(np.diff(levels))) < 0.2:
        levels = rng.uniform(0.7, 1.7, size=3)
    if speeds == 1:
        levels[:] = levels[0]
    if commensurate:
        levels[:] = 2.0 * np.pi * 0.12 * 2.0
    knots = end * np.array([0.0, 0.42, 0.47, 0.70, 0.76, 1.0])
    speed = np.interp(time_s, knots, np.repeat(levels, 2))
    step = rng.uniform(3.0, 8.0) * rng.choice([-1.0, 1.0])
    tension = short.WOUND_N + step * ((time_s > 0.55 * end) & (time_s < 0.85 * end))
    return References(speed_m_s=speed, tension_N=tension)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Columns:
    """One run: true scan times (rows,), channels (rows,) by name, angle of every body at row 0."""

    time_s: Array
    values: dict[str, Array]
    start_rad: Array

    def even(self) -> dict[str, Array]:
        """Return the channels on the even grid that any reader would put them on."""
        grid = np.linspace(self.time_s[0], self.time_s[-1], self.time_s.size)
        return {name: np.interp(grid, self.time_s, v) for name, v in self.values.items()}


def coloured(rng: np.random.Generator, shape: tuple[int, int], share: float) -> Array:
    """Return noise of unit size, ``share`` of its power from a first-order filter (rows, k)."""
    white = rng.standard_normal(shape)
    slow = lfilter(
        [np.sqrt(1.0 - COLOUR_POLE**2)], [1.0, -COLOUR_POLE], rng.standard_normal(shape), axis=0
    )
    found: Array = np.sqrt(1.0 - share) * white + np.sqrt(share) * slow
    return found


def simulate(
    m: Machine,
    told: References,
    angles: Array,
    seed: int,
    *,
    noise: bool = True,
    colour: float = COLOUR_SHARE,
) -> Columns:
    """Return one record; without noise sensors are exact, with the same late scans."""
    rng = np.random.default_rng(seed)
    rows = told.tension_N.size
    cells, drives, n = m.cell_body.size, m.drive_body.size, m.radius.size
    late: IntArray = rng.integers(0, LATEST_STEPS + 1, size=rows)
    late[[0, -1]] = 0
    ticks = rows * TICKS_PER_SCAN
    settling = round(SETTLE_S / short.SAMPLE_S)
    scans = rows + settling
    size = 1.0 if noise else 0.0
    cell_noise = size * short.CELL_SD_N * coloured(rng, (scans, cells), colour)
    speed_noise = size * short.SPEED_SD * rng.standard_normal((rows, drives))
    loop_noise = size * short.SPEED_SD * rng.standard_normal((scans * TICKS_PER_SCAN, drives))
    gust = lfilter([np.sqrt(1.0 - GUST_POLE**2)], [1.0, -GUST_POLE], rng.standard_normal(ticks))
    steps = size * np.array([short.CELL_LSB_N, short.SPEED_LSB])
    phi, vertices = np.zeros(n - 1), np.zeros((n - 1, 2), dtype=np.int64)
    _lay(m, angles, phi, vertices)
    begin = float(told.speed_m_s[0]), float(told.tension_N[0])
    state = start(m, angles, phi, vertices, *begin)
    out = np.empty((rows, cells + drives + n + 2))
    speed = np.append(told.speed_m_s, told.speed_m_s[-1])
    run(
        m,
        state,
        speed,
        told.tension_N,
        late,
        cell_noise,
        speed_noise,
        loop_noise,
        gust,
        steps,
        settling,
        out,
    )
    due = np.arange(rows) * short.SAMPLE_S
    stamp = due + late * TICK_S / STEPS_PER_TICK
    # a late scan logs the reference that is in force by then
    logged = replace(told, speed_m_s=np.interp(stamp, due, told.speed_m_s))
    angles_at = cells + drives
    return Columns(
        time_s=stamp,
        values=_channels(m, out, logged, exact=not noise),
        start_rad=out[0, angles_at : angles_at + n].copy(),
    )


def _lay(m: Machine, theta: Array, phi: Array, vertices: IntArray) -> None:
    """Find the span directions and touching points to begin with, looking everywhere."""
    b = m.bodies
    for k in range(theta.size - 1):
        apart = complex(b.x[k + 1] - b.x[k], b.y[k + 1] - b.y[k])
        reach = b.sense[k + 1] * m.radius[k + 1] - b.sense[k] * m.radius[k]
        phi[k] = np.angle(apart) - np.arcsin(reach / abs(apart))
        for side in (0, 1):
            if b.polygon[k + side] >= 0:
                vertices[k, side] = start_vertex(b, k + side, theta[k + side], phi[k], 0.0)


def _channels(m: Machine, out: Array, told: References, *, exact: bool) -> dict[str, Array]:
    cells, drives = m.cell_body.size, m.drive_body.size
    names = [b[0] for b in short.BODIES]
    driven = [names[k] for k in m.drive_body]
    found = {"line_speed_ref_m_s": told.speed_m_s, "tension_ref_N": told.tension_N}
    for at, channel in enumerate(short.CELLS):
        found[channel] = out[:, at]
    for channel, roller in short.SPEEDS.items():
        scale = short.BODIES[names.index(roller)][2] if channel.endswith("_m_s") else 1.0
        found[channel] = out[:, cells + driven.index(roller)] * scale
    for channel, roller in short.ANGLES.items():
        angle = out[:, cells + drives + names.index(roller)]
        found[channel] = _word(angle - angle[0], 0.0 if exact else short.ANGLE_LSB)
    radius = out[:, cells + drives + len(names)]
    found["unwind_radius_m"] = _word(radius, 0.0 if exact else short.RADIUS_LSB_M)
    return found


def _word(values: Array, step: float) -> Array:
    return values if step == 0.0 else step * np.floor(values / step + 0.5)


def write_record(columns: Columns, path: Path) -> None:
    """Write the CSV."""
    table = np.column_stack([columns.time_s, *columns.values.values()])
    header = ",".join(["time_s", *columns.values])
    np.savetxt(path, table, "%.9g", ",", header=header, comments="")


def write_line(declared: dict[str, Any], path: Path) -> None:
    """Write a declaration."""
    path.write_text(yaml.safe_dump(declared, sort_keys=False), encoding="utf-8")
