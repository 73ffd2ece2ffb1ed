"""The machine in motion: velocity Verlet on angles; the web is in ``web``, sensors in ``sensing``.

Drives run on their own tick, the PLC at scans that come late by a random part.
"""

from __future__ import annotations

import math

import numpy as np

from benchmarks.campaign.contact import Array, IntArray, turned
from benchmarks.campaign.jit import compiled
from benchmarks.campaign.sensing import (
    TICK_S,
    TICKS_PER_SCAN,
    encoder_word,
    log_row,
    move_cells,
    rounded,
    scan_plc,
)
from benchmarks.campaign.state import NOT_YET, Machine, State, resting_tensions
from benchmarks.campaign.web import follow_changes, grow_rolls, lengths, stretch

STEPS_PER_TICK = 2
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
        heavy=np.zeros(n),
        turn=np.zeros(n),
        radius=m.radius.copy(),
        out_m=np.zeros(n),
        zero=theta.copy(),
        lift=np.zeros(n),
        reach=m.radius.copy(),
        behind=np.full(n, NOT_YET),
        phi=phi,
        swing=np.zeros(n - 1),
        strain=strain,
        held=np.zeros(n - 1),
        pull=pull,
        leaves=strain.copy(),
        old=strain.copy(),
        crept=np.zeros(n - 1),
        more_drag=np.zeros(n),
        more_slip=np.zeros(n),
        more_free=np.zeros(n - 1),
        vertices=vertices,
        geometry=np.zeros((n - 1, 5)),
        cell=cell,
        words=np.full(cells, tension),
        motor=np.zeros(drives),
        integral=np.zeros(drives),
        reference=np.full(drives, speed),
        past=np.zeros((drives, 512)),
        ramped=np.zeros(drives),
        twist=np.zeros((drives, 3)),
        axle=np.zeros(3),
        thicker=np.zeros(2),
        correction=np.zeros(m.loop_cell.size),
        error_N_s=np.zeros(m.loop_cell.size),
        passed=np.zeros(2),
    )
    loads = m.drag + m.viscous * s.omega - m.radius * np.diff(pull, prepend=0.0, append=0.0)
    for d, k in enumerate(m.drive_body):
        inertia = roll_inertia(m, int(k), m.radius[k], m.drive_inertia[d])
        gain = m.drive_gain[d]
        s.integral[d] = loads[k] / (inertia * gain**2 / (4.0 * m.drive_zeta[d] ** 2))
        s.twist[d, 1] = s.omega[k]
        if m.shaft[d, 1] != 0.0:
            s.twist[d, 0] = loads[k] / m.shaft[d, 1] + math.copysign(0.5 * m.shaft[d, 3], loads[k])
    if m.axle[0] != 0.0:
        s.axle[0] = pull[0] / (m.axle[0] * (2.0 * math.pi * m.axle[1]) ** 2)
    lengths(m, s, 0.0)
    s.held[:] = s.geometry[:, 0] / (1.0 + strain)
    s.crept[:] = s.held * strain
    return s


@compiled
def roll_inertia(m: Machine, k: int, radius: float, fixed: float) -> float:
    """Return core, drive and wound web of a roll; ``fixed`` elsewhere."""
    if 0 < k < m.radius.size - 1:
        return fixed
    return float(fixed + 0.5 * math.pi * m.web[1] * m.web[3] * (radius**4 - m.web[5] ** 4))


