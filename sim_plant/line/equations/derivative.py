"""The line's equations: every balance once, on flat arrays."""

from __future__ import annotations

import math

from sim_plant.base.arrays import REWIND, UNWIND, Array, LineArrays, LineState
from sim_plant.base.jit import compiled, compiled_inside
from sim_plant.elements.contact import body_at, tangent, turned_on
from sim_plant.elements.load_cell import filter_rate, resonance_rates
from sim_plant.elements.roller import friction_torque, gravity_torque
from sim_plant.elements.shaft import shaft_torque
from sim_plant.elements.span import maxwell_rate, strain_rate, tension
from sim_plant.line.equations.layout import Layout
from sim_plant.line.equations.moved_bodies import (
    apart,
    carriage_rates,
    lengthening,
    turn_by_travel,
)
from sim_plant.line.equations.rolls import growth, mean_radius, roll_inertia
from sim_plant.line.equations.spliced_spans import seam_lift, with_two_webs, wrapped
from sim_plant.line.equations.warm_spans import free_strains

NEAR_RAD = 1e-5
"""A Newton step of a tangent below this is not followed by another look at the bodies."""


@compiled_inside
def span_contacts(
    p: LineArrays, lay: Layout, y: Array, i: int, phi: Array, out: Array, more: bool
) -> None:
    """Solve the common tangent of span ``i`` and write L, p_A, p_B, ldot_A, phidot to ``out``.

    ``phi[i]`` is refined from where it is by Newton steps of F, with dF/dphi = L. Once a step is
    below ``NEAR_RAD``, p, h' and L follow it by their derivatives here, with dL/dphi =
    sigma_B rho_B - sigma_A rho_A - F: what is left of p is h'' step^2 / 2 [own derivation].
    ``out`` has shape (m, 8). Without ``more`` no body is carried.
    """
    a, b = p.bodies[i], p.bodies[i + 1]
    dx, dy = b.centre_x_m - a.centre_x_m, b.centre_y_m - a.centre_y_m
    carried = more and (a.carriage >= 0 or b.carriage >= 0)
    if carried:
        dx, dy = apart(p, lay, y, i)
    radius_a = mean_radius(lay, y, a.kind, a.radius_m)
    radius_b = mean_radius(lay, y, b.kind, b.radius_m)
    theta_a, theta_b = y[lay.theta + i], y[lay.theta + i + 1]
    angle = phi[i]
    p_a = p_b = dh_a = dh_b = rho_a = rho_b = length = 0.0
    for _ in range(8):
        p_a, dh_a, rho_a = body_at(
            radius_a,
            a.sigma,
            a.shape_row,
            p.shape_h_m,
            p.shape_dh_m,
            p.shape_rho_m,
            theta_a,
            angle,
        )
        p_b, dh_b, rho_b = body_at(
            radius_b,
            b.sigma,
            b.shape_row,
            p.shape_h_m,
            p.shape_dh_m,
            p.shape_rho_m,
            theta_b,
            angle,
        )
        residual, length = tangent(dx, dy, a.sigma, p_a, dh_a, b.sigma, p_b, dh_b, angle)
        if abs(residual) < 1e-13:
            break
        bend = b.sigma * rho_b - a.sigma * rho_a - residual
        turn = -residual / length
        if abs(turn) < NEAR_RAD:
            angle += turn
            length += bend * turn
            p_a, dh_a = turned_on(p_a, dh_a, rho_a, a.sigma * turn)
            p_b, dh_b = turned_on(p_b, dh_b, rho_b, b.sigma * turn)
            break
        angle += turn
    phi[i] = angle
    omega_a, omega_b = y[lay.omega + i], y[lay.omega + i + 1]
    thickness = p.web[0].thickness_m
    turning = b.sigma * (dh_b * omega_b - growth(b.kind, thickness, omega_b))
    turning -= a.sigma * (dh_a * omega_a - growth(a.kind, thickness, omega_a))
    if carried:
        turning -= turn_by_travel(p, lay, y, i, angle, out)
    phidot = turning / length
    out[i, 0] = length
    out[i, 1] = p_a
    out[i, 2] = p_b
    out[i, 3] = rho_a * (omega_a - a.sigma * phidot)
    out[i, 4] = phidot


