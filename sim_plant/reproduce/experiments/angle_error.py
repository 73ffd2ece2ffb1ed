"""(5.1)-(5.3), Fig. 5.1: how far a roll's angle strays from a constant speed."""

from __future__ import annotations

import numpy as np

from sim_plant.base.arrays import Array, LineArrays
from sim_plant.reproduce.drawing import Panel, draw
from sim_plant.reproduce.entry import Experiment, Result, row_of_claim
from sim_plant.reproduce.euclid import (
    FPM_M_S,
    INCH_M,
    SWRAP_RADIUS_M,
    effect,
    nominal,
    open_euclid,
    steady,
    turned,
)

SPEED_M_S, FORGET_S, RECORD_S = 200.0 * FPM_M_S, 20.0, 80.0


def stray(angle: Array, time: Array, omega_rad_s: float) -> Array:
    """Return e_theta = theta - omega_r t from its first row."""
    error: Array = angle - angle[0] - omega_rad_s * (time - time[0])
    return error


def half_wound(arrays: LineArrays) -> LineArrays:
    """Wind the web in at half of its line strain."""
    arrays.web["supply_strain"] *= 0.5
    return arrays


def run() -> Result:
    """Measure e_theta of the S-wrap lead and of the unwind."""
    wrong = effect("eccentric_roller", "swrap_lead", eccentricity_m=0.0005, mass_kg=30.0)
    line = open_euclid(radius_m=6.375 * INCH_M, speed_m_s=SPEED_M_S, effects=(wrong,))
    record = steady(line, RECORD_S, SPEED_M_S)
    late = record["time_s"] >= FORGET_S
    time = record["time_s"][late]
    lead = turned(record["true_swrap_lead_speed_m_s"] / SWRAP_RADIUS_M, line.sample_time_s)[late]
    e_lead = stray(lead, time, SPEED_M_S / SWRAP_RADIUS_M)
    e_lead = e_lead - e_lead.mean()

    slack = open_euclid(radius_m=6.375 * INCH_M, speed_m_s=SPEED_M_S, change=half_wound)
    roll = steady(slack, RECORD_S, SPEED_M_S)
    angle = roll["true_unwind_angle_rad"][late]
    radius = roll["true_unwind_radius_m"][late]
    e_roll = stray(angle - turned(SPEED_M_S / radius, slack.sample_time_s), time, 0.0)
    strain = 0.5 * nominal().web.wound_in_tension_N / nominal().web.EA_N
    formula = strain * SPEED_M_S / radius.mean() * (time[-1] - time[0])
    panels = [
        Panel(
            curves={"S-wrap lead": (time, e_lead)},
            x="time [s]",
            y="e_theta [rad]",
            title="Fig. 5.1",
        ),
        Panel(
            curves={"unwind": (time, e_roll)},
            x="time [s]",
            y="theta - integral of v/R [rad]",
            title="wound in at half the line strain",
        ),
    ]
    peak, drift = float(np.max(np.abs(e_lead))), abs(float(e_roll[-1]))
    return Result(
        rows=(
            row_of_claim(
                "largest e_theta of the S-wrap lead",
                "0.004 rad, << 1",
                peak,
                "rad",
                peak < 0.05,
                "a speed loop holds it; 0.5 mm off centre, 30 kg",
            ),
            row_of_claim(
                "unwind: drift of theta from v/R in 60 s",
                "e_theta << 1 (5.3)",
                drift,
                "rad",
                drift < 0.05,
                f"wound-in strain half of the line's: strain difference times angle gives "
                f"{formula:.2f} rad; a law on v/R loses its phase, one on the angle does not",
            ),
        ),
        figures=(draw(panels),),
    )


EXPERIMENTS = (
    Experiment(
        identity="5.1",
        chapter=5,
        title="Is eccentricity an exogenous disturbance?",
        where="(5.1)-(5.3), Fig. 5.1",
        run=run,
    ),
)
