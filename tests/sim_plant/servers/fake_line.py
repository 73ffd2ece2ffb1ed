"""A line small enough to reason about: first-order tension, a turning roll, no noise."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

from aff_runtime.base.signals import StateBits
from sim_plant.servers.map_file import load_plc_map
from sim_plant.servers.plc_map import PlcMap

REPOSITORY = Path(__file__).parents[3]
DEFAULT_MAP = REPOSITORY / "config" / "plc" / "gateway_block.yaml"
RADIUS_m = 0.15
TIME_CONSTANT_s = 0.1
N_PER_m_s = 2000.0


class FakeLine:
    """Tension follows -N_PER_m_s * aff_unwind_m_s with one time constant."""

    def __init__(self, sample_time_s: float = 0.005) -> None:
        self.sample_time_s = sample_time_s
        self.inputs: dict[str, float] = {"line_speed_ref_m_s": 1.0, "tension_ref_N": 90.0}
        self._tension_N = 90.0
        self._angle_rad = 0.0

    def step(self, inputs: Mapping[str, float]) -> Mapping[str, float]:
        self.inputs.update(inputs)
        speed_m_s = self.inputs["line_speed_ref_m_s"]
        self._angle_rad += speed_m_s / RADIUS_m * self.sample_time_s
        aim_N = (
            self.inputs["tension_ref_N"]
            + 5.0 * math.sin(self._angle_rad)
            - N_PER_m_s * self.inputs.get("aff_unwind_m_s", 0.0)
        )
        self._tension_N += self.sample_time_s / TIME_CONSTANT_s * (aim_N - self._tension_N)
        return {
            "unwind_tension_N": self._tension_N,
            "pullroll_tension_N": 95.0,
            "tension_ref_N": self.inputs["tension_ref_N"],
            "line_speed_m_s": speed_m_s,
            "unwind_radius_m": RADIUS_m,
            "swrap_follower_speed_m_s": speed_m_s,
            "unwind_angle_rad": self._angle_rad,
            "swrap_follower_angle_rad": self._angle_rad,
            "true_unwind_tension_N": self._tension_N,
        }


def default_map() -> PlcMap:
    return load_plc_map(DEFAULT_MAP)


def write_block(
    heartbeat: int,
    *,
    unwind: int = 0,
    follower: int = 0,
    state: int = StateBits.ACTIVE,
    broken_complement: bool = False,
) -> list[int]:
    """The words 100..109 of docs/technician/gateway-block.md, spelled out one by one; counts."""
    return [
        heartbeat & 0xFFFF,
        int(state),
        0,
        unwind & 0xFFFF,
        (~unwind & 0xFFFF) ^ broken_complement,
        0,
        0,
        0,
        follower & 0xFFFF,
        ~follower & 0xFFFF,
    ]
