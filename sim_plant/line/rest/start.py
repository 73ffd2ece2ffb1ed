"""A start state at equilibrium, so that the slow pull-roll zone need not be waited for."""

from __future__ import annotations

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import UNWIND, Array, IntArray, LineArrays, LineState
from sim_plant.elements.material_roll import wound_inertia
from sim_plant.line.equations.layout import Layout
from sim_plant.line.rest.operating_point import RestingLine, SteadyLine, friction_at, steady_state
from sim_plant.line.rest.resting_bodies import RestingBodies, carriage_forces

LARGEST_STRAIN = 0.1


def start_at_rest(
    p: LineArrays, lay: Layout, state: LineState, line_speed_m_s: float, tension_N: float
) -> None:
    """Put speeds, strains and controller integrals of the steady state into ``state``.

    With all that corrections and effects have put into ``p`` and that stands still; what turns or
    relaxes is left to ``LineSimulation.settle``. The state of a line without a single steady
    state, or with one that no web survives, stays as it is.
    """
    line = resting_line(p, lay, state)
    try:
        rest = steady_state(line, line_speed_m_s, tension_N)
    except PlantError:
        return
    if not np.max(np.abs(rest.strain)) < LARGEST_STRAIN:
        return
    n, y = lay.n, state.y
    omega = rest.speed_m_s / rest.radius_m
    y[lay.omega : lay.omega + n] = omega
    y[lay.strain : lay.strain + n - 1] = rest.strain
    y[lay.heat :] = rest.parts_K
    span_N = line.EA_N * (rest.strain - line.free_strain - rest.warm_strain)
    pull_N = np.concatenate(([0.0], span_N, [0.0]))
    if line.bodies is not None and p.carriages.size:
        _rest_carriages(
            p, lay, state, rest, carriage_forces(line.bodies, line.radius_m, rest.travel_m, span_N)
        )
    friction, _slope = friction_at(line.friction_constant_N_m, line.friction_viscous_N_m_s, omega)
    load = friction - rest.radius_m * (pull_N[1:] - pull_N[:-1])
    declared_radii_m = _radii(p, lay, state)
    for d, drive in enumerate(p.drives):
        k = int(drive["body"])
        state.torque_N_m[d] = load[k]
        state.drive_integral[d] = load[k] / _integral_gain(p, d, declared_radii_m[k])
        y[lay.motor + d] = omega[k]
        loop = int(drive["loop"])
        if loop >= 0:
            law = p.loops[loop]
            reference = omega[k] * declared_radii_m[k] * drive["radius_ratio"]
            wanted = reference - line_speed_m_s * (1.0 + drive["draw"])
            scale = law["sign"] * law["gain_m_s_N"] * law["corner_rad_s"]
            state.loop_integral[loop] = wanted / scale
            state.loop_correction_m_s[loop] = state.correction_m_s[d] = wanted
    for c, cell in enumerate(p.cells):
        force = 0.5 * (pull_N[int(cell["body"])] + pull_N[int(cell["body"]) + 1])
        y[lay.cell + c] = y[lay.resonance + 2 * c] = force
        state.true_N[c] = state.measured_N[c] = cell["gain"] * force + cell["offset_N"]


def add_torque(p: LineArrays, lay: Layout, state: LineState, drive: int, tension_N: float) -> None:
    """Let the integral of a drive hold the torque of a tension at its roller's rim more."""
    radius_m = float(_radii(p, lay, state)[int(p.drives["body"][drive])])
    state.drive_integral[drive] += tension_N * radius_m / _integral_gain(p, drive, radius_m)


