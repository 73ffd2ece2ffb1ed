"""A driven roller without web as a record: run up at a torque, then coast down (2.27-2.33)."""

from __future__ import annotations

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.elements.load_cell import quantise
from sim_plant.elements.roller import friction_torque
from sim_plant.identify.driven_roller import Run

_SUBSTEPS = 2


def simulate_roller(
    *,
    inertia_kg_m2: float,
    constant_N_m: float,
    viscous_N_m_s: float,
    torque_N_m: Array,
    sample_time_s: float = 0.005,
    start_rad_s: float = 0.0,
) -> Run:
    """Return the exact speeds of a roller under torques held sample by sample.

    Equation: J dw/dt = tau - c tanh(w / 0.3) - b w  [source 2.32 with the smooth sign of the
    line model], classical Runge-Kutta. The roller does not turn back: it stops.
    """
    speed = np.empty(torque_N_m.size)
    speed[0] = omega = start_rad_s
    dt = sample_time_s / _SUBSTEPS
    for k in range(torque_N_m.size - 1):
        for _ in range(_SUBSTEPS):
            omega = _step(
                omega, float(torque_N_m[k]), inertia_kg_m2, constant_N_m, viscous_N_m_s, dt
            )
        omega = max(omega, 0.0)
        speed[k + 1] = omega
    return Run(sample_time_s=sample_time_s, speed_rad_s=speed, torque_N_m=torque_N_m)


def _step(
    omega: float, torque: float, inertia: float, constant: float, viscous: float, dt: float
) -> float:
    """Return the speed one Runge-Kutta step later."""
    slopes: list[float] = []
    for reach in (0.0, 0.5, 0.5, 1.0):
        trial = omega + (reach * dt * slopes[-1] if slopes else 0.0)
        slopes.append((torque - friction_torque(constant, viscous, trial)) / inertia)
    return omega + dt / 6.0 * (slopes[0] + 2.0 * (slopes[1] + slopes[2]) + slopes[3])


def with_sensor(run: Run, noise_rad_s: float, lsb_rad_s: float, seed: int) -> Run:
    """Return the run as an encoder records it: white noise, then rounding to its resolution."""
    rng = np.random.default_rng(seed)
    noisy = run.speed_rad_s + noise_rad_s * rng.standard_normal(run.speed_rad_s.size)
    speed = noisy
    if lsb_rad_s > 0.0:
        speed = np.array([quantise(float(value), lsb_rad_s) for value in noisy])
    return Run(sample_time_s=run.sample_time_s, speed_rad_s=speed, torque_N_m=run.torque_N_m)


def run_up_and_coast(torque_N_m: float, run_up_s: float, coast_s: float, dt_s: float) -> Array:
    """Return the torque column of the source's experiment: nominal torque, then none."""
    return np.concatenate(
        (np.full(round(run_up_s / dt_s), torque_N_m), np.zeros(round(coast_s / dt_s)))
    )
