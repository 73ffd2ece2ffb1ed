"""Power in = power stored + power lost, with the arms of the exact geometry.

The web takes T (p_B w_B - p_A w_A) from the bodies at its ends. Of that, the span stores
EA eps^2 / 2 per unstretched metre, Kelvin-Voigt damping burns EA eta epsdot^2 per unstretched
metre, and web that enters with another strain is pulled to the span's strain at the roller, which
burns (T (eps - eps_up) - (u - u_up)) per unstretched metre, u = EA eps^2 / 2. Nothing else.
"""

import numpy as np
import pytest
from scipy.integrate import simpson

from sim_plant.base.arrays import REWIND, UNWIND
from sim_plant.geometry.shapes import circle, eccentric
from sim_plant.geometry.tangent import Body, common_tangent
from tests.sim_plant.line.lines import declared, exact_line, with_effect

TICK_S = 1e-3
HEAVY_KG_M, HEAVY_RAD = 0.02, 0.4
SHAPES = {"unwind": (0.002, 0.7), "swrap_lead": (0.0004, -1.0), "swrap_follower": (0.0005, 1.9)}


@pytest.fixture(scope="module")
def history():
    """States at every drive tick over 0.6 s with a speed step, and torques held in each tick."""
    line = declared("euclid")
    for place, (offset, angle) in SHAPES.items():
        line = with_effect(line, "eccentric_roller", place, eccentricity_m=offset, angle_rad=angle)
    line = with_effect(
        line, "unbalanced_roller", "R6", unbalance_kg_m=HEAVY_KG_M, angle_rad=HEAVY_RAD
    )
    run = exact_line(line, sample_time_s=TICK_S, settle_s=4.0, substeps=2)
    states, torques = [run.state.y.copy()], []
    for _ in range(600):
        run.step({"line_speed_ref_m_s": 1.1})
        states.append(run.state.y.copy())
        torques.append(run.state.torque_N_m.copy())
    return run, np.array(states), np.array(torques)


def arms_and_flow(run, theta, omega):
    """p_A, p_B, length and ldot_A of every span at every tick, (ticks, spans) each."""
    rollers = run.declaration.rollers
    bodies = []
    for k, roller in enumerate(rollers):
        radius = float(run.arrays.bodies["radius_m"][k])
        shape = (
            eccentric(radius, *SHAPES[roller.name]) if roller.name in SHAPES else circle(radius)
        )
        bodies.append(
            Body(
                center_x_m=roller.center_x_m,
                center_y_m=roller.center_y_m,
                rotation=1 if roller.rotation == "ccw" else -1,
                shape=shape,
            )
        )
    spans = [
        common_tangent(
            bodies[i], bodies[i + 1], theta[:, i], theta[:, i + 1], omega[:, i], omega[:, i + 1]
        )
        for i in range(len(rollers) - 1)
    ]
    return (
        np.column_stack([span.arm_a_m for span in spans]),
        np.column_stack([span.arm_b_m for span in spans]),
        np.column_stack([span.length_m for span in spans]),
        np.column_stack([span.flow_a_m_s for span in spans]),
        np.column_stack([span.flow_b_m_s for span in spans]),
    )


def split(run, states):
    lay = run.layout
    theta = states[:, lay.theta : lay.theta + lay.n]
    omega = states[:, lay.omega : lay.omega + lay.n]
    return theta, omega, states[:, lay.strain : lay.strain + lay.n - 1]


def total(power):
    """Integral over the run of a power sampled at ticks, J, summed over bodies or spans."""
    return float(np.sum(simpson(power, dx=TICK_S, axis=0)))


def inertias(run):
    """J of every body with the wound web, kg m2 [source 2.4]."""
    web, bodies = run.declaration.web, run.arrays.bodies
    inertia = bodies["inertia_kg_m2"].copy()
    for k in np.flatnonzero((bodies["kind"] == UNWIND) | (bodies["kind"] == REWIND)):
        ring = bodies["radius_m"][k] ** 4 - run.declaration.initial_radii_m.core**4
        inertia[k] += 0.5 * np.pi * web.density_kg_m3 * web.width_m * ring
    return inertia


def test_energy_balance_closes(history):
    run, states, torques = history
    theta, omega, strain = split(run, states)
    web, bodies = run.declaration.web, run.arrays.bodies
    p_a, p_b, length, flow_a, flow_b = arms_and_flow(run, theta, omega)
    upstream = np.column_stack([np.full(len(strain), web.wound_in_tension_N / web.EA_N), strain])
    upstream = upstream[:, :-1]
    entering = flow_a / (1.0 + upstream)  # unstretched metres per second
    leaving = flow_b / (1.0 + strain)
    stretch = p_b * omega[:, 1:] - p_a * omega[:, :-1]
    # strain rate from the states alone would need differences; the identity gives it
    rate = (1.0 + strain) / length * (stretch - entering * (strain - upstream))
    tension = web.EA_N * (strain + web.kelvin_voigt_eta_s * rate)

    def stored(eps):
        return 0.5 * web.EA_N * eps**2

    held = length / (1.0 + strain)
    elastic = np.sum(stored(strain) * held, axis=1)
    kinetic = 0.5 * np.sum(inertias(run) * omega**2, axis=1)
    drives = run.arrays.drives["body"]
    motors = float(np.sum(torques * np.diff(theta[:, drives], axis=0)))
    friction = total(
        omega
        * (
            bodies["friction_constant_N_m"] * np.tanh(omega / 0.3)
            + bodies["friction_viscous_N_m_s"] * omega
        )
    )
    heavy, sigma = 6, float(bodies["sigma"][6])
    height = np.sin(sigma * (theta[[0, -1], heavy] + HEAVY_RAD))
    lifted = HEAVY_KG_M * 9.80665 * float(height[1] - height[0])
    viscous = total(web.EA_N * web.kelvin_voigt_eta_s * rate**2 * held)
    pulled = total(
        entering * (tension * (strain - upstream) - (stored(strain) - stored(upstream)))
    )
    carried_out = total(leaving * stored(strain)) - total(entering * stored(upstream))
    gained = kinetic[-1] - kinetic[0] + elastic[-1] - elastic[0]
    missing = motors - gained - friction - lifted - viscous - pulled - carried_out
    assert abs(lifted) > 0.05
    assert kinetic[-1] - kinetic[0] > 1.0
    assert abs(missing) < 1e-5 * abs(kinetic[-1] - kinetic[0])


def test_web_takes_exactly_the_power_that_bodies_give(history):
    """torque * speed of the kernel's own arms = tension * (p_B w_B - p_A w_A) of the geometry."""
    run, states, _torques = history
    theta, omega, _strain = split(run, states[-1:])
    p_a, p_b, *_ = arms_and_flow(run, theta, omega)
    run_contacts = run.work.contacts
    # the kernel's arms are those of its last Runge-Kutta stage, at the same instant
    assert run_contacts[:, 1] == pytest.approx(p_a[0], abs=2e-9)
    assert run_contacts[:, 2] == pytest.approx(p_b[0], abs=2e-9)