@compiled
def accelerate(m: Machine, s: State) -> None:
    """Write the angular acceleration of every body."""
    last = s.theta.size - 1
    out = s.rate
    for k in range(last + 1):
        ratio = s.omega[k] / 0.3
        level = math.tanh(ratio) if abs(ratio) < 20.0 else math.copysign(1.0, ratio)
        torque = -(m.drag[k] + s.more_drag[k]) * level - m.viscous[k] * s.omega[k]
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
    for k in range(last + 1):
        s.heavy[k] = roll_inertia(m, k, s.radius[k], m.inertia[k])
    for d in range(m.drive_body.size):
        push = s.motor[d]
        k = m.drive_body[d]
        for r in range(m.ripple.shape[0]):
            if m.ripple[r, 0] == d:
                turn = m.ripple[r, 1] * s.theta[k]
                push += m.ripple[r, 2] * math.cos(turn) + m.ripple[r, 3] * math.sin(turn)
        out[k] += push if m.shaft[d, 1] == 0.0 else through_shaft(m, s, d, push)
    for k in range(last + 1):
        out[k] /= s.heavy[k]
    if m.axle[0] != 0.0:
        swing_axle(m, s)


@compiled
def through_shaft(m: Machine, s: State, d: int, push_N_m: float) -> float:
    """Return the torque that a shaft gives to its body; its motor has the rest."""
    k = m.drive_body[d]
    angle, half = s.twist[d, 0], 0.5 * m.shaft[d, 3]
    torque = 0.0
    if abs(angle) > half:
        torque = m.shaft[d, 1] * (angle - math.copysign(half, angle))
        torque += m.shaft[d, 2] * (s.twist[d, 1] - s.omega[k])
    s.twist[d, 2] = (push_N_m - torque) / m.shaft[d, 0]
    s.heavy[k] -= m.shaft[d, 0]
    return torque


@compiled
def swing_axle(m: Machine, s: State) -> None:
    """Write the acceleration of the unwind's axle on its mandrel, along the first span.

    Equation: m x'' = T + u(theta) omega^2 - m w^2 x - 2 zeta m w x'.
    """
    w = 2.0 * math.pi * m.axle[1]
    one, more = s.theta[0], m.axle[3] * s.theta[0]
    u = m.axle[4] * math.cos(more) + m.axle[5] * math.sin(more)
    u += m.axle[6] * math.cos(one) + m.axle[7] * math.sin(one)
    force = s.pull[0] + u * s.omega[0] ** 2
    s.axle[2] = force / m.axle[0] - w * (w * s.axle[0] + 2.0 * m.axle[2] * s.axle[1])


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
        if m.drive_ramp[d] > 0.0:
            most = m.drive_ramp[d] * TICK_S
            wanted = min(max(wanted, s.ramped[d] - most), s.ramped[d] + most)
        s.ramped[d] = wanted
        wanted += line_m_s * (1.0 + m.drive_draw[d])
        if m.drive_slew[d] > 0.0:
            most = m.drive_slew[d] * TICK_S
            wanted = min(max(wanted, s.reference[d] - most), s.reference[d] + most)
        s.reference[d] = wanted
        believed = s.radius[k] * m.drive_ratio[d]
        seen = encoder_word(m, s, d, m.encoder_share[d]) + noise[d]
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
    for d in range(m.drive_body.size):
        if m.shaft[d, 1] != 0.0:
            s.twist[d, 1] += 0.5 * step_s * s.twist[d, 2]
            s.twist[d, 0] += step_s * (s.twist[d, 1] - s.omega[m.drive_body[d]])
    s.axle[1] += 0.5 * step_s * s.axle[2]
    s.axle[0] += step_s * s.axle[1]
    if s.behind[0] >= 0.0:
        grow_rolls(m, s)
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
    for d in range(m.drive_body.size):
        if m.shaft[d, 1] != 0.0:
            s.twist[d, 1] += 0.5 * step_s * s.twist[d, 2]
    s.axle[1] += 0.5 * step_s * s.axle[2]
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
                    if scan >= 0:
                        follow_changes(m, s, time_s)
                    if scan >= 0 and 0.0 <= m.seam[0] <= time_s and s.behind[0] < 0.0:
                        s.behind[0] = 0.0
                    tick_drives(m, s, tick, line, loop_noise[tick], steps[1], push)
                    tick += 1
                step_machine(m, s, time_s + step_s, step_s)
