"""A drive shaft that twists, or a gear with play."""

from __future__ import annotations

import math
from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Form, Parameter, Value
from sim_plant.effects.beside import where_alike


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Put a spring with play between motor and body of drive ``place``.

    tau = K (twist -+ b/2) + D d twist/dt outside the play   [own; two-mass model]. The motor has
    ``motor_share`` of the inertia that turns without web, core and drive of a roll: wound web is
    on the other side of the shaft, whatever the radius. K is at most what the integration step
    resolves on an empty core, the fastest (w dt = 0.5), so a pure play has a stiff shaft behind
    it; the damping is a share of the critical one there.
    """
    compliance, play = float(parameters["compliance_rad_N_m"]), float(parameters["backlash_rad"])
    if compliance == 0.0 and play == 0.0:
        return arrays
    drive = arrays.drives[place]
    share = float(parameters["motor_share"])
    reduced = share * (1.0 - share) * float(arrays.bodies["inertia_kg_m2"][drive["body"]])
    step_s = float(arrays.timing["drive_tick_s"][0]) / float(arrays.timing["substeps"][0])
    stiffest = reduced * (0.5 / step_s) ** 2
    stiffness = stiffest if compliance == 0.0 else min(1.0 / compliance, stiffest)
    drive["motor_share"] = share
    drive["shaft_stiffness_N_m"] = stiffness
    drive["shaft_damping_N_m_s"] = (
        2.0 * float(parameters["damping"]) * math.sqrt(stiffness * reduced)
    )
    drive["shaft_backlash_rad"] = play
    return arrays


EFFECT = Effect(
    name="shaft_compliance_backlash",
    place="drive",
    candidates="drive",
    accepts={
        "compliance_rad_N_m": Parameter(
            default=0.0,
            unit="rad/(N m)",
            typical=1e-3,
            low=0.0,
            high=0.1,
            tries=(7e-4, 1.5e-3, 3e-3, 6e-3, 1.2e-2),
        ),
        "backlash_rad": Parameter(
            default=0.0, unit="rad", typical=0.002, low=0.0, high=0.1, tries=(0.0, 0.003)
        ),
        "damping": Parameter(
            default=0.05, unit="1", typical=0.05, low=0.0, high=1.0, role="shape"
        ),
        "motor_share": Parameter(
            default=0.5, unit="1", typical=0.5, low=0.05, high=0.95, role="shape"
        ),
    },
    fitted=("compliance_rad_N_m", "backlash_rad"),
    apply=apply,
    text="a drive shaft twists or has play: the motor runs ahead of its roller",
    shows=None,
    beside=where_alike(absent={"compliance_rad_N_m": 0.0, "backlash_rad": 0.0}),
    remedy=(
        "look for play in couplings, keys and gear of {place}, and for a soft coupling or a thin "
        "shaft"
    ),
    forms=(
        Form(
            strengths=("compliance_rad_N_m",),
            text="a drive shaft twists: the motor runs ahead of its roller under torque",
            remedy=(
                "look at what twists between motor and roller of {place}: coupling, shaft, belt; "
                "these records show no play"
            ),
        ),
        Form(
            strengths=("backlash_rad",),
            text="a drive has play: the motor turns before its roller does",
            remedy="look for play in couplings, keys and gear of {place}",
        ),
    ),
)
