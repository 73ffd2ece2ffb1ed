"""A record judged: one tension with a spectral line in web travel, gone when amended."""

import numpy as np

from sim_plant.refine.judge.holdout import Evaluation

CHANNELS = ("unwind_tension_N", "unwind_angle_rad", "unwind_radius_m", "line_speed_m_s")
STEP_S = 0.01


def judged(wavenumber_1_m=4.0):
    """One tension with a line in web travel while the speed doubles, gone when amended."""
    speed = np.where(np.arange(4000) < 2000, 1.0, 2.0)
    travel = np.cumsum(speed) * STEP_S
    measured = np.zeros((4, 4000))
    measured[0] = np.cos(2.0 * np.pi * wavenumber_1_m * travel)
    declared, amended = np.zeros((4, 4000)), measured.copy()
    return Evaluation(
        channels=CHANNELS,
        rms_declared=np.array([3.0, 900.0, 90.0, 2.0]),
        rms_amended=np.array([0.26, 1.0, 1.0, 1.0]),
        floor=np.array([0.25, 1.0, 1.0, 1.0]),
        measured=measured,
        declared=declared,
        corrected=declared,
        amended=amended,
        effects=(),
        angles_rad={},
        unwound_m={},
        first=100,
        travel_m=travel,
    )
