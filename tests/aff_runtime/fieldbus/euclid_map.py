"""The default block of docs/technician/gateway-block.md, written out once for these tests."""

from __future__ import annotations

from aff_runtime.base.signals import Command
from aff_runtime.fieldbus.modbus.registers import Correction, Register, RegisterMap, WordType

ANGLE_SCALE = 0.0015339807878856412  # 2 pi / 4096
CHANNELS = (
    Register(name="unwind_tension_N", address=2, type=WordType.I32, scale=0.001),
    Register(name="tension_ref_N", address=4, type=WordType.U16, scale=0.01),
    Register(name="line_speed_m_s", address=5, type=WordType.I16, scale=0.001),
    Register(name="unwind_radius_m", address=6, type=WordType.U16, scale=0.00002),
    Register(name="swrap_follower_speed_m_s", address=7, type=WordType.I16, scale=0.001),
    Register(name="pullroll_tension_N", address=9, type=WordType.I32, scale=0.001),
    Register(
        name="unwind_angle_rad", address=11, type=WordType.I32, scale=ANGLE_SCALE, wraps=True
    ),
    Register(
        name="swrap_follower_angle_rad",
        address=13,
        type=WordType.I32,
        scale=ANGLE_SCALE,
        wraps=True,
    ),
)


def correction(name: str, address: int, complement: int | None) -> Correction:
    register = Register(name=name, address=address, type=WordType.I16, scale=0.00001)
    return Correction(register=register, complement_address=complement)


def euclid_map(**changes: object) -> RegisterMap:
    fields: dict[str, object] = {
        "plc_heartbeat": 0,
        "status": 1,
        "roll_id": 8,
        "channels": CHANNELS,
        "aff_heartbeat": 100,
        "state": 101,
        "echo": 102,
        "alarm": 105,
        "limit": 106,
        "config_revision": 107,
        "corrections": (correction("unwind", 103, 104), correction("swrap_follower", 108, 109)),
    }
    return RegisterMap(**(fields | changes))  # type: ignore[arg-type]


def command(**changes: object) -> Command:
    fields: dict[str, object] = {
        "heartbeat": 0,
        "state_bits": 0,
        "echo": 0,
        "corrections": (0.0, 0.0),
        "alarm": 0,
        "limits": (0.05, 0.02),
        "config_revision": 0,
    }
    return Command(**(fields | changes))  # type: ignore[arg-type]
