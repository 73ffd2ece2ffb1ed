"""The line in motion: bodies, unstretched web in every span, load cells, shafts; its slopes.

A span between bodies A and B runs along d = (cos phi, sin phi) with normal n = (sin phi, -cos phi)
and touches both: n (C_B - C_A) + s_B h_B - s_A h_A = 0, h the distance of the tangent from the
centre, s +1 for a body that turns counter-clockwise. What passes the touching point of a body is
(h + h'') (w - s phi'). The unstretched length N of a span follows from what passes its ends, its
strain is L / N - 1  [own derivation, after sections 2 and 4.3 of the source].
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.jit import compiled

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
GRAVITY = 9.80665
STILL_RAD_S = 0.3
EDGE_M = 0.01
"""Web over which a seam lifts it: no web is bent sharply."""
DRAG, WARM = 0.0, 1.0
MODULUS, DRAW, GAIN, ZERO, DRIVE, LOOP = 2.0, 3.0, 4.0, 5.0, 6.0, 7.0
"""What a row of ``change`` changes; what is not of a body or a span becomes another number at its
moment and stays so: the web's modulus, a drive's draw, a cell's gain and zero, the gain of a drive
and of a tension loop (shares, but of a draw and of a zero, N)."""


class Plant(NamedTuple):
    """The true machine: n bodies, m spans, c cells, d drives.

    Attributes
    ----------
    x, y, sense, radius, growth : (n,) centres m, +1 or -1, radius at the start m, and how much
        it grows per rad of turn.
    inertia, drag, viscous : (n,); wound web comes on top, a motor on a soft shaft does not count.
    off, off_angle : (n,) eccentricity m and its angle in the body, in the sense of transport.
    heavy, heavy_angle : (n,) m g r of an unbalance N m, and its angle.
    shape : (3, k + 1) of the unwind: h - R, h' and h + h'' - R, m, over a turn; k 1 is round.
    slip, slip_above : (n,) share of speed lost per m/s beyond a speed.
    web : EA N, viscosity s, wound-in strain, kg per m2 of a roll's side, core radius m, share
        that relaxes, its time s.
    drive_body ... drive_ramp : (d,) body, inertia that the drive reckons with, gain, zeta, draw,
        loop or -1, believed over true radius, delay in ticks, limits m/s2 of the reference and
        of the correction (0 none).
    ripple : (d, 3) torque N m, order, angle. shaft : (d, 4) inertia of the motor kg m2, stiffness
        N m/rad (0 rigid), damping N m s, play rad.
    cell_* : (c,) body, corner Hz, gain, zero N, resonance Hz (0 stiff) and damping.
    hum : (c, 3) N, Hz, phase.
    loop_* : (l,) cell, gain, corner, sign.
    axle : kg (0 rigid), Hz, damping, order, kg m at that order, its angle, kg m at order 1.
    seam : s of the record when it leaves the unwind (negative never), its step m and length m.
    change : (e, 6) what, place, amount, from s, rise s, until s.
    play_N, freeze, pulse, shake : not in any library: play of all cell mounts; every s and for s
        that corrections stand still; (m,) strain with its Hz last; span, m, Hz, every s.
    """

    x: Array
    y: Array
    sense: Array
    radius: Array
    growth: Array
    inertia: Array
    drag: Array
    viscous: Array
    off: Array
    off_angle: Array
    heavy: Array
    heavy_angle: Array
    shape: Array
    slip: Array
    slip_above: Array
    web: Array
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
    ripple: Array
    shaft: Array
    cell_body: IntArray
    cell_Hz: Array
    cell_gain: Array
    cell_zero: Array
    cell_ring_Hz: Array
    cell_ring_damping: Array
    hum: Array
    loop_cell: IntArray
    loop_gain: Array
    loop_corner: Array
    loop_sign: Array
    axle: Array
    seam: Array
    change: Array
    play_N: Array
    freeze: Array
    pulse: Array
    shake: Array


class Places(NamedTuple):
    """Where what stands in the state vector: the first place of each."""

    omega: int
    natural: int
    crept: int
    cell: int
    mount: int
    motor: int
    twist: int
    axle: int
    passed: int
    size: int


class Now(NamedTuple):
    """What is true of this instant: set from outside a step, or scratch of a slope.

    Attributes
    ----------
    drag, warm, torque : (n,), (m,), (d,) as they are in this tick.
    phi : (m,) directions. fixed : (m, 8) geometry of a span, see ``span``; moves : (m,) 1 where
        it changes.
    lifts : (n,) how far a seam lifts the web off a body, m.
    pull : (m,) tensions N. zero : (2,) angles of the rolls from which they shrink and grow.
    slopes, trial : (4, size), (size,).
    """

    drag: Array
    warm: Array
    torque: Array
    phi: Array
    fixed: Array
    moves: IntArray
    lifts: Array
    pull: Array
    zero: Array
    slopes: Array
    trial: Array


@compiled
def places(n: int, cells: int, drives: int) -> Places:
    """Return the layout of the state: angles come first."""
    omega = n
    natural = omega + n
    crept = natural + n - 1
    cell = crept + n - 1
    mount = cell + cells
    motor = mount + 2 * cells
    twist = motor + drives
    axle = twist + drives
    return Places(omega, natural, crept, cell, mount, motor, twist, axle, axle + 2, axle + 3)


@compiled
def radius_now(p: Plant, now: Now, y: Array, k: int) -> float:
    """Return the radius of a body, of a roll with what it has wound since the start."""
    if p.growth[k] == 0.0:
        return float(p.radius[k])
    return float(p.radius[k] + p.growth[k] * (y[k] - now.zero[0 if k == 0 else 1]))


@compiled
def of_shape(p: Plant, angle: float) -> Any:
    """Return h - R, h' and h + h'' - R of the unwind at an angle of the body."""
    count = p.shape.shape[1] - 1
    if count == 1:
        return 0.0, 0.0, 0.0
    at = angle * count / (2.0 * math.pi)
    at -= count * math.floor(at / count)
    low = min(int(at), count - 1)
    share = at - low
    a, b = p.shape[:, low], p.shape[:, low + 1]
    return (
        a[0] + share * (b[0] - a[0]),
        a[1] + share * (b[1] - a[1]),
        a[2] + share * (b[2] - a[2]),
    )


