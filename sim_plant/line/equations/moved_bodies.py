"""Bodies whose centres move: dancers and accumulators in the line's equations.

One coordinate s, the travel, moves all rollers of a carriage. With C the centre of a body and d
the direction of a span, d.dC/ds is the *lever* of that end of it. The lever takes the carriage's
speed into the span's length and the web's tension onto the carriage, so that the power
T (lever_B s_B' - lever_A s_A') that the spans take is what the carriages give [own derivation from
virtual work; dancers and accumulators are named as future work in source chapter 6].
"""

from __future__ import annotations

import math

from sim_plant.base.arrays import Array, LineArrays, LineState
from sim_plant.base.jit import compiled, compiled_inside
from sim_plant.elements.carriage import buffer_force, friction_force
from sim_plant.elements.drive import speed_pi
from sim_plant.line.equations.layout import Layout

LEVER_A, LEVER_B = 6, 7
"""Columns of the contacts: levers of the body before a span and of the one after it."""


@compiled_inside
def moved_point(
    p: LineArrays, c: int, travel_m: float, x_m: float, y_m: float
) -> tuple[float, float, float, float]:
    """Return where a point of carriage ``c`` is, m, and what it moves per metre of travel.

    ``x_m``, ``y_m`` is where it is at travel 0. On an arm it turns about the pivot by ``turn``
    times the travel.
    """
    carriage = p.carriages[c]
    if carriage.pendulum == 0:
        x = x_m + travel_m * carriage.axis_x
        y = y_m + travel_m * carriage.axis_y
        return x, y, carriage.axis_x, carriage.axis_y
    turned = carriage.turn_1_m * travel_m
    sine, cosine = math.sin(turned), math.cos(turned)
    from_x, from_y = x_m - carriage.pivot_x_m, y_m - carriage.pivot_y_m
    arm_x = cosine * from_x - sine * from_y
    arm_y = sine * from_x + cosine * from_y
    return (
        carriage.pivot_x_m + arm_x,
        carriage.pivot_y_m + arm_y,
        -carriage.turn_1_m * arm_y,
        carriage.turn_1_m * arm_x,
    )


@compiled_inside
def centre_of(p: LineArrays, lay: Layout, y: Array, k: int) -> tuple[float, float, float, float]:
    """Return the centre of body ``k`` now, m, and what it moves per metre of its travel."""
    body = p.bodies[k]
    if body.carriage < 0:
        return body.centre_x_m, body.centre_y_m, 0.0, 0.0
    travel_m = y[lay.carriage + 2 * body.carriage]
    return moved_point(p, body.carriage, travel_m, body.centre_x_m, body.centre_y_m)


@compiled_inside
def travel_speed(p: LineArrays, lay: Layout, y: Array, k: int) -> float:
    """Return the speed of the carriage that body ``k`` belongs to, m/s; 0 where it stands."""
    carriage = p.bodies[k].carriage
    return float(y[lay.carriage + 2 * carriage + 1]) if carriage >= 0 else 0.0


@compiled
def apart(p: LineArrays, lay: Layout, y: Array, i: int) -> tuple[float, float]:
    """Return from where to where span ``i`` leads, centre to centre, m."""
    a_x, a_y, _a_sx, _a_sy = centre_of(p, lay, y, i)
    b_x, b_y, _b_sx, _b_sy = centre_of(p, lay, y, i + 1)
    return b_x - a_x, b_y - a_y


@compiled_inside
def turn_by_travel(
    p: LineArrays, lay: Layout, y: Array, i: int, phi_rad: float, out: Array
) -> float:
    """Write both levers of span ``i`` to ``out``; return n.(C_B' - C_A'), m/s.

    The tangent F = n.(C_B - C_A) + sigma_B p_B - sigma_A p_A = 0 with dF/dphi = L holds while
    centres move, so phidot L = - n.(C_B' - C_A') - ..., n = (sin phi, -cos phi) [own derivation].
    """
    sine, cosine = math.sin(phi_rad), math.cos(phi_rad)
    _a_x, _a_y, a_sx, a_sy = centre_of(p, lay, y, i)
    _b_x, _b_y, b_sx, b_sy = centre_of(p, lay, y, i + 1)
    out[i, LEVER_A] = cosine * a_sx + sine * a_sy
    out[i, LEVER_B] = cosine * b_sx + sine * b_sy
    across = (sine * b_sx - cosine * b_sy) * travel_speed(p, lay, y, i + 1)
    return float(across - (sine * a_sx - cosine * a_sy) * travel_speed(p, lay, y, i))


@compiled_inside
def lengthening(p: LineArrays, lay: Layout, y: Array, i: int, contacts: Array) -> float:
    """Return d.(C_B' - C_A') of span ``i``, m/s: what moving centres add to its balance.

    dL/dt + ldot_B - ldot_A = p_B w_B - p_A w_A + d.(C_B' - C_A') [own derivation; source 2.21 has
    the same as xdot terms, corrected: flow relative to the contact points].
    """
    added = contacts[i, LEVER_B] * travel_speed(p, lay, y, i + 1)
    return float(added - contacts[i, LEVER_A] * travel_speed(p, lay, y, i))


@compiled_inside
def carriage_rates(
    p: LineArrays,
    lay: Layout,
    y: Array,
    forces: Array,
    contacts: Array,
    tensions: Array,
    dy: Array,
) -> None:
    """Write M s'' = F + F_drive - k s - friction - weight - sum(T dL/ds) of every carriage.

    The weight acts where the file puts it: W dy/ds. An arm has s along the circle of its first
    roller and M = J / r^2, forces over r likewise [linear: Pagilla, Singh, Dwivedula 2004, with
    a tension of each span of its own; pendulum: Ebler et al. 1993]. ``dy`` of the speeds
    holds the force until the mass divides it.
    """
    for c in range(p.carriages.size):
        carriage = p.carriages[c]
        at = lay.carriage + 2 * c
        travel, speed = y[at], y[at + 1]
        _x, _y, _x_s, rise = moved_point(p, c, travel, carriage.weight_x_m, carriage.weight_y_m)
        force = carriage.load_N + forces[c] - carriage.stiffness_N_m * travel
        force -= friction_force(carriage.friction_N, carriage.damping_N_s_m, speed)
        force += buffer_force(carriage.mass_kg, carriage.from_m, carriage.to_m, travel, speed)
        dy[at] = speed
        dy[at + 1] = force - carriage.weight_N * rise
    for i in range(lay.n - 1):
        before, after = p.bodies[i].carriage, p.bodies[i + 1].carriage
        if before >= 0:
            dy[lay.carriage + 2 * before + 1] += contacts[i, LEVER_A] * tensions[i]
        if after >= 0:
            dy[lay.carriage + 2 * after + 1] -= contacts[i, LEVER_B] * tensions[i]
    for c in range(p.carriages.size):
        dy[lay.carriage + 2 * c + 1] /= p.carriages[c].mass_kg


@compiled_inside
def drive_carriages(p: LineArrays, lay: Layout, s: LineState) -> None:
    """Run the speed PI of every carriage that has a drive of its own, and hold its force."""
    for c in range(p.carriages.size):
        carriage = p.carriages[c]
        if carriage.gain_rad_s > 0.0:
            force, integral = speed_pi(
                carriage.mass_kg,
                carriage.gain_rad_s,
                carriage.drive_damping,
                carriage.speed_m_s - s.y[lay.carriage + 2 * c + 1],
                s.carriage_integral_m[c],
                p.timing[0].drive_tick_s,
                carriage.limit_N,
            )
            s.carriage_force_N[c] = force
            s.carriage_integral_m[c] = integral
