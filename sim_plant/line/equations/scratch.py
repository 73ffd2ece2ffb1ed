"""The kernel's scratch memory, with what stands still in a line already in it."""

from __future__ import annotations

import math

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import UNWIND, Array, LineArrays, LineState
from sim_plant.line.equations.kernel import CONTACT_COLUMNS, Work
from sim_plant.line.equations.layout import Layout
from sim_plant.line.equations.moved_bodies import apart


def make_work(p: LineArrays, lay: Layout, state: LineState) -> Work:
    """Return scratch memory with the contact data of spans that do not move already in place.

    Raises
    ------
    PlantError
        When two bodies leave no room for the span between them.
    """
    spans = lay.n - 1
    moving = np.zeros(spans)
    for i in range(spans):
        ends = p.bodies[i : i + 2]
        rolls = np.any(ends["kind"] >= UNWIND) or np.any(ends["carriage"] >= 0)
        moving[i] = float(rolls or np.any(ends["shape_row"] >= 0))
    contacts = np.zeros((spans, CONTACT_COLUMNS))
    for i in range(spans):
        dx, dy = apart(p, lay, state.y, i)
        reach = (
            p.bodies["sigma"][i + 1] * p.bodies["radius_m"][i + 1]
            - p.bodies["sigma"][i] * p.bodies["radius_m"][i]
        )
        if not dx * dx + dy * dy > reach * reach:
            radii = p.bodies["radius_m"][i], p.bodies["radius_m"][i + 1]
            raise PlantError(
                f"no room for span {i}: its bodies of radius {radii[0]:.4g} m and "
                f"{radii[1]:.4g} m stand {math.hypot(dx, dy):.4g} m apart; correct the radii or "
                "the centres"
            )
        contacts[i, 0] = math.sqrt(dx * dx + dy * dy - reach * reach)
        contacts[i, 1], contacts[i, 2] = p.bodies["radius_m"][i], p.bodies["radius_m"][i + 1]
        # exact direction of the common tangent: n.(C_B - C_A) = -reach
        state.phi_rad[i] = math.atan2(dy, dx) - math.asin(reach / math.hypot(dx, dy))
    strain = state.y[lay.strain : lay.strain + spans]
    free = p.spans["free_strain"] + p.web["expansion_1_K"] * mean_warming(p, lay, state.y)
    return Work(
        moving=moving,
        contacts=contacts,
        tensions=np.maximum(0.0, p.spans["EA_N"] * (strain - free)),
        rates=np.zeros((4, lay.size)),
        trial=np.zeros(lay.size),
    )


def mean_warming(p: LineArrays, lay: Layout, y: Array) -> Array:
    """Return the mean warming of the web in every span, K (n - 1,)."""
    first, parts = p.spans["heat_first"], p.spans["heat_parts"]
    found = np.zeros(lay.n - 1)
    for i in np.flatnonzero(parts):
        at = lay.heat + first[i]
        found[i] = np.mean(y[at : at + parts[i]])
    return found
