"""Power in = power stored + power lost, where a dancer swings and an accumulator is filled.

Beside drives, bearings, stretch, damping and pulled web (``test_energy``), carriages take the
power of their loads, drives, weights and friction, and store M s'^2 / 2. What moving centres do
to the web comes from drawings of circles here: dL/dt = d.C' + reach phidot with C the vector from
centre to centre and reach = sigma_B r_B - sigma_A r_A, and web passes a contact that moves round
its roller with r (w - sigma phidot).
"""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import simpson

from sim_plant.base.arrays import REWIND, UNWIND
from sim_plant.elements.carriage import CREEP_M_S
from tests.sim_plant.line.bodies import circles, coater, declared_anew, exact_coater

TICK_S = 1e-3
ARM_M, PIVOT = 0.5, 0.58 + 0.4j
DANCER_N = (70.0 / ARM_M, 20.0 / ARM_M**2, 0.25 / ARM_M)
"""Load, damping and friction of the dancer along the circle of its roller."""
ACCUMULATOR_N = (750.0, 200.0, 5.0)
WEIGHT_N = (40.0, 40.0 * 9.80665)
MASS_KG = (1.5 / ARM_M**2, 40.0)


@dataclass
class History:
    """States (ticks, n) at every drive tick; torques and forces held from tick to tick."""

    run: object
    states: np.ndarray
    torques: np.ndarray
    forces: np.ndarray


@pytest.fixture(scope="module")
def history():
    """0.8 s of a cold line: the accumulator begins to fill, the line goes faster."""
    run = exact_coater(declared_anew(coater(), heated_spans=()), sample_time_s=TICK_S, substeps=2)
    states, torques, forces = [run.state.y.copy()], [], []
    for _ in range(800):
        run.step({"line_speed_ref_m_s": 2.1, "travel_accumulator_m_s": 0.15})
        states.append(run.state.y.copy())
        torques.append(run.state.torque_N_m.copy())
        forces.append(run.state.carriage_force_N.copy())
    return History(run, np.array(states), np.array(torques), np.array(forces))


def total(power):
    """Integral over the run of a power at ticks, J, summed over bodies, spans or carriages."""
    return float(np.sum(simpson(power, dx=TICK_S, axis=0)))


def moving_centres(run, centres, speeds):
    """Speed of every centre (bodies,), complex m/s, of travel speeds (carriages,)."""
    names = [roller.name for roller in run.declaration.rollers]
    found = np.zeros(len(names), dtype=complex)
    round_pivot = -1.0 if run.declaration.carriages[0].rotation == "cw" else 1.0
    at = names.index("D1")
    found[at] = 1j * round_pivot * (centres[at] - PIVOT) / ARM_M * speeds[0]
    for name in ("A1", "A3"):
        found[names.index(name)] = 1j * speeds[1]
    return found


@dataclass
class Drawn:
    """Of every span at every tick (ticks, spans); ``centres`` (ticks, bodies)."""

    length: np.ndarray
    stretch: np.ndarray
    entering: np.ndarray
    leaving: np.ndarray
    centres: np.ndarray


def drawn(history):
    run, lay = history.run, history.run.layout
    sigma, radius = run.arrays.bodies["sigma"], run.arrays.bodies["radius_m"].copy()
    rows = []
    for y in history.states:
        length, phi, centres = circles(run, y)
        radius[[0, -1]] = y[lay.radius : lay.radius + 2]
        omega = y[lay.omega : lay.omega + lay.n]
        moved = np.diff(moving_centres(run, centres, y[lay.carriage + 1 : lay.carriage + 4 : 2]))
        along, across = np.exp(1j * phi), -1j * np.exp(1j * phi)
        phidot = -np.real(moved * np.conj(across)) / length
        flow_a = radius[:-1] * (omega[:-1] - sigma[:-1] * phidot)
        flow_b = radius[1:] * (omega[1:] - sigma[1:] * phidot)
        stretch = np.diff(radius * omega) + np.real(moved * np.conj(along))
        rows.append((length, stretch, flow_a, flow_b, centres))
    return Drawn(*(np.array([row[k] for row in rows]) for k in range(5)))