@compiled
def web_share(slip_s_m: float, threshold_m_s: float, speed_m_s: float) -> float:
    """Return the share of the body's speed that the web follows (1 without slip)."""
    excess = abs(speed_m_s) - threshold_m_s
    if slip_s_m == 0.0 or excess <= 0.0:
        return 1.0
    return 1.0 - slip_s_m * excess


@compiled_inside
def with_branch(
    p: LineArrays,
    lay: Layout,
    y: Array,
    i: int,
    EA_N: float,
    pull_N: float,
    step: float,
    rate_1_s: float,
    branch_up: float,
    renewal_1_s: float,
    dy: Array,
) -> tuple[float, float]:
    """Return the tension of span ``i`` with its Maxwell branch, N, and the branch's strain.

    ``step``: by how much the elastic strain is more than that of the web that enters.
    """
    web, branch = p.web[0], y[lay.maxwell + i]
    dy[lay.maxwell + i] = maxwell_rate(
        branch, branch_up, step, rate_1_s, web.maxwell_time_s, renewal_1_s
    )
    return max(0.0, pull_N + EA_N * web.maxwell_ratio * branch), branch


@compiled_inside
def span_tensions(  # noqa: PLR0915 - one loop: a call per part of it hands over the whole line
    p: LineArrays,
    lay: Layout,
    y: Array,
    moving: Array,
    phi: Array,
    contacts: Array,
    tensions: Array,
    dy: Array,
    more: bool,
) -> float:
    """Write strain rates and material flow to ``dy`` and tensions (m,) from the state.

    Returns the unstretched length of web behind a splice that has reached the rewind, m. Of the
    lift of a seam, contacts has what it is on the body after each span. Web that is warm leaves
    a span with the strain of its end, T / EA + expansion * warming there: what passes in
    unstretched length is v / (1 + that), into the next span too [source 2.14, own derivation;
    the mean of 1 / (1 + eps) over a span is taken as that of the mean]. Without ``more`` no span
    is warm and no body carried.
    """
    web = p.web[0]
    spans = lay.n - 1
    seam = web.splice_step_m != 0.0
    spliced = web.splice_EA_ratio != 1.0 or web.splice_thickness_ratio != 1.0 or seam
    lift_a = branch_up = entering_K = free_up = 0.0
    behind = y[lay.flow] - web.splice_m
    upstream = web.supply_strain
    if spliced and behind > 0.0:
        upstream /= web.splice_EA_ratio
    first = p.bodies[0]
    share_a = web_share(first.slip_s_m, first.slip_speed_m_s, contacts[0, 1] * y[lay.omega])
    for i in range(spans):
        if moving[i] != 0.0:
            span_contacts(p, lay, y, i, phi, contacts, more)
        lift_b = 0.0
        if seam:
            lift_b = contacts[i, 5] = seam_lift(
                p, i, phi, contacts, behind - contacts[i, 0] / (1.0 + y[lay.strain + i])
            )
        speed_in = (contacts[i, 1] + lift_a) * y[lay.omega + i]
        speed_out = (contacts[i, 2] + lift_b) * y[lay.omega + i + 1]
        flow = contacts[i, 3] if moving[i] != 0.0 else speed_in
        after = p.bodies[i + 1]
        share_b = web_share(after.slip_s_m, after.slip_speed_m_s, speed_out)
        rate_in = speed_in * share_a
        if i == 0:
            rate_in += y[lay.bounce + 1]
            dy[lay.flow] = flow * share_a / (1.0 + upstream)
        flow *= share_a
        strain = y[lay.strain + i]
        span = p.spans[i]
        EA_N, leaving, rate_out = span.EA_N, strain, speed_out * share_b
        free = free_out = span.free_strain
        free_rate = free_step = 0.0
        if more:
            free, free_out, free_rate, entering_K = free_strains(
                p, lay, y, i, flow, contacts[i, 0], entering_K, dy
            )
            free_step = free - free_up
            free_up = free_out
            leaving = strain + free_out - free
            rate_out *= (1.0 + strain) / (1.0 + leaving)
            rate_in -= lengthening(p, lay, y, i, contacts)
        if spliced:
            held, before = contacts[i, 0] / (1.0 + strain), leaving
            EA_N, leaving = with_two_webs(p, i, strain, free, free_out, behind / held)
            rate_out *= (1.0 + before) / (1.0 + leaving)
            behind -= held + wrapped(p, i, phi, contacts) / (1.0 + leaving)
        rate = strain_rate(contacts[i, 0], strain, upstream, rate_in, rate_out, flow)
        dy[lay.strain + i] = rate
        pull = tension(EA_N, strain - free, web.viscosity_s, rate - free_rate)
        if web.maxwell_ratio != 0.0:
            step, renewal = strain - upstream - free_step, flow / contacts[i, 0]
            pull, branch_up = with_branch(
                p, lay, y, i, EA_N, pull, step, rate - free_rate, branch_up, renewal, dy
            )
        tensions[i] = pull
        upstream = leaving
        if spliced and behind <= 0.0:  # old web is still on the body, at the tension before it
            upstream = free_out + (strain - free) * EA_N / span.EA_N
        share_a, lift_a = share_b, lift_b
    last = lay.n - 1
    wander = contacts[spans - 1, 2] * p.bodies[last].sigma * contacts[spans - 1, 4]
    speed_out = contacts[spans - 1, 2] * y[lay.omega + last]
    dy[lay.flow + 1] = (speed_out - wander) * share_a / (1.0 + upstream)
    return float(behind) if spliced else 0.0


