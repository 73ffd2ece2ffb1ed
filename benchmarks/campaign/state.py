"""The true machine and everything in it that moves, as flat arrays."""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np

from benchmarks.campaign.contact import Array, Bodies, IntArray

WAVE, WAVE_M, STIFFENING, CREEP, CREEP_S = 6, 7, 8, 9, 10
"""Places in ``web`` of what a healthy machine has at 0."""
DRAG, FREE, SLIP = 0, 1, 2
"""What a row of ``change`` changes."""
NOT_YET = -1.0
"""Of web behind a seam at a body that the seam has not reached."""


class Machine(NamedTuple):
    """The true machine. Scalars of the web are (1,) in ``web`` by the names below.

    Attributes
    ----------
    radius, inertia, drag, viscous : (n,); inertia of rolls is core and drive only.
    gravity_moment, gravity_moment_angle : m g e in N m and its angle in the body, (n,).
    web : viscosity s, density, thickness, width, wound-in strain, core radius, wave share,
        wave length m, stiffening per relative tension, share of the stiffness that creeps, its
        time s.
    modulus, free : EA and free strain of the spans, (m,).
    drive_* : (d,): body, declared inertia, gain, zeta, draw, loop (-1 none), believed radius
        ratio, delay ticks, slew m/s2 of the whole reference and of the correction alone (0 none),
        encoder eccentricity, its angle, share of it in the loop.
    shaft : (d, 4) inertia of the motor kg m2, stiffness N m/rad (0 rigid), damping N m s,
        play rad.
    slip, slip_speed : (n,).
    ripple : (r, 4) drive, order, cos, sin.
    cell_* : (c,): body, corner Hz, gain, offset, resonance Hz and damping, unbalance, its angle,
        hum N, Hz and phase, drift N per s.
    loop_* : (l,): cell, gain, corner, sign.
    shake : (s, 5): span, kind 0 time 1 travel, Hz or 1/m, amplitude m, phase.
    gust : (2,) drive (or -1) and N m: coloured torque noise comes as an input.
    axle : (8,) of the unwind on a soft mandrel: mass kg (0 rigid), Hz, damping, order, and kg m
        cos and sin of unbalance at that order, then at order 1.
    seam : (5,) s after which the roll gives another web (negative: never), ratio of EA, ratio of
        thickness, step m of the seam itself, its length m.
    change : (e, 6) a number that changes: what, place, amount, from s, rise s, until s.
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
    drive_ramp: Array
    shaft: Array
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
    axle: Array
    seam: Array
    change: Array


class State(NamedTuple):
    """Everything that moves, and scratch.

    Attributes
    ----------
    theta, omega, rate, turn, radius, out_m, zero : (n,): angle, speed, acceleration, angle of
        this step, radius, web wound since the start, angle from which winding counts.
    heavy : (n,) inertia that turns now. lift, reach : (n,) how much further out a seam lies, and
        radius with it.
    behind : (n,) unstretched web behind a seam that came to the body, see ``NOT_YET``.
    phi, swing, strain, held, pull : (m,): direction, its change, strain, unstretched length,
        tension.
    leaves, old : (m,) strain of the web at a span's exit, and that of old web under this tension.
    crept : (m,) strain that has crept, times unstretched length, m.
    more_drag, more_slip, more_free : (n,), (n,), (m,) what has changed since the start.
    vertices : (m, 2) touching points. geometry : (m, 5), see ``span_between``.
    cell : (c, 3) filtered force, mount position and rate. words : (c,) as read.
    motor, integral, reference : (d,). past : (d, ticks) corrections.
    ramped : (d,) corrections behind their own ramps. twist : (d, 3) of a shaft: angle, speed of
        the motor, its acceleration. axle : (3,) way of the unwind's axle m, its rates.
    thicker : (2,) radius that the rolls have from web of another thickness, m.
    correction, error_N_s : (l,). passed : (2,) web travel and unstretched web delivered, m.
    """

    theta: Array
    omega: Array
    rate: Array
    heavy: Array
    turn: Array
    radius: Array
    out_m: Array
    zero: Array
    lift: Array
    reach: Array
    behind: Array
    phi: Array
    swing: Array
    strain: Array
    held: Array
    pull: Array
    leaves: Array
    old: Array
    crept: Array
    more_drag: Array
    more_slip: Array
    more_free: Array
    vertices: IntArray
    geometry: Array
    cell: Array
    words: Array
    motor: Array
    integral: Array
    reference: Array
    past: Array
    ramped: Array
    twist: Array
    axle: Array
    thicker: Array
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