@compiled
def span(p: Plant, now: Now, y: Array, i: int, w: Places) -> None:
    """Write length, its rate, direction, its rate, both arms and both flows of span ``i``."""
    j = i + 1
    sa, sb = p.sense[i], p.sense[j]
    wa, wb = y[w.omega + i], y[w.omega + j]
    ra, rb = radius_now(p, now, y, i), radius_now(p, now, y, j)
    ta, tb = sa * (y[i] + p.off_angle[i]), sb * (y[j] + p.off_angle[j])
    ax, ay = p.off[i] * math.cos(ta), p.off[i] * math.sin(ta)
    bx, by = p.off[j] * math.cos(tb), p.off[j] * math.sin(tb)
    dx, dy = p.x[j] + bx - p.x[i] - ax, p.y[j] + by - p.y[i] - ay
    vx, vy = sa * wa * ay - sb * wb * by, sb * wb * bx - sa * wa * ax
    apart = math.hypot(dx, dy)
    ha, slope, rho = ra, 0.0, ra
    phi = math.atan2(dy, dx) - math.asin((sb * rb - sa * ra) / apart)
    if i == 0 and p.shape.shape[1] > 2:
        phi = now.phi[0]
        for _ in range(12):
            h, slope, more = of_shape(p, sa * phi - 0.5 * math.pi - y[0])
            ha, rho = ra + h, ra + more
            error = math.sin(phi) * dx - math.cos(phi) * dy + sb * rb - sa * ha
            step = error / (math.cos(phi) * dx + math.sin(phi) * dy - slope)
            phi -= step
            if abs(step) < 1e-12:
                break
    now.phi[i] = phi
    nx, ny = math.sin(phi), -math.cos(phi)
    length = nx * dy - ny * dx - slope
    reach = sb * p.growth[j] * wb - sa * (p.growth[i] * wa - slope * wa)
    turn = -(nx * vx + ny * vy + reach) / length
    g = now.fixed[i]
    g[0], g[2], g[3] = length, phi, turn
    g[4] = ha + sa * (ax * nx + ay * ny)
    g[5] = rb + sb * (bx * nx + by * ny)
    g[6] = rho * (wa - sa * turn)
    g[7] = rb * (wb - sb * turn)
    g[1] = g[5] * wb - g[4] * wa + g[6] - g[7]