@compiled_inside
def ripple_torque(p: LineArrays, d: int, theta_rad: float) -> float:
    """Return the torque ripple of drive ``d`` at this angle, N m."""
    torque = 0.0
    for r in range(p.ripples.size):
        term = p.ripples[r]
        if term.drive == d:
            turn = term.order * theta_rad
            torque += term.cos_N_m * math.cos(turn) + term.sin_N_m * math.sin(turn)
    return torque


@compiled_inside
def body_rates(
    p: LineArrays,
    lay: Layout,
    y: Array,
    contacts: Array,
    tensions: Array,
    torques: Array,
    dy: Array,
) -> None:
    """Write the torque balances: J dw/dt = p_exit T_down - p_entry T_up + tau - friction.

    [source 2.9, 2.32, 3.17, 4.37: one sign convention, no dJ/dt term]. ``dy`` of the speeds
    holds the torque until the inertia divides it.
    """
    last = lay.n - 1
    for k in range(lay.n):
        body = p.bodies[k]
        omega = y[lay.omega + k]
        torque = gravity_torque(
            body.gravity_moment_N_m, body.gravity_moment_angle_rad, body.sigma, y[lay.theta + k]
        ) - friction_torque(body.friction_constant_N_m, body.friction_viscous_N_m_s, omega)
        if k > 0:
            torque -= (contacts[k - 1, 2] + contacts[k - 1, 5]) * tensions[k - 1]
        if 0 < k < last:
            torque += (contacts[k, 1] + contacts[k - 1, 5]) * tensions[k]
        elif k == 0:
            torque += contacts[0, 1] * tensions[0]
        dy[lay.theta + k] = omega
        dy[lay.omega + k] = torque
    shafts(p, lay, y, torques, dy)
    for k in range(lay.n):
        inertia = p.bodies[k].inertia_kg_m2
        if k == 0:
            inertia = roll_inertia(p, inertia, y[lay.radius])
        elif k == last:
            inertia = roll_inertia(p, inertia, y[lay.radius + 1])
        dy[lay.omega + k] /= inertia


@compiled_inside
def shafts(p: LineArrays, lay: Layout, y: Array, torques: Array, dy: Array) -> None:
    """Add motor torques to the bodies, through their shafts where these are not rigid."""
    for d in range(p.drives.size):
        drive = p.drives[d]
        k = drive.body
        motor = torques[d] + ripple_torque(p, d, y[lay.theta + k])
        if drive.shaft_stiffness_N_m == 0.0:
            dy[lay.omega + k] += motor
            continue
        rate = y[lay.motor + d] - y[lay.omega + k]
        through = shaft_torque(
            drive.shaft_stiffness_N_m,
            drive.shaft_damping_N_m_s,
            drive.shaft_backlash_rad,
            y[lay.twist + d],
            rate,
        )
        motor_inertia = drive.motor_share * p.bodies[k].inertia_kg_m2
        full = p.bodies[k].inertia_kg_m2
        if k == 0:
            full = roll_inertia(p, full, y[lay.radius])
        elif k == lay.n - 1:
            full = roll_inertia(p, full, y[lay.radius + 1])
        dy[lay.omega + k] = (dy[lay.omega + k] + through) * full / (full - motor_inertia)
        dy[lay.motor + d] = (motor - through) / motor_inertia
        dy[lay.twist + d] = rate


