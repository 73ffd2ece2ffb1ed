"""What a roll adds to its span in one turn, by the source's formulas and exactly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.geometry.shapes import Shape, circle
from sim_plant.geometry.source_flow import exit_distance_m, web_supply_m_s
from sim_plant.geometry.tangent import Body, common_tangent

POINTS = 4096


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Supply:
    """Curves over one turn of the roll at 1 rad/s, m/s (that is m/rad), shape (POINTS,).

    peripheral : d_ex - dL/dt, the model of section 4.3. arc_length : dl/dt - dL/dt (4.46).
    exact : p. flow, length_rate, exit_distance : the terms they are made of.
    """

    theta_rad: Array
    exact: Array
    arc_length: Array
    peripheral: Array
    flow: Array
    length_rate: Array
    exit_distance: Array

    def harmonic_error(self, curve: Array, order: int) -> float:
        """Return |c_n - p_n| / |p_n|."""
        wanted = np.fft.rfft(self.exact)[order]
        return float(abs(np.fft.rfft(curve)[order] - wanted) / abs(wanted))

    def total_error(self, curve: Array) -> float:
        """Return the rms error over the rms oscillation of p."""
        return float(np.std(curve - self.exact) / np.std(self.exact))


def supply_of(shape: Shape, idler_radius_m: float, length_m: float) -> Supply:
    """Return the curves for a crossed span of this length to an idler."""
    across = shape.mean_radius_m + idler_radius_m
    theta = 2.0 * np.pi * np.arange(POINTS) / POINTS
    roll = Body(center_x_m=0.0, center_y_m=0.0, rotation=1, shape=shape)
    idler = Body(
        center_x_m=float(np.hypot(length_m, across)),
        center_y_m=0.0,
        rotation=-1,
        shape=circle(idler_radius_m),
    )
    t = common_tangent(roll, idler, theta, 0.0, 1.0, 0.0)
    _, slope, _ = shape.evaluate(t.psi_a_rad)
    distance = exit_distance_m(t.arm_a_m, slope)
    return Supply(
        theta_rad=theta,
        exact=t.arm_a_m,
        flow=t.flow_a_m_s,
        length_rate=t.length_rate_m_s,
        exit_distance=distance,
        peripheral=distance - t.length_rate_m_s,
        arc_length=web_supply_m_s(
            t.flow_a_m_s, t.length_rate_m_s, t.phi_rate_rad_s, idler_radius_m, -1, wander=False
        ),
    )
