"""What cells and encoders give, and the PLC's scan of them."""

from __future__ import annotations

import math

from benchmarks.campaign.contact import Array
from benchmarks.campaign.jit import compiled
from benchmarks.campaign.state import Machine, State

TICKS_PER_SCAN = 10
TICK_S = 0.001


@compiled
def rounded(value: float, step: float) -> float:
    """Return ``value`` as a word with this resolution; 0 is exact."""
    return value if step == 0.0 else step * math.floor(value / step + 0.5)


@compiled
def read_cells(
    m: Machine, cell: Array, time_s: float, noise: Array, step_N: float, words: Array
) -> None:
    """Write the load-cell words."""
    for c in range(m.cell_body.size):
        value = m.cell_gain[c] * cell[c, 0] + m.cell_offset[c] + noise[c]
        if m.cell_hum[c] != 0.0:
            turn = 2.0 * math.pi * m.cell_hum_Hz[c] * time_s - m.cell_hum_phase[c]
            value += m.cell_hum[c] * math.cos(turn)
        value += m.cell_drift[c] * max(0.0, time_s)
        words[c] = rounded(value, step_N)


@compiled
def move_cells(m: Machine, s: State, step_s: float) -> None:
    """Advance the load-cell mounts and amplifiers by one step (exact for a held input)."""
    for c in range(m.cell_body.size):
        k = m.cell_body[c]
        force = 0.5 * (s.pull[k - 1] + s.pull[k])
        if m.cell_unbalance[c] != 0.0:
            turn = s.theta[k] - m.cell_unbalance_angle[c]
            force += m.cell_unbalance[c] * s.omega[k] ** 2 * math.cos(turn)
        if m.cell_ring_Hz[c] > 0.0:
            w = 2.0 * math.pi * m.cell_ring_Hz[c]
            back = w * w * (force - s.cell[c, 1]) - 2.0 * m.cell_ring_damping[c] * w * s.cell[c, 2]
            s.cell[c, 2] += step_s * back
            s.cell[c, 1] += step_s * s.cell[c, 2]
            force = s.cell[c, 1]
        share = 1.0 - math.exp(-2.0 * math.pi * m.cell_Hz[c] * step_s)
        s.cell[c, 0] += share * (force - s.cell[c, 0])


@compiled
def encoder_word(m: Machine, s: State, d: int, share: float) -> float:
    """Return the speed that an encoder, on the motor, gives without noise."""
    k = m.drive_body[d]
    omega, turn = s.omega[k], s.theta[k]
    if m.shaft[d, 1] != 0.0:
        omega, turn = s.twist[d, 1], turn + s.twist[d, 0]
    wobble = share * m.encoder[d] * math.cos(turn - m.encoder_angle[d])
    return float(omega * (1.0 + wobble))


@compiled
def scan_plc(
    m: Machine, s: State, tension_N: float, time_s: float, noise: Array, step_N: float
) -> None:
    """Read the cells and run the tension loops."""
    read_cells(m, s.cell, time_s, noise, step_N, s.words)
    period_s = TICKS_PER_SCAN * TICK_S
    for loop in range(m.loop_cell.size):
        error = tension_N - s.words[m.loop_cell[loop]]
        s.error_N_s[loop] += error * period_s
        lead = error + m.loop_corner[loop] * s.error_N_s[loop]
        s.correction[loop] = m.loop_sign[loop] * m.loop_gain[loop] * lead


@compiled
def log_row(m: Machine, s: State, noise: Array, step: float, row: Array) -> None:
    """Write one row of the record, see ``run``."""
    cells, drives, n = m.cell_body.size, m.drive_body.size, s.theta.size
    angles = cells + drives
    for c in range(cells):
        row[c] = s.words[c]
    for k in range(n):
        row[angles + k] = s.theta[k]
    for d in range(drives):
        k = m.drive_body[d]
        row[cells + d] = rounded(encoder_word(m, s, d, 1.0) + noise[d], step)
        turn = s.theta[k] + s.twist[d, 0]
        row[angles + k] = turn + m.encoder[d] * math.sin(turn - m.encoder_angle[d])
        if k == 0:  # what the drive believes is told
            row[angles + n] = s.radius[0] * m.drive_ratio[d]
        if k == n - 1:
            row[angles + n + 1] = s.radius[k] * m.drive_ratio[d]
