"""A line for the simulated PLC: formulas, fast enough that encoders start over within seconds."""

from __future__ import annotations

import math
from collections.abc import Mapping

SPEED_M_S = 6.0
RADIUS_M = 0.15
FOLLOWER_M = 0.15367
TENSION_N = 90.0
SECOND_N = 95.0
THIRD_N = 83.0
REWIND_M = 0.11


class VirtualLine:
    """What `tests.sim_plant.servers.served` asks of a line."""

    def __init__(self, sample_time_s: float = 0.01) -> None:
        self.sample_time_s = sample_time_s
        self.t_s = 0.0

    def step(self, inputs: Mapping[str, float]) -> Mapping[str, float]:
        self.t_s += self.sample_time_s

        def swing(amplitude: float, frequency_Hz: float) -> float:
            return amplitude * math.sin(2.0 * math.pi * frequency_Hz * self.t_s)

        return {
            "unwind_tension_N": TENSION_N + swing(1.0, 3.1),
            "pullroll_tension_N": SECOND_N + swing(0.8, 2.3),
            "tension_ref_N": TENSION_N,
            "line_speed_m_s": SPEED_M_S + swing(0.004, 4.1),
            "unwind_radius_m": RADIUS_M,
            "swrap_follower_speed_m_s": SPEED_M_S + swing(0.006, 3.3),
            "unwind_angle_rad": self.t_s * SPEED_M_S / RADIUS_M,
            "swrap_follower_angle_rad": 1.0 + self.t_s * SPEED_M_S / FOLLOWER_M,
            "true_unwind_tension_N": TENSION_N,
            "line_speed_ref_m_s": SPEED_M_S,
            "r3_tension_N": THIRD_N + swing(0.7, 2.7),
            "rewind_speed_rad_s": -SPEED_M_S / REWIND_M - swing(0.02, 3.7),
        }
