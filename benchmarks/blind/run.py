"""The line under its references: drives, tension loops, words, and the steps between them."""

from __future__ import annotations

import math
from typing import NamedTuple

from benchmarks.blind.jit import compiled
from benchmarks.blind.plant import (
    DRAG,
    DRAW,
    DRIVE,
    GAIN,
    LOOP,
    MODULUS,
    WARM,
    ZERO,
    Array,
    Now,
    Places,
    Plant,
    places,
    slopes,
    turning,
)

ROW_S, TICK_S = 0.01, 0.001
TICKS = 10
STEPS = 1
"""Of a drive's tick."""
TORQUE_N_M = 120.0


class Memory(NamedTuple):
    """What drives, loops and cells remember.

    Attributes
    ----------
    integral, reference, ramped : (d,). past : (d, ticks) corrections.
    error, correction : (l,). words, stuck : (c,) readings, and forces that a mount with play has.
    """

    integral: Array
    reference: Array
    ramped: Array
    past: Array
    error: Array
    correction: Array
    words: Array
    stuck: Array


@compiled
def word(value: float, step: float) -> float:
    """Return ``value`` as a word of this resolution; 0 is exact."""
    return float(value) if step == 0.0 else step * math.floor(value / step + 0.5)


@compiled
def advance(p: Plant, now: Now, y: Array, w: Places, time_s: float, step_s: float) -> None:
    """Take one step of the classical Runge-Kutta rule."""
    k, trial = now.slopes, now.trial
    slopes(p, now, y, w, time_s, k[0])
    for stage in range(1, 4):
        ahead = step_s if stage == 3 else 0.5 * step_s
        for j in range(y.size):
            trial[j] = y[j] + ahead * k[stage - 1, j]
        slopes(p, now, trial, w, time_s + ahead, k[stage])
    for j in range(y.size):
        y[j] += step_s / 6.0 * (k[0, j] + 2.0 * k[1, j] + 2.0 * k[2, j] + k[3, j])


@compiled
def there(time_s: float, from_s: float, rise_s: float, until_s: float) -> float:
    """Return how much of a change is there, 0..1."""
    rise = max(rise_s, 1e-6)
    up = min(max((time_s - from_s) / rise, 0.0), 1.0)
    return up - min(max((time_s - until_s) / rise, 0.0), 1.0)


@compiled
def become(p: Plant, what: float, at: int, amount: float) -> None:
    """Make a number another one for the rest of the run; web was wound at a tension."""
    if what == MODULUS:
        p.web[0] *= 1.0 + amount
        p.web[2] /= 1.0 + amount
    elif what == DRAW:
        p.drive_draw[at] += amount
    elif what == GAIN:
        p.cell_gain[at] *= 1.0 + amount
    elif what == ZERO:
        p.cell_zero[at] += amount
    elif what == DRIVE:
        p.drive_gain[at] *= 1.0 + amount
    elif what == LOOP:
        p.loop_gain[at] *= 1.0 + amount


@compiled
def change_with_time(p: Plant, now: Now, time_s: float) -> None:
    """Bring drag, warmth and numbers to what they are at a time of the record."""
    now.drag[:] = 0.0
    now.warm[:] = 0.0
    for e in range(p.change.shape[0]):
        row = p.change[e]
        amount = row[2] * there(time_s, row[3], row[4], row[5])
        if row[0] == DRAG:
            now.drag[int(row[1])] += amount
        elif row[0] == WARM:
            now.warm[int(row[1])] += amount
        elif time_s - TICK_S < row[3] - 1e-9 <= time_s:
            become(p, row[0], int(row[1]), row[2])


@compiled
def read_cells(
    p: Plant, y: Array, w: Places, m: Memory, time_s: float, noise: Array, step_N: float
) -> None:
    """Write the words of the load cells."""
    for c in range(p.cell_body.size):
        force = y[w.cell + c]
        if p.play_N[0] != 0.0:
            half = 0.5 * p.play_N[0]
            m.stuck[c] = min(max(m.stuck[c], force - half), force + half)
            force = m.stuck[c]
        value = p.cell_gain[c] * force + p.cell_zero[c] + noise[c]
        value += p.hum[c, 0] * math.cos(2.0 * math.pi * p.hum[c, 1] * time_s - p.hum[c, 2])
        m.words[c] = word(value, step_N)


@compiled
def run_loops(p: Plant, m: Memory, tension_N: float, time_s: float) -> None:
    """Run the tension loops on the latest words; held corrections stand still."""
    held = p.freeze[1] > 0.0 and time_s >= 0.0 and time_s % p.freeze[0] < p.freeze[1]
    for loop in range(p.loop_cell.size):
        error = tension_N - m.words[p.loop_cell[loop]]
        m.error[loop] += ROW_S * error
        if not (held and loop == 0):
            lead = error + p.loop_corner[loop] * m.error[loop]
            m.correction[loop] = p.loop_sign[loop] * p.loop_gain[loop] * lead


