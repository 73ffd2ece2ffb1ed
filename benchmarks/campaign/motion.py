"""The machine in motion: velocity Verlet on angles, web kept as unstretched length per span.

Every span holds an unstretched length M. What passes the touching points changes it: dM = dS_in /
(1 + strain before) - dS_out / (1 + strain), with dS the arc or the edges that went by; strain is
L / M - 1. Drives run on their own tick, the PLC at scans that come late by a random part.
"""

from __future__ import annotations

import math

import numpy as np

from benchmarks.campaign.contact import Array, IntArray, span_between, turned
from benchmarks.campaign.jit import compiled
from benchmarks.campaign.state import Machine, State, resting_tensions

STEPS_PER_TICK = 2
TICKS_PER_SCAN = 10
TICK_S = 0.001
TRAVEL_BODY = 4  # the S-wrap


def start(
    m: Machine, theta: Array, phi: Array, vertices: IntArray, speed: float, tension: float
) -> State:
    """Return a state near the steady one at this speed (m/s) and tension (N)."""
    n, cells, drives = m.radius.size, m.cell_body.size, m.drive_body.size
    pull = resting_tensions(m, speed, tension)
    strain = pull / m.modulus + m.free
    cell = np.zeros((cells, 3))
    cell[:, :2] = tension
    s = State(
        theta=theta.copy(),
        omega=speed / m.radius,
        rate=np.zeros(n),
        turn=np.zeros(n),
        radius=m.radius.copy(),
        out_m=np.zeros(n),
        zero=theta.copy(),
        phi=phi,
        swing=np.zeros(n - 1),
        strain=strain,
        held=np.zeros(n - 1),
        pull=pull,
        vertices=vertices,
        geometry=np.zeros((n - 1, 5)),
        cell=cell,
        words=np.full(cells, tension),
        motor=np.zeros(drives),
        integral=np.zeros(drives),
        reference=np.full(drives, speed),
        past=np.zeros((drives, 512)),
        correction=np.zeros(m.loop_cell.size),
        error_N_s=np.zeros(m.loop_cell.size),
        passed=np.zeros(2),
    )
    loads = m.drag + m.viscous * s.omega - m.radius * np.diff(pull, prepend=0.0, append=0.0)
    for d, k in enumerate(m.drive_body):
        inertia = roll_inertia(m, int(k), m.radius[k], m.drive_inertia[d])
        gain = m.drive_gain[d]
        s.integral[d] = loads[k] / (inertia * gain**2 / (4.0 * m.drive_zeta[d] ** 2))
    lengths(m, s, 0.0)
    s.held[:] = s.geometry[:, 0] / (1.0 + strain)
    return s


@compiled
def roll_inertia(m: Machine, k: int, radius: float, fixed: float) -> float:
    """Return core, drive and wound web of a roll; ``fixed`` elsewhere."""
    if 0 < k < m.radius.size - 1:
        return fixed
    return float(fixed + 0.5 * math.pi * m.web[1] * m.web[3] * (radius**4 - m.web[5] ** 4))


@compiled
def lengths(m: Machine, s: State, time_s: float) -> None:
    """Write length, edges passed and lever arms of all spans to ``s.geometry``."""
    last = s.theta.size - 1
    per_turn = m.web[2] / (2.0 * math.pi)
    for k in (0, last):
        change = per_turn * (s.theta[k] - s.zero[k]) * (1.0 if k == last else -1.0)
        s.radius[k] = m.radius[k] + change
        s.out_m[k] = change
    for i in range(last):
        span_between(m.bodies, i, s.radius, s.out_m, s.theta, s.phi, s.vertices, s.geometry[i])
    for k in range(m.shake.shape[0]):
        at = time_s if m.shake[k, 1] == 0.0 else s.passed[0]
        turn = 2.0 * math.pi * m.shake[k, 2] * at + m.shake[k, 4]
        s.geometry[int(m.shake[k, 0]), 0] += m.shake[k, 3] * math.cos(turn)


@compiled
def share_of(m: Machine, k: int, speed: float) -> float:
    """Return how much of its surface speed body ``k`` gives to the web."""
    beyond = speed - m.slip_speed[k]
    if m.slip[k] == 0.0 or beyond <= 0.0:
        return 1.0
    return float(1.0 - m.slip[k] * beyond)