def resting_line(p: LineArrays, lay: Layout, state: LineState) -> RestingLine:
    """Return the numbers that decide where the line of these arrays rests."""
    declared_radii_m = _radii(p, lay, state)
    effective_radii_m = declared_radii_m.copy()
    for k, row in enumerate(p.bodies["shape_row"]):
        if row >= 0:
            effective_radii_m[k] += float(np.mean(p.shape_h_m[row, :-1]))
    driven, ratio = p.drives["body"].copy(), 1.0 + p.drives["draw"]
    acts_on = np.array(
        [int(d["body"]) for loop in range(p.loops.size) for d in p.drives if d["loop"] == loop],
        dtype=np.int64,
    )
    of_tension = p.loops["cell"] >= 0
    cells = p.cells[p.loops["cell"][of_tension]]
    return RestingLine(
        radius_m=effective_radii_m,
        friction_constant_N_m=p.bodies["friction_constant_N_m"].copy(),
        friction_viscous_N_m_s=p.bodies["friction_viscous_N_m_s"].copy(),
        slip_s_m=p.bodies["slip_s_m"].copy(),
        slip_speed_m_s=p.bodies["slip_speed_m_s"].copy(),
        EA_N=p.spans["EA_N"].copy(),
        free_strain=p.spans["free_strain"].copy(),
        supply_strain=float(p.web["supply_strain"][0]),
        driven=driven,
        ratio=ratio
        * effective_radii_m[driven]
        / (declared_radii_m[driven] * p.drives["radius_ratio"]),
        cell=cells["body"].copy(),
        acts_on=acts_on[of_tension],
        gain=cells["gain"].copy(),
        offset_N=cells["offset_N"].copy(),
        bodies=_resting_bodies(p, acts_on),
    )


def _resting_bodies(p: LineArrays, acts_on: IntArray) -> RestingBodies | None:
    """Return what of a line moves rollers or warms the web; None without."""
    if not p.carriages.size and not p.heats.size:
        return None
    of_travel = p.loops["carriage"] >= 0
    return RestingBodies(
        centre_m=np.column_stack((p.bodies["centre_x_m"], p.bodies["centre_y_m"])),
        sigma=p.bodies["sigma"].copy(),
        carriage=p.bodies["carriage"].copy(),
        carriages=p.carriages.copy(),
        acts_on=acts_on[of_travel],
        held=p.loops["carriage"][of_travel],
        reference_m=p.loops["reference_m"][of_travel],
        heats=p.heats.copy(),
        first=p.spans["heat_first"].copy(),
        parts=p.spans["heat_parts"].copy(),
        expansion_1_K=float(p.web["expansion_1_K"][0]),
    )


def _rest_carriages(
    p: LineArrays, lay: Layout, state: LineState, rest: SteadyLine, left_N: Array
) -> None:
    """Put carriages where they rest; one with a drive of its own is held by it."""
    for c, carriage in enumerate(p.carriages):
        at = lay.carriage + 2 * c
        state.y[at], state.y[at + 1] = rest.travel_m[c], 0.0
        if carriage["gain_rad_s"] > 0.0:
            gain = carriage["gain_rad_s"]
            corner = gain / (4.0 * carriage["drive_damping"] ** 2)
            state.carriage_force_N[c] = -left_N[c]
            state.carriage_integral_m[c] = -left_N[c] / (carriage["mass_kg"] * gain * corner)


def _radii(p: LineArrays, lay: Layout, state: LineState) -> Array:
    """Return the mean radius that every drive goes by, m (n,)."""
    radius: Array = p.bodies["radius_m"].copy()
    radius[0], radius[-1] = state.y[lay.radius : lay.radius + 2]
    return radius


def _integral_gain(p: LineArrays, drive: int, radius_m: float) -> float:
    """Return the torque of a drive per unit of its integral, N m / rad."""
    row = p.drives[drive]
    corner = float(row["gain_rad_s"]) / (4.0 * float(row["damping"]) ** 2)
    return _inertia(p, int(row["body"]), radius_m) * float(row["gain_rad_s"]) * corner


def _inertia(p: LineArrays, k: int, radius_m: float) -> float:
    """Return the inertia that the drive of body ``k`` reckons with, wound web included, kg m2."""
    body, web = p.bodies[k], p.web[0]
    fixed = float(body["inertia_kg_m2"])
    if body["kind"] < UNWIND:
        return fixed
    wound = (web["density_kg_m3"], web["width_m"], radius_m, web["core_radius_m"])
    return fixed + wound_inertia(*(float(x) for x in wound))
