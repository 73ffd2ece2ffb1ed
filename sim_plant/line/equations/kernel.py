"""The compiled step: one control frame at a time, for hardware in the loop and for whole runs."""

from __future__ import annotations

import math
from typing import NamedTuple

from sim_plant.base.arrays import UNWIND, Array, LineArrays, LineState
from sim_plant.base.jit import compiled, compiled_apart, compiled_inside
from sim_plant.elements.drive import speed_pi
from sim_plant.elements.load_cell import expected_quantise, quantise
from sim_plant.elements.tension_loop import tension_pi
from sim_plant.line.equations.changing_numbers import keep_changes
from sim_plant.line.equations.derivative import derivative
from sim_plant.line.equations.layout import Layout
from sim_plant.line.equations.log_layout import log_layout
from sim_plant.line.equations.moved_bodies import drive_carriages
from sim_plant.line.equations.rolls import mean_radius, roll_inertia

CONTACT_COLUMNS = 8


class Work(NamedTuple):
    """Scratch memory of the kernel; never carries information between frames."""

    moving: Array  # (m,) 1 where the span's tangent moves
    contacts: Array  # (m, 8) L, p_A, p_B, ldot_A, phidot, lift of the body after, levers
    tensions: Array  # (m,)
    rates: Array  # (4, size) Runge-Kutta slopes
    trial: Array  # (size,)


@compiled_inside
def rk4(p: LineArrays, lay: Layout, s: LineState, w: Work, dt_s: float) -> None:
    """Advance the continuous state by ``dt_s`` with the classical fourth-order rule."""
    y, trial, half = s.y, w.trial, 0.5 * dt_s
    k1, k2, k3, k4 = w.rates[0], w.rates[1], w.rates[2], w.rates[3]
    slope(p, lay, s, w, y, k1)
    turn_spans(s, w, half)
    for j in range(y.size):
        trial[j] = y[j] + half * k1[j]
    slope(p, lay, s, w, trial, k2)
    for j in range(y.size):
        trial[j] = y[j] + half * k2[j]
    slope(p, lay, s, w, trial, k3)
    turn_spans(s, w, half)
    for j in range(y.size):
        trial[j] = y[j] + dt_s * k3[j]
    slope(p, lay, s, w, trial, k4)
    sixth = dt_s / 6.0
    for j in range(y.size):
        y[j] += sixth * (k1[j] + 2.0 * (k2[j] + k3[j]) + k4[j])


@compiled_inside
def turn_spans(s: LineState, w: Work, ahead_s: float) -> None:
    """Move the directions of spans to where their rates lead in ``ahead_s``.

    The next slope starts from there: what is left for Newton's step is of second order in time.
    """
    for i in range(w.moving.size):
        if w.moving[i] != 0.0:
            s.phi_rad[i] += ahead_s * w.contacts[i, 4]


@compiled_inside
def slope(p: LineArrays, lay: Layout, s: LineState, w: Work, y: Array, dy: Array) -> None:
    """Write dy/dt at the trial state ``y``; in a plain line by code of its own."""
    if p.carriages.size > 0 or p.heats.size > 0:
        slope_with_more(p, lay, s, w, y, dy)
    else:
        derivative(p, lay, s, y, w.moving, w.contacts, w.tensions, dy, False)


@compiled_apart
def slope_with_more(
    p: LineArrays, lay: Layout, s: LineState, w: Work, y: Array, dy: Array
) -> None:
    """Write dy/dt of a line with carriages or warm spans."""
    derivative(p, lay, s, y, w.moving, w.contacts, w.tensions, dy, True)


@compiled_inside
def run_loops(
    p: LineArrays, lay: Layout, s: LineState, tension_ref_N: Array, period_s: float
) -> None:
    """Run every loop: of tension on the latest load-cell words, of travel on where it is.

    A limit of its output holds from sample to sample; its integral does not know of it.
    """
    for loop in range(p.loops.size):
        law = p.loops[loop]
        if law.carriage >= 0:
            error = law.reference_m - s.y[lay.carriage + 2 * law.carriage]
        else:
            error = tension_ref_N[loop] - s.measured_N[law.cell]
        correction, integral = tension_pi(
            law.gain_m_s_N, law.corner_rad_s, law.sign, error, s.loop_integral[loop], period_s
        )
        last = s.loop_correction_m_s[loop]
        s.loop_correction_m_s[loop] = ramped(correction, last, law.slew_m_s2 * period_s)
        s.loop_integral[loop] = integral