@compiled
def fed_by(m: Machine, s: State, k: int, i: int, edges_m: float, step_s: float) -> float:
    """Return the length of web that body ``k`` passes at span ``i`` in this step."""
    length = edges_m
    if m.bodies.polygon[k] < 0:
        length = s.radius[k] * (s.turn[k] - m.bodies.sense[k] * s.swing[i])
    if m.slip[k] == 0.0:
        return length
    return length * share_of(m, k, s.radius[k] * s.turn[k] / step_s)


@compiled
def stretch(m: Machine, s: State, step_s: float) -> None:
    """Move web through all spans and write strains and tensions."""
    before = m.web[4]
    inside = 0.0
    for i in range(s.held.size):
        fed = fed_by(m, s, i, i, s.geometry[i, 1], step_s) / (1.0 + before)
        taken = fed_by(m, s, i + 1, i, s.geometry[i, 2], step_s) / (1.0 + s.strain[i])
        if i == 0:
            s.passed[1] += fed
        s.held[i] += fed - taken
        inside += s.held[i]
        fresh = s.geometry[i, 0] / s.held[i] - 1.0
        rate = (fresh - s.strain[i]) / step_s
        stiff = m.modulus[i]
        if m.web[6] != 0.0:  # compliance wave of the web, averaged over the span
            half = math.pi * s.held[i] / m.web[7]
            middle = 2.0 * math.pi * (s.passed[1] - inside + 0.5 * s.held[i]) / m.web[7]
            stiff /= 1.0 + m.web[6] * math.sin(half) / half * math.cos(middle)
        tension = stiff * (fresh - m.free[i])
        if m.web[8] != 0.0:
            tension *= 1.0 + m.web[8] * (tension / 90.0 - 1.0)
        s.pull[i] = max(0.0, tension + m.modulus[i] * m.web[0] * rate)
        before = s.strain[i]
        s.strain[i] = fresh


@compiled
def accelerate(m: Machine, s: State) -> None:
    """Write the angular acceleration of every body."""
    last = s.theta.size - 1
    out = s.rate
    for k in range(last + 1):
        ratio = s.omega[k] / 0.3
        level = math.tanh(ratio) if abs(ratio) < 20.0 else math.copysign(1.0, ratio)
        torque = -m.drag[k] * level - m.viscous[k] * s.omega[k]
        if m.gravity_moment[k] != 0.0:
            torque -= (
                m.bodies.sense[k]
                * m.gravity_moment[k]
                * math.cos(s.theta[k] + m.gravity_moment_angle[k])
            )
        if k > 0:
            torque -= s.geometry[k - 1, 4] * s.pull[k - 1]
        if k < last:
            torque += s.geometry[k, 3] * s.pull[k]
        out[k] = torque
    for d in range(m.drive_body.size):
        out[m.drive_body[d]] += s.motor[d]
    for r in range(m.ripple.shape[0]):
        k = m.drive_body[int(m.ripple[r, 0])]
        turn = m.ripple[r, 1] * s.theta[k]
        out[k] += m.ripple[r, 2] * math.cos(turn) + m.ripple[r, 3] * math.sin(turn)
    for k in range(last + 1):
        out[k] /= roll_inertia(m, k, s.radius[k], m.inertia[k])


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
def encoder_word(m: Machine, d: int, theta: Array, omega: Array, share: float) -> float:
    """Return the speed that an encoder gives, without noise."""
    k = m.drive_body[d]
    wobble = share * m.encoder[d] * math.cos(theta[k] - m.encoder_angle[d])
    return float(omega[k] * (1.0 + wobble))


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
        row[cells + d] = rounded(encoder_word(m, d, s.theta, s.omega, 1.0) + noise[d], step)
        row[angles + k] += m.encoder[d] * math.sin(s.theta[k] - m.encoder_angle[d])
    row[angles + n] = s.radius[0]
    row[angles + n + 1] = s.radius[n - 1]


