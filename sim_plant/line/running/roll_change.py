"""Full rolls in place of used ones while the line runs, as a turret does it."""

from __future__ import annotations

import numpy as np

from sim_plant.base.arrays import UNWIND, LineArrays, LineState
from sim_plant.line.equations.layout import Layout
from sim_plant.line.equations.rolls import roll_inertia


def change_rolls(p: LineArrays, lay: Layout, s: LineState) -> None:
    """Put the radii of the start back at both ends.

    The new rims run at the web's speed, the new drives hold the old web force: speeds go with
    1/R, torques with R, and so does what a shaft is twisted beyond its play. What is in the spans
    stays.
    """
    for body_index, at in ((0, lay.radius), (lay.n - 1, lay.radius + 1)):
        body = p.bodies[body_index]
        old_m, new_m = float(s.y[at]), float(body["radius_m"])
        s.y[at] = new_m
        s.y[lay.omega + body_index] *= old_m / new_m
        for d, drive in enumerate(p.drives):
            if drive["body"] == body_index and body["kind"] >= UNWIND:
                fixed = float(body["inertia_kg_m2"])
                s.y[lay.motor + d] *= old_m / new_m
                inertias = roll_inertia(p, fixed, old_m) / roll_inertia(p, fixed, new_m)
                s.drive_integral[d] *= new_m / old_m * inertias
                s.y[lay.twist + d] = _twisted(float(s.y[lay.twist + d]), drive, new_m / old_m)


def _twisted(twist_rad: float, drive: np.void, torques: float) -> float:
    """Return the angle at which a shaft holds this share of its torque; within the play as is."""
    half_rad = 0.5 * float(drive["shaft_backlash_rad"])
    loose_rad = min(max(twist_rad, -half_rad), half_rad)
    return loose_rad + (twist_rad - loose_rad) * torques