@compiled_inside
def drive_reference(
    p: LineArrays, s: LineState, d: int, line_speed_m_s: float, aff_m_s: float
) -> float:
    """Return the velocity reference of drive ``d`` for this tick, m/s: delay, limits, sum."""
    drive = p.drives[d]
    correction = aff_m_s
    if drive.loop >= 0:
        correction += s.loop_correction_m_s[drive.loop]
    ring = s.delay_m_s.shape[1]
    at = s.counters[1]
    s.delay_m_s[d, at] = correction
    past = at - drive.delay_ticks
    delayed = s.delay_m_s[d, past if past >= 0 else past + ring]
    tick_s = p.timing[0].drive_tick_s
    reached = ramped(delayed, s.correction_m_s[d], drive.correction_slew_m_s2 * tick_s)
    s.correction_m_s[d] = reached
    wanted = line_speed_m_s * (1.0 + drive.draw) + reached
    s.reference_m_s[d] = ramped(wanted, s.reference_m_s[d], drive.slew_m_s2 * tick_s)
    return float(s.reference_m_s[d])


@compiled
def ramped(wanted: float, last: float, step: float) -> float:
    """Return ``wanted``, no further than ``step`` from ``last``; 0 is no limit."""
    return min(max(wanted, last - step), last + step) if step > 0.0 else wanted


@compiled_inside
def encoder_speed(p: LineArrays, lay: Layout, s: LineState, d: int, share: float) -> float:
    """Return the speed at the encoder of drive ``d``, rad/s: w (1 + share e cos(theta + a)).

    The encoder sits on the motor. An eccentric one reads the angle theta + e sin(theta + a).
    """
    drive = p.drives[d]
    k = drive.body
    stiff = drive.shaft_stiffness_N_m == 0.0
    omega = s.y[lay.omega + k] if stiff else s.y[lay.motor + d]
    eccentricity = share * drive.encoder_offset_ratio
    if eccentricity != 0.0:
        turn = s.y[lay.theta + k] + s.y[lay.twist + d] + drive.encoder_angle_rad
        omega *= 1.0 + eccentricity * math.cos(turn)
    return float(omega)


@compiled_inside
def drive_speed(p: LineArrays, lay: Layout, s: LineState, d: int, noise: float) -> float:
    """Return the speed that the loop of drive ``d`` reads, rad/s."""
    drive = p.drives[d]
    omega = encoder_speed(p, lay, s, d, drive.encoder_loop_share)
    if p.timing[0].noisy == 0:
        return expected_quantise(omega, drive.lsb_rad_s, drive.noise_rad_s)
    return quantise(omega + drive.noise_rad_s * noise, drive.lsb_rad_s)


@compiled_inside
def run_drives(
    p: LineArrays, lay: Layout, s: LineState, line_speed_m_s: float, aff_m_s: Array, noise: Array
) -> None:
    """Run every drive's speed PI once and hold its torque; ``noise`` is (d,) standard normal.

    ``aff_m_s`` has d corrections of the velocity references; d torques, N m, may follow, which
    are added behind the speed loop, within the drive's limit.
    """
    torques = aff_m_s.size > p.drives.size
    tick_s = p.timing[0].drive_tick_s
    for d in range(p.drives.size):
        drive = p.drives[d]
        body = p.bodies[drive.body]
        reference = drive_reference(p, s, d, line_speed_m_s, aff_m_s[d])
        radius = mean_radius(lay, s.y, body.kind, body.radius_m) * drive.radius_ratio
        inertia = body.inertia_kg_m2
        if body.kind >= UNWIND:
            inertia = roll_inertia(p, inertia, radius)
        error = reference / radius - drive_speed(p, lay, s, d, noise[d])
        torque, integral = speed_pi(
            inertia,
            drive.gain_rad_s,
            drive.damping,
            error,
            s.drive_integral[d],
            tick_s,
            drive.limit_N_m,
        )
        if torques:
            torque += aff_m_s[p.drives.size + d]
            torque = min(max(torque, -drive.limit_N_m), drive.limit_N_m)
        s.torque_N_m[d] = torque
        s.drive_integral[d] = integral
    s.counters[1] = (s.counters[1] + 1) % s.delay_m_s.shape[1]


@compiled
def measure(p: LineArrays, lay: Layout, s: LineState, noise: Array) -> None:
    """Sample load cells and speeds; ``noise`` is (c + d,) standard normal.

    A noise-free run feeds the mean reading of a cell to the tension loops and records speeds
    without quantisation.
    """
    cells = p.cells.size
    noisy = p.timing[0].noisy != 0
    for c in range(cells):
        cell = p.cells[c]
        true = cell.gain * s.y[lay.cell + c] + cell.offset_N
        if cell.hum_N != 0.0:
            turn = 2.0 * math.pi * cell.hum_Hz * s.time_s[0] + cell.hum_phase_rad
            true += cell.hum_N * math.cos(turn)
        s.true_N[c] = true
        if noisy:
            s.measured_N[c] = quantise(true + cell.noise_N * noise[c], cell.lsb_N)
        else:
            s.measured_N[c] = expected_quantise(true, cell.lsb_N, cell.noise_N)
    for d in range(p.drives.size):
        speed = encoder_speed(p, lay, s, d, 1.0)
        if noisy:
            drive = p.drives[d]
            speed = quantise(speed + drive.noise_rad_s * noise[cells + d], drive.lsb_rad_s)
        s.measured_rad_s[d] = speed