@compiled
def tick_drives(
    m: Machine, s: State, tick: int, line_m_s: float, noise: Array, step: float, gust: float
) -> None:
    """Run every drive's speed PI once; torques hold until the next tick."""
    for d in range(m.drive_body.size):
        k = m.drive_body[d]
        wanted = s.correction[m.drive_loop[d]] if m.drive_loop[d] >= 0 else 0.0
        s.past[d, tick % s.past.shape[1]] = wanted
        wanted = s.past[d, (tick - m.drive_delay[d]) % s.past.shape[1]]
        wanted += line_m_s * (1.0 + m.drive_draw[d])
        if m.drive_slew[d] > 0.0:
            most = m.drive_slew[d] * TICK_S
            wanted = min(max(wanted, s.reference[d] - most), s.reference[d] + most)
        s.reference[d] = wanted
        believed = s.radius[k] * m.drive_ratio[d]
        seen = encoder_word(m, d, s.theta, s.omega, m.encoder_share[d]) + noise[d]
        error = wanted / believed - rounded(seen, step)
        s.integral[d] += error * TICK_S
        inertia = roll_inertia(m, k, believed, m.drive_inertia[d])
        gain = m.drive_gain[d]
        lead = gain / (4.0 * m.drive_zeta[d] ** 2)
        s.motor[d] = inertia * gain * (error + lead * s.integral[d])
        if m.gust[0] == d:
            s.motor[d] += m.gust[1] * gust


@compiled
def step_machine(m: Machine, s: State, time_s: float, step_s: float) -> None:
    """Advance angles, web, tensions, speeds and load cells by one step."""
    n = s.theta.size
    for k in range(n):
        s.omega[k] += 0.5 * step_s * s.rate[k]
        s.turn[k] = step_s * s.omega[k]
        s.theta[k] += s.turn[k]
    if time_s <= 0.0:  # settling: the rolls keep their size
        s.zero[0] += s.turn[0]
        s.zero[n - 1] += s.turn[n - 1]
    for i in range(n - 1):
        s.swing[i] = s.phi[i]
    s.passed[0] += s.radius[TRAVEL_BODY] * s.turn[TRAVEL_BODY]
    lengths(m, s, time_s)
    for i in range(n - 1):
        s.swing[i] = turned(s.phi[i], s.swing[i])
    stretch(m, s, step_s)
    accelerate(m, s)
    for k in range(n):
        s.omega[k] += 0.5 * step_s * s.rate[k]
    move_cells(m, s, step_s)


@compiled
def run(
    m: Machine,
    s: State,
    speed: Array,
    tension: Array,
    late: IntArray,
    cell_noise: Array,
    speed_noise: Array,
    loop_noise: Array,
    gust: Array,
    steps: Array,
    settle_scans: int,
    out: Array,
) -> None:
    """Run ``settle_scans`` at the first references, then the record.

    Inputs: speed (rows + 1,), tension (rows,), late (rows,) steps after the scan is due,
    speed_noise (rows, d), gust (rows * ticks,), steps (2,) resolution of cells and speeds; of
    settling and record together, cell_noise (scans, c), loop_noise (scans * ticks, d): a line
    that runs has its noise before a record begins. ``out`` (rows, c + d + n + 2): words of cells
    and speeds, angles as encoders tell them, radii of both rolls.
    """
    step_s = TICK_S / STEPS_PER_TICK
    tick = 0
    for scan in range(-settle_scans, tension.size):
        row = max(scan, 0)
        due = late[row] if scan >= 0 else 0
        if scan == 0:
            s.passed[:] = 0.0
        for part in range(TICKS_PER_SCAN):
            for sub in range(STEPS_PER_TICK):
                done = part * STEPS_PER_TICK + sub
                time_s = scan * TICKS_PER_SCAN * TICK_S + done * step_s
                if done == due:
                    scan_plc(m, s, tension[row], time_s, cell_noise[scan + settle_scans], steps[0])
                    if scan >= 0:
                        log_row(m, s, speed_noise[row], steps[1], out[scan])
                if sub == 0:
                    share = part / TICKS_PER_SCAN if scan >= 0 else 0.0
                    line = speed[row] + share * (speed[row + 1] - speed[row])
                    push = gust[row * TICKS_PER_SCAN + part]
                    tick_drives(m, s, tick, line, loop_noise[tick], steps[1], push)
                    tick += 1
                step_machine(m, s, time_s + step_s, step_s)