def inertias(run):
    """J of every body with the wound web, kg m2 [source 2.4]."""
    web, bodies = run.declaration.web, run.arrays.bodies
    found = bodies["inertia_kg_m2"].copy()
    for k in np.flatnonzero((bodies["kind"] == UNWIND) | (bodies["kind"] == REWIND)):
        ring = bodies["radius_m"][k] ** 4 - run.declaration.initial_radii_m.core**4
        found[k] += 0.5 * np.pi * web.density_kg_m3 * web.width_m * ring
    return found


def into_carriages(history, centres):
    """Work of loads, drives and weights less friction, J, and what the carriages hold more."""
    run, lay = history.run, history.run.layout
    names = [roller.name for roller in run.declaration.rollers]
    travel = history.states[:, [lay.carriage, lay.carriage + 2]]
    speed = history.states[:, [lay.carriage + 1, lay.carriage + 3]]
    load, damping, friction = np.array([DANCER_N, ACCUMULATOR_N]).T
    ends = travel[-1] - travel[0]
    lifted = np.array(
        [np.imag(centres[-1, names.index(n)] - centres[0, names.index(n)]) for n in ("D1", "A1")]
    )
    work = float(load @ ends + np.sum(history.forces * np.diff(travel, axis=0)))
    work -= float(np.array(WEIGHT_N) @ lifted)
    lost = total(speed * (friction * np.tanh(speed / CREEP_M_S) + damping * speed))
    gained = 0.5 * float(np.array(MASS_KG) @ (speed[-1] ** 2 - speed[0] ** 2))
    return work - lost, gained


def test_energy_balance_closes_where_rollers_are_carried(history):
    run, lay, web = history.run, history.run.layout, history.run.declaration.web
    theta = history.states[:, lay.theta : lay.theta + lay.n]
    omega = history.states[:, lay.omega : lay.omega + lay.n]
    strain = history.states[:, lay.strain : lay.strain + lay.n - 1]
    spans = drawn(history)
    wound_in = np.full((len(strain), 1), web.wound_in_tension_N / web.EA_N)
    upstream = np.hstack([wound_in, strain[:, :-1]])
    entering, leaving = spans.entering / (1.0 + upstream), spans.leaving / (1.0 + strain)
    rate = (1.0 + strain) / spans.length * (spans.stretch - entering * (strain - upstream))
    tension = web.EA_N * (strain + web.kelvin_voigt_eta_s * rate)

    def stored(eps):
        return 0.5 * web.EA_N * eps**2

    held = spans.length / (1.0 + strain)
    elastic = np.sum(stored(strain) * held, axis=1)
    kinetic = 0.5 * np.sum(inertias(run) * omega**2, axis=1)
    bodies, drives = run.arrays.bodies, run.arrays.drives["body"]
    motors = float(np.sum(history.torques * np.diff(theta[:, drives], axis=0)))
    constant, viscous = bodies["friction_constant_N_m"], bodies["friction_viscous_N_m_s"]
    bearings = total(omega * (constant * np.tanh(omega / 0.3) + viscous * omega))
    damped = total(web.EA_N * web.kelvin_voigt_eta_s * rate**2 * held)
    pulled = total(
        entering * (tension * (strain - upstream) - (stored(strain) - stored(upstream)))
    )
    carried_out = total(leaving * stored(strain)) - total(entering * stored(upstream))
    given, carriages = into_carriages(history, spans.centres)
    gained = kinetic[-1] - kinetic[0] + elastic[-1] - elastic[0] + carriages
    missing = motors + given - gained - bearings - damped - pulled - carried_out
    assert carriages > 0.1
    assert abs(given) > 1.0
    assert abs(missing) < 1e-5 * abs(kinetic[-1] - kinetic[0])