@compiled_inside
def advance_frame(
    p: LineArrays,
    lay: Layout,
    s: LineState,
    w: Work,
    line_speed_m_s: float,
    line_speed_end_m_s: float,
    tension_ref_N: Array,
    aff_m_s: Array,
    noise: Array,
) -> None:
    """Advance one frame: tension loops when due, drive ticks, then measure.

    The line-speed reference runs linearly from its start to its end value.
    ``noise`` has (c + d + ticks * d) standard normals (zeros for a noise-free run). Never raises.
    """
    timing = p.timing[0]
    frame_s = timing.ticks_per_frame * timing.drive_tick_s
    keep_changes(p, s.time_s[0])
    if s.counters[0] % timing.frames_per_loop == 0:
        run_loops(p, lay, s, tension_ref_N, timing.frames_per_loop * frame_s)
    drives = p.drives.size
    sensors = p.cells.size + drives
    dt = timing.drive_tick_s / timing.substeps
    for tick in range(timing.ticks_per_frame):
        at = sensors + tick * drives
        share = tick / timing.ticks_per_frame
        speed = line_speed_m_s + share * (line_speed_end_m_s - line_speed_m_s)
        keep_changes(p, s.time_s[0] + tick * timing.drive_tick_s)
        run_drives(p, lay, s, speed, aff_m_s, noise[at : at + drives])
        if p.carriages.size > 0:
            drive_carriages(p, lay, s)
        for _ in range(timing.substeps):
            rk4(p, lay, s, w, dt)
    s.counters[0] += 1
    s.time_s[0] = s.counters[0] * frame_s
    measure(p, lay, s, noise[:sensors])


@compiled
def run_frames(
    p: LineArrays,
    lay: Layout,
    s: LineState,
    w: Work,
    line_speed_m_s: Array,
    tension_ref_N: Array,
    aff_m_s: Array,
    noise: Array,
    out: Array,
) -> None:
    """Run ``out.shape[0]`` frames and log after each, through the same code as one frame.

    Shapes: line_speed (f, 2) at start and end of the frame, tension_ref (f, l), aff (f, d) or
    (f, 2 d) as in ``run_drives``, noise (f, c + d + ticks * d) or (1, ...) to repeat, out
    (f, ``LogLayout.width``).
    """
    for f in range(out.shape[0]):
        step_frame(
            p,
            lay,
            s,
            w,
            line_speed_m_s[f, 0],
            line_speed_m_s[f, 1],
            tension_ref_N[f],
            aff_m_s[f],
            noise[f % noise.shape[0]],
            out[f],
        )


@compiled
def step_frame(
    p: LineArrays,
    lay: Layout,
    s: LineState,
    w: Work,
    line_speed_m_s: float,
    line_speed_end_m_s: float,
    tension_ref_N: Array,
    aff_m_s: Array,
    noise: Array,
    row: Array,
) -> None:
    """Advance one frame and log it: one call instead of two, see ``run_frames``."""
    advance_frame(p, lay, s, w, line_speed_m_s, line_speed_end_m_s, tension_ref_N, aff_m_s, noise)
    log_frame(p, lay, s, w, row)


@compiled
def log_frame(p: LineArrays, lay: Layout, s: LineState, w: Work, row: Array) -> None:
    """Write one log row, see ``LogLayout``; tensions are those of the last Runge-Kutta stage."""
    at = log_layout(p.cells.size, p.drives.size, lay.n, p.carriages.size)
    for c in range(p.cells.size):
        k = p.cells[c].body
        row[at.measured_N + c] = s.measured_N[c]
        row[at.true_N + c] = s.true_N[c]
        row[at.mean_N + c] = 0.5 * (w.tensions[k - 1] + w.tensions[k])
    for d in range(p.drives.size):
        row[at.measured_rad_s + d] = s.measured_rad_s[d]
        k = p.drives[d].body
        row[at.true_rad_s + d] = s.y[lay.omega + k]
        row[at.encoder_rad + d] = s.y[lay.theta + k] + s.y[lay.twist + d]
    for k in range(lay.n):
        row[at.theta_rad + k] = s.y[lay.theta + k]
    row[at.radius_m] = s.y[lay.radius]
    row[at.radius_m + 1] = s.y[lay.radius + 1]
    for i in range(lay.n - 1):
        row[at.tension_N + i] = w.tensions[i]
    for c in range(p.carriages.size):
        row[at.travel_m + c] = s.y[lay.carriage + 2 * c]