@compiled
def kept(p: Plant, k: int, surface_m_s: float) -> float:
    """Return the share of its surface speed that a body gives to the web."""
    return float(1.0 - p.slip[k] * max(0.0, surface_m_s - p.slip_above[k]))


@compiled
def lift(p: Plant, past_m: float, wrap_m: float) -> float:
    """Return how much further out the web runs where a seam is on a body, m."""
    come = min(max(past_m / EDGE_M, 0.0), 1.0)
    gone = min(max((past_m - wrap_m - p.seam[2]) / EDGE_M, 0.0), 1.0)
    return float(p.seam[1] * (come - gone))


@compiled
def swing(p: Plant, time_s: float) -> Any:
    """Return how much a shaken support lengthens a span at a time, m, and its rate, m/s."""
    if p.shake[1] == 0.0 or time_s < 0.0:
        return 0.0, 0.0
    w = 2.0 * math.pi * p.shake[2]
    part = (time_s % p.shake[3]) / (0.4 * p.shake[3])
    if part >= 1.0:
        return 0.0, 0.0
    size = p.shake[1] * math.sin(math.pi * part) ** 2
    rate = p.shake[1] * math.pi / (0.4 * p.shake[3]) * math.sin(2.0 * math.pi * part)
    return size * math.sin(w * time_s), (
        size * w * math.cos(w * time_s) + rate * math.sin(w * time_s)
    )


@compiled
def web_slopes(p: Plant, now: Now, y: Array, w: Places, time_s: float, dy: Array) -> None:
    """Write the rates of unstretched lengths and creep, and all tensions."""
    m = p.x.size - 1
    ea, viscosity, relaxing, relax_s = p.web[0], p.web[1], p.web[5], p.web[6]
    strain_in = crept_in = p.web[2]
    lift_a, past = 0.0, y[w.passed]
    for i in range(m):
        if now.moves[i] != 0:
            span(p, now, y, i, w)
        g = now.fixed[i]
        if now.moves[i] == 0:
            g[6], g[7] = g[4] * y[w.omega + i], g[5] * y[w.omega + i + 1]
        length, rate = g[0], g[1]
        if i == 0:
            length -= y[w.axle]
            rate -= y[w.axle + 1]
        if i == int(p.shake[0]) or i == int(p.shake[0]) - 1:
            more, faster = swing(p, time_s)
            length += more
            rate += faster
        natural = y[w.natural + i]
        strain = length / natural - 1.0
        lift_b = 0.0
        if p.seam[1] != 0.0 and i + 1 < m:
            past -= natural
            wrap = p.sense[i + 1] * (now.fixed[i + 1, 2] - g[2])
            wrap = g[5] * (wrap - 2.0 * math.pi * math.floor(wrap / (2.0 * math.pi)))
            lift_b = lift(p, past * (1.0 + strain), wrap)
            past -= wrap / (1.0 + strain)
        now.lifts[i + 1] = lift_b
        gone_in = (g[6] + lift_a * y[w.omega + i]) * kept(p, i, g[6]) / (1.0 + strain_in)
        gone_out = (g[7] + lift_b * y[w.omega + i + 1]) * kept(p, i + 1, g[7]) / (1.0 + strain)
        flow = gone_in - gone_out
        dy[w.natural + i] = flow
        if i == 0:
            dy[w.passed] = gone_in
        free = now.warm[i]
        if p.pulse[i] != 0.0:
            free += p.pulse[i] * math.sin(2.0 * math.pi * p.pulse[m] * time_s)
        stress = strain - free + viscosity * (rate - length / natural * flow) / natural
        if relaxing != 0.0:
            crept = y[w.crept + i] / natural
            fresh = strain - free - crept
            stress += relaxing * fresh
            gained = crept_in * gone_in - crept * gone_out
            dy[w.crept + i] = gained + natural * fresh / relax_s
            crept_in = crept
        now.pull[i] = max(0.0, ea * stress)
        strain_in, lift_a = strain, lift_b