@compiled_inside
def sensor_rates(p: LineArrays, lay: Layout, y: Array, tensions: Array, dy: Array) -> None:
    """Write the load-cell filter and resonance rates."""
    for c in range(p.cells.size):
        cell = p.cells[c]
        k = cell.body
        pull = 0.5 * (tensions[k - 1] + tensions[k])
        if cell.unbalance_kg_m != 0.0:
            omega = y[lay.omega + k]
            turn = y[lay.theta + k] + cell.unbalance_angle_rad
            pull += cell.unbalance_kg_m * omega * omega * math.cos(turn)
        if cell.resonance_Hz > 0.0:
            at = lay.resonance + 2 * c
            rate, acceleration = resonance_rates(
                cell.resonance_Hz, cell.resonance_damping, pull, y[at], y[at + 1]
            )
            dy[at] = rate
            dy[at + 1] = acceleration
            pull = y[at]
        dy[lay.cell + c] = filter_rate(cell.corner_Hz, pull, y[lay.cell + c])


@compiled_inside
def bounce_rates(p: LineArrays, lay: Layout, y: Array, pull_N: float, dy: Array) -> None:
    """Write m x'' = T + u(theta) omega^2 - m w^2 x - 2 zeta m w x' of the unwind on its mandrel.

    u has order 1 and one other order of the roll's angle; x counts along the first span, towards
    the line, so x' adds to the web that enters the span [own; point mass on a spring].
    """
    web = p.web[0]
    w = 2.0 * math.pi * web.bounce_Hz
    turn, high = y[lay.theta], web.bounce_order * y[lay.theta]
    unbalance = web.bounce_cos1_kg_m * math.cos(turn) + web.bounce_sin1_kg_m * math.sin(turn)
    unbalance += web.bounce_cosn_kg_m * math.cos(high) + web.bounce_sinn_kg_m * math.sin(high)
    force = unbalance * y[lay.omega] * y[lay.omega]
    dy[lay.bounce] = y[lay.bounce + 1]
    dy[lay.bounce + 1] = (
        (pull_N + force) / web.bounce_mass_kg
        - w * w * y[lay.bounce]
        - 2.0 * web.bounce_damping * w * y[lay.bounce + 1]
    )


@compiled_inside
def derivative(
    p: LineArrays,
    lay: Layout,
    s: LineState,
    y: Array,
    moving: Array,
    contacts: Array,
    tensions: Array,
    dy: Array,
    more: bool,
) -> None:
    """Write dy/dt of the whole line at ``y``; work arrays are the caller's. Never raises.

    ``more`` is whether there are carriages or warm spans, and a constant where this is called: the
    compiled code of a plain line has nothing of them then.
    """
    behind = span_tensions(p, lay, y, moving, s.phi_rad, contacts, tensions, dy, more)
    body_rates(p, lay, y, contacts, tensions, s.torque_N_m, dy)
    web = p.web[0]
    unwinding = rewinding = web.thickness_m
    if web.splice_thickness_ratio != 1.0:
        if y[lay.flow] > web.splice_m:
            unwinding *= web.splice_thickness_ratio
        if behind > 0.0:
            rewinding *= web.splice_thickness_ratio
    dy[lay.radius] = growth(UNWIND, unwinding, y[lay.omega])
    dy[lay.radius + 1] = growth(REWIND, rewinding, y[lay.omega + lay.n - 1])
    if web.bounce_mass_kg > 0.0:
        bounce_rates(p, lay, y, tensions[0], dy)
    if more:
        carriage_rates(p, lay, y, s.carriage_force_N, contacts, tensions, dy)
    sensor_rates(p, lay, y, tensions, dy)
