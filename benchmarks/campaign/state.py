"""The true machine and everything in it that moves, as flat arrays."""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np

from benchmarks.campaign.contact import Array, Bodies, IntArray


class Machine(NamedTuple):
    """The true machine. Scalars of the web are (1,) in ``web`` by the names below.

    Attributes
    ----------
    radius, inertia, drag, viscous : (n,); inertia of rolls is core and drive only.
    gravity_moment, gravity_moment_angle : m g e in N m and its angle in the body, (n,).
    web : viscosity s, density, thickness, width, wound-in strain, core radius, wave share,
        wave length m, stiffening per relative tension.
    modulus, free : EA and free strain of the spans, (m,).
    drive_* : (d,): body, declared inertia, gain, zeta, draw, loop (-1 none), believed radius
        ratio, delay ticks, slew m/s per tick (0 none), encoder eccentricity, its angle, share
        of it in the loop.
    slip, slip_speed : (n,).
    ripple : (r, 4) drive, order, cos, sin.
    cell_* : (c,): body, corner Hz, gain, offset, resonance Hz and damping, unbalance, its angle,
        hum N, Hz and phase, drift N per s.
    loop_* : (l,): cell, gain, corner, sign.
    shake : (s, 5): span, kind 0 time 1 travel, Hz or 1/m, amplitude m, phase.
    gust : (2,) drive (or -1) and N m: coloured torque noise comes as an input.
    """

    bodies: Bodies
    radius: Array
    inertia: Array
    drag: Array
    viscous: Array
    gravity_moment: Array
    gravity_moment_angle: Array
    web: Array
    modulus: Array
    free: Array
    drive_body: IntArray
    drive_inertia: Array
    drive_gain: Array
    drive_zeta: Array
    drive_draw: Array
    drive_loop: IntArray
    drive_ratio: Array
    drive_delay: IntArray
    drive_slew: Array
    encoder: Array
    encoder_angle: Array
    encoder_share: Array
    slip: Array
    slip_speed: Array
    ripple: Array
    cell_body: IntArray
    cell_Hz: Array
    cell_gain: Array
    cell_offset: Array
    cell_ring_Hz: Array
    cell_ring_damping: Array
    cell_unbalance: Array
    cell_unbalance_angle: Array
    cell_hum: Array
    cell_hum_Hz: Array
    cell_hum_phase: Array
    cell_drift: Array
    loop_cell: IntArray
    loop_gain: Array
    loop_corner: Array
    loop_sign: Array
    shake: Array
    gust: Array


class State(NamedTuple):
    """Everything that moves, and scratch.

    Attributes
    ----------
    theta, omega, rate, turn, radius, out_m, zero : (n,): angle, speed, acceleration, angle of
        this step, radius, web wound since the start, angle from which winding counts.
    phi, swing, strain, held, pull : (m,): direction, its change, strain, unstretched length,
        tension.
    vertices : (m, 2) touching points. geometry : (m, 5), see ``span_between``.
    cell : (c, 3) filtered force, mount position and rate. words : (c,) as read.
    motor, integral, reference : (d,). past : (d, ticks) corrections.
    correction, error_N_s : (l,). passed : (2,) web travel and unstretched web delivered, m.
    """

    theta: Array
    omega: Array
    rate: Array
    turn: Array
    radius: Array
    out_m: Array
    zero: Array
    phi: Array
    swing: Array
    strain: Array
    held: Array
    pull: Array
    vertices: IntArray
    geometry: Array
    cell: Array
    words: Array
    motor: Array
    integral: Array
    reference: Array
    past: Array
    correction: Array
    error_N_s: Array
    passed: Array


def resting_tensions(m: Machine, speed: float, tension: float) -> Array:
    """Return about the tensions (m,) at rest: the loops' cells hold theirs, drag adds up."""
    omega = speed / m.radius
    rise = (m.drag + m.viscous * omega) / m.radius
    rise[m.drive_body] = 0.0
    pull = np.full(m.modulus.size, tension)
    share = 1.0 - m.slip * np.maximum(0.0, speed - m.slip_speed)
    given = speed * (1.0 + m.drive_draw) / m.drive_ratio * share[m.drive_body]
    fixed = [int(k) for k in m.drive_body[1:-1]]  # driven rollers between the two rolls
    ends = [0, *fixed, m.modulus.size]
    for zone, (first, end) in enumerate(itertools.pairwise(ends)):
        inside = np.concatenate(([0.0], np.cumsum(rise[first + 1 : end])))
        if zone == 1:  # the draw zone takes its strain from the one before
            a, b = (list(m.drive_body).index(k) for k in fixed)
            gain = given[b] / given[a] - 1.0
            strain = pull[first - 1] / m.modulus[first - 1] + m.free[first - 1] + gain
            pull[first:end] = m.modulus[first:end] * (strain - m.free[first:end])
            pull[first:end] += inside - inside[-1]
            continue
        cell = m.cell_body[m.loop_cell[0 if zone == 0 else 1]]
        at = int(cell) - first
        pull[first:end] = tension + inside - 0.5 * (inside[at - 1] + inside[at])
    return pull