@compiled
def towards(wanted: float, last: float, rate: float) -> float:
    """Return ``wanted``, as far as a ramp gets in a tick; a rate of 0 is none."""
    most = rate * TICK_S
    return min(max(wanted, last - most), last + most) if rate > 0.0 else wanted


@compiled
def speed_of(p: Plant, y: Array, w: Places, d: int) -> float:
    """Return the speed at an encoder: it sits on the motor."""
    return float(y[w.omega + p.drive_body[d]] if p.shaft[d, 1] == 0.0 else y[w.motor + d])


@compiled
def run_drives(
    p: Plant,
    now: Now,
    y: Array,
    w: Places,
    m: Memory,
    tick: int,
    line_m_s: float,
    noise: Array,
    step: float,
) -> None:
    """Run every speed loop once; torques hold for a tick."""
    ring = m.past.shape[1]
    for d in range(p.drive_body.size):
        k = p.drive_body[d]
        loop = p.drive_loop[d]
        m.past[d, tick % ring] = m.correction[loop] if loop >= 0 else 0.0
        late = m.past[d, (tick - p.drive_delay[d]) % ring]
        m.ramped[d] = towards(late, m.ramped[d], p.drive_ramp[d])
        wanted = line_m_s * (1.0 + p.drive_draw[d]) + m.ramped[d]
        m.reference[d] = towards(wanted, m.reference[d], p.drive_slew[d])
        believed = p.radius[k] * p.drive_ratio[d]
        if p.growth[k] != 0.0:
            believed += p.growth[k] * (y[k] - now.zero[0 if k == 0 else 1]) * p.drive_ratio[d]
        error = m.reference[d] / believed - word(speed_of(p, y, w, d) + noise[d], step)
        stiff = turning(p, k, believed, p.drive_inertia[d]) * p.drive_gain[d]
        lead = p.drive_gain[d] / (4.0 * p.drive_zeta[d] ** 2)
        summed = m.integral[d] + TICK_S * error
        torque = stiff * (error + lead * summed)
        if abs(torque) <= TORQUE_N_M:
            m.integral[d] = summed
        now.torque[d] = min(max(torque, -TORQUE_N_M), TORQUE_N_M)


@compiled
def log(
    p: Plant, now: Now, y: Array, w: Places, m: Memory, noise: Array, step: float, row: Array
) -> None:
    """Write words of cells and speeds, angles of all bodies, and the unwind's radius."""
    cells, drives, n = p.cell_body.size, p.drive_body.size, p.x.size
    for c in range(cells):
        row[c] = m.words[c]
    for d in range(drives):
        row[cells + d] = word(speed_of(p, y, w, d) + noise[d], step)
    for k in range(n):
        row[cells + drives + k] = y[k]
    for d in range(drives):
        row[cells + drives + p.drive_body[d]] += y[w.twist + d]
    told = p.radius[0] + p.growth[0] * (y[0] - now.zero[0])
    row[cells + drives + n] = told * p.drive_ratio[0]


@compiled
def run(
    p: Plant,
    now: Now,
    y: Array,
    m: Memory,
    speed: Array,
    tension: Array,
    settle: int,
    cell_noise: Array,
    speed_noise: Array,
    loop_noise: Array,
    steps: Array,
    out: Array,
) -> None:
    """Settle for so many rows at the first references, then run the record.

    ``speed`` (rows + 1,) and linear between rows, ``tension`` (rows,), noise of settling and
    record together: (all, c), (rows, d), (all * ticks, d). While it settles rolls keep their size.
    """
    w = places(p.x.size, p.cell_body.size, p.drive_body.size)
    last = p.x.size - 1
    step_s = TICK_S / STEPS
    left = False
    for at in range(settle + tension.size):
        row = max(at - settle, 0)
        begun = (at - settle) * ROW_S
        read_cells(p, y, w, m, begun, cell_noise[at], steps[0])
        if at >= settle:
            log(p, now, y, w, m, speed_noise[row], steps[1], out[row])
        run_loops(p, m, tension[row], begun)
        for part in range(TICKS):
            tick = at * TICKS + part
            time_s = begun + part * TICK_S
            share = part / TICKS if at >= settle else 0.0
            line = speed[row] + share * (speed[row + 1] - speed[row])
            if not left and 0.0 <= p.seam[0] <= time_s:
                y[w.passed], left = 0.0, True
            change_with_time(p, now, time_s)
            run_drives(p, now, y, w, m, tick, line, loop_noise[tick], steps[1])
            for sub in range(STEPS):
                if at < settle:
                    now.zero[0], now.zero[1] = y[0], y[last]
                advance(p, now, y, w, time_s + sub * step_s, step_s)