@compiled
def turning(p: Plant, k: int, radius: float, fixed: float) -> float:
    """Return the inertia that turns with a body: of a roll with its web, kg m2."""
    if p.growth[k] == 0.0:
        return fixed
    return float(fixed + 0.5 * math.pi * p.web[3] * (radius**4 - p.web[4] ** 4))


@compiled
def shaft_torque(p: Plant, d: int, twist: float, rate: float) -> float:
    """Return what a shaft with play passes on, N m."""
    half = 0.5 * p.shaft[d, 3]
    if abs(twist) <= half:
        return 0.0
    return float(p.shaft[d, 1] * (twist - math.copysign(half, twist)) + p.shaft[d, 2] * rate)


@compiled
def slopes(p: Plant, now: Now, y: Array, w: Places, time_s: float, dy: Array) -> None:
    """Write dy/dt of the whole line."""
    n = p.x.size
    web_slopes(p, now, y, w, time_s, dy)
    for k in range(n):
        speed = y[w.omega + k]
        dy[k] = speed
        torque = -(p.drag[k] + now.drag[k]) * math.tanh(speed / STILL_RAD_S) - p.viscous[k] * speed
        torque -= p.sense[k] * p.heavy[k] * math.cos(y[k] + p.heavy_angle[k])
        if k > 0:
            torque -= (now.fixed[k - 1, 5] + now.lifts[k]) * now.pull[k - 1]
        if k < n - 1:
            torque += (now.fixed[k, 4] + now.lifts[k]) * now.pull[k]
        heavy = turning(p, k, radius_now(p, now, y, k), p.inertia[k])
        dy[w.omega + k] = torque / heavy
    for d in range(p.drive_body.size):
        k = p.drive_body[d]
        push = now.torque[d]
        push += p.ripple[d, 0] * math.cos(p.ripple[d, 1] * y[k] - p.ripple[d, 2])
        if p.shaft[d, 1] != 0.0:
            rate = y[w.motor + d] - y[w.omega + k]
            through = shaft_torque(p, d, y[w.twist + d], rate)
            dy[w.twist + d] = rate
            dy[w.motor + d] = (push - through) / p.shaft[d, 0]
            push = through
        heavy = turning(p, k, radius_now(p, now, y, k), p.inertia[k])
        dy[w.omega + k] += push / heavy
    cell_slopes(p, now, y, w, dy)
    if p.axle[0] != 0.0:
        axle_slopes(p, now, y, w, dy)


@compiled
def cell_slopes(p: Plant, now: Now, y: Array, w: Places, dy: Array) -> None:
    """Write the rates of mounts and amplifiers of the cells."""
    for c in range(p.cell_body.size):
        k = p.cell_body[c]
        force = 0.5 * (now.pull[k - 1] + now.pull[k])
        if p.cell_ring_Hz[c] != 0.0:
            a = 2.0 * math.pi * p.cell_ring_Hz[c]
            at = w.mount + 2 * c
            dy[at] = y[at + 1]
            dy[at + 1] = a * (a * (force - y[at]) - 2.0 * p.cell_ring_damping[c] * y[at + 1])
            force = y[at]
        dy[w.cell + c] = 2.0 * math.pi * p.cell_Hz[c] * (force - y[w.cell + c])


@compiled
def axle_slopes(p: Plant, now: Now, y: Array, w: Places, dy: Array) -> None:
    """Write the rates of the unwind's axle on a soft mandrel, along the first span."""
    a = 2.0 * math.pi * p.axle[1]
    push = p.axle[4] * math.cos(p.axle[3] * y[0] - p.axle[5]) + p.axle[6] * math.cos(y[0])
    force = now.pull[0] + push * y[w.omega] ** 2
    dy[w.axle] = y[w.axle + 1]
    dy[w.axle + 1] = force / p.axle[0] - a * (a * y[w.axle] + 2.0 * p.axle[2] * y[w.axle + 1])
