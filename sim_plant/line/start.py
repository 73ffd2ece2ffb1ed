"""A start state near equilibrium, so that the slow pull-roll zone need not be waited for."""

from __future__ import annotations

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import LineArrays, LineState
from sim_plant.line.declaration import Declaration
from sim_plant.line.layout import Layout
from sim_plant.line.operating_point import friction_of, inertias_of, steady_line


def start_at_rest(
    line: Declaration,
    p: LineArrays,
    lay: Layout,
    state: LineState,
    line_speed_m_s: float,
    tension_N: float,
) -> None:
    """Put speeds, strains and controller integrals of the declared steady state into ``state``.

    Effects are not known here: they are left to ``LineSimulation.settle``. The state of a line
    without a single steady state stays as it is.
    """
    try:
        rest = steady_line(line, line_speed_m_s, tension_N)
    except PlantError:
        return
    n, y = lay.n, state.y
    omega = rest.speed_m_s / rest.radius_m
    y[lay.omega : lay.omega + n] = omega
    y[lay.strain : lay.strain + n - 1] = rest.strain + p.spans["free_strain"]
    pull_N = np.concatenate(([0.0], line.web.EA_N * rest.strain, [0.0]))
    friction, _slope = friction_of(line, omega)
    load = friction - rest.radius_m * (pull_N[1:] - pull_N[:-1])
    inertia = inertias_of(line, rest)
    for d, drive in enumerate(p.drives):
        k = int(drive["body"])
        corner = drive["gain_rad_s"] / (4.0 * drive["damping"] ** 2)
        state.torque_N_m[d] = load[k]
        state.drive_integral[d] = load[k] / (inertia[k] * drive["gain_rad_s"] * corner)
        y[lay.motor + d] = omega[k]
        loop = int(drive["loop"])
        if loop >= 0:
            law = p.loops[loop]
            wanted = rest.speed_m_s[k] - line_speed_m_s * (1.0 + drive["draw"])
            scale = law["sign"] * law["gain_m_s_N"] * law["corner_rad_s"]
            state.loop_integral[loop] = wanted / scale
            state.loop_correction_m_s[loop] = wanted
    for c, cell in enumerate(p.cells):
        force = 0.5 * (pull_N[int(cell["body"])] + pull_N[int(cell["body"]) + 1])
        y[lay.cell + c] = y[lay.resonance + 2 * c] = force
        state.measured_N[c] = state.true_N[c] = force
