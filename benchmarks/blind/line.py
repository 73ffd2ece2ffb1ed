"""A drawn line of 21 bodies as its owner declares it, and what it is told to run."""

from __future__ import annotations

import cmath
import math
from typing import Any

import numpy as np

from benchmarks.blind.machine import Told
from benchmarks.blind.plant import Array
from benchmarks.blind.run import ROW_S, TICK_S

ROWS = 8000
WOUND_N = 88.9644
CORE_M = 0.04445
LAID_OUT_M = (0.16, 0.155)
"""Radii of unwind and rewind at which the line is laid out."""
WEBS = (
    {"EA_N": 9300.0, "density_kg_m3": 395.0, "thickness_m": 1.9e-4},  # Tyvek
    {"EA_N": 4000.0, "density_kg_m3": 930.0, "thickness_m": 1.0e-4},  # polyethylene
)
SIZES = {  # kind, radius m, inertia kg m2, constant and viscous friction
    "unwind": ("roll", 0.0, 0.25, 0.15, 0.01),
    "swrap_lead": ("driven", 0.15367, 0.35, 0.15, 0.01),
    "swrap_follower": ("driven", 0.15367, 0.35, 0.15, 0.01),
    "pull_roll": ("driven", 0.0762, 0.05, 0.15, 0.01),
    "rewind": ("roll", 0.0, 0.25, 0.15, 0.01),
}
IDLER = ("idler", 0.0381, 0.0014, 0.017219, 1.429e-4)
NAMES = (
    *("unwind", "R1", "R2", "R3", "R4", "R5", "R6", "R7", "R8", "R9", "swrap_lead"),
    *("swrap_follower", "R12", "R13", "R14", "R15", "pull_roll", "R17", "R18", "R19", "rewind"),
)
DIRECTIONS_DEG = (*(0.0, 260.0) * 5, 100.0, *(260.0, 0.0) * 2, 260.0, 70.0, 330.0, 70.0, 330.0)
"""Of web travel in every span; each is drawn some degrees off."""
OFF_DEG = 4.0
SENSES = tuple(1.0 if k % 2 == 0 else -1.0 for k in range(len(NAMES)))
CELLS = {
    "unwind_tension_N": "R9",
    "pullroll_tension_N": "R15",
    "r3_tension_N": "R3",
    "rewind_tension_N": "R19",
}
SPEEDS = {
    "unwind_speed_rad_s": "unwind",
    "rewind_speed_rad_s": "rewind",
    "line_speed_m_s": "swrap_lead",
    "swrap_lead_speed_m_s": "swrap_lead",
    "swrap_follower_speed_m_s": "swrap_follower",
    "pull_roll_speed_m_s": "pull_roll",
}
ANGLES = {"unwind_angle_rad": "unwind", "swrap_follower_angle_rad": "swrap_follower"}
DRIVES = {
    "unwind": (15.0, "line_speed_ref + tension correction + aff correction"),
    "swrap_lead": (20.0, "line_speed_ref"),
    "swrap_follower": (20.0, "line_speed_ref + aff correction"),
    "pull_roll": (40.0, "line_speed_ref*(1 + pull_roll_draw)"),
    "rewind": (15.0, "line_speed_ref + tension correction"),
}


def _radii(rolls: tuple[float, float]) -> list[float]:
    return [rolls[0], *(SIZES.get(name, IDLER)[1] for name in NAMES[1:-1]), rolls[1]]


def centres(rng: np.random.Generator) -> list[complex]:
    """Return where the bodies of a drawn line stand: touching point to touching point."""
    radius, found = _radii(LAID_OUT_M), [0j]
    for k, direction in enumerate(DIRECTIONS_DEG):
        low, high = {0: (1.05, 1.45), 10: (0.115, 0.15), 19: (0.95, 1.3)}.get(k, (0.38, 0.9))
        along = cmath.rect(1.0, math.radians(direction + rng.uniform(-OFF_DEG, OFF_DEG)))
        out = -1j * along  # from a centre to where a counter-clockwise body is touched
        leave = found[k] + SENSES[k] * radius[k] * out
        found.append(leave + rng.uniform(low, high) * along - SENSES[k + 1] * radius[k + 1] * out)
    return [complex(round(c.real, 5), round(c.imag, 5)) for c in found]


def declaration(
    web: dict[str, float], centre: list[complex], rolls: tuple[float, float]
) -> dict[str, Any]:
    """Return the declaration (schema web-line-declaration/1) at these radii of the rolls."""
    radius = _radii(rolls)
    direction, length = [], []
    for k in range(len(NAMES) - 1):
        apart = centre[k + 1] - centre[k]
        reach = SENSES[k + 1] * radius[k + 1] - SENSES[k] * radius[k]
        direction.append(math.degrees(cmath.phase(apart) - math.asin(reach / abs(apart))) % 360.0)
        length.append(math.sqrt(abs(apart) ** 2 - reach**2))
    rollers = []
    for k, name in enumerate(NAMES):
        kind, _radius, inertia, constant, viscous = SIZES.get(name, IDLER)
        inside = 0 < k < len(NAMES) - 1
        wrap = SENSES[k] * (direction[k] - direction[k - 1]) % 360.0 if inside else None
        rollers.append(
            {
                "name": name,
                "kind": kind,
                "radius_m": radius[k],
                "inertia_kg_m2": inertia,
                "friction_constant_N_m": constant,
                "friction_viscous_N_m_s": viscous,
                "rotation": "ccw" if SENSES[k] > 0 else "cw",
                "wrap_angle_deg": wrap if wrap is None else round(wrap, 3),
                "center_x_m": centre[k].real,
                "center_y_m": centre[k].imag,
            }
        )
    spans = [
        {
            "start": NAMES[k],
            "end": NAMES[k + 1],
            "length_m": round(length[k], 5),
            "direction_deg": round(direction[k], 4),
        }
        for k in range(len(length))
    ]
    return {
        "schema": "web-line-declaration/1",
        "sample_time_s": ROW_S,
        "samples": ROWS,
        "units": "SI; angles in degrees where the key says so; x right, y up",
        "web": {
            **web,
            "width_m": 0.1524,
            "kelvin_voigt_eta_s": 0.001,
            "wound_in_tension_N": WOUND_N,
        },
        "initial_radii_m": {"unwind": rolls[0], "rewind": rolls[1], "core": CORE_M},
        "rollers": rollers,
        "spans": spans,
        "friction_law": "torque = constant*tanh(speed/0.3 rad/s) + viscous*speed",
        "inertia_kg_m2": {"unwind_core_and_drive": 0.25, "rewind_core_and_drive": 0.25},
        "control": _control(),
        "sensors": _sensors(),
        "reference_columns": ["line_speed_ref_m_s", "tension_ref_N", "aff_correction_m_s"],
    }


def _control() -> dict[str, Any]:
    signs = {"unwind": ("-", "R9", 0.002284059), "rewind": ("+", "R19", 0.003426088)}
    return {
        "drives": [
            {
                "roller": roller,
                "K_ref_rad_s": gain,
                "zeta": 1.1,
                "speed_reference": text,
                "inertia_used": "roller inertia; of a roll core, drive and web at its radius",
            }
            for roller, (gain, text) in DRIVES.items()
        ],
        "drive_law": "torque = J*K_ref*(e + K_ref/(4*zeta^2)*integral(e)), "
        "e = v_ref/radius - measured speed",
        "drive_sample_time_s": TICK_S,
        "drive_torque_limit_N_m": 120.0,
        "pull_roll_draw": 0.0005,
        "tension_pi": [
            {
                "loop": loop,
                "acts_on": loop,
                "load_cell": cell,
                "gain_m_s_per_N": gain,
                "corner_rad_s": 10.0,
                "law": f"v_correction = {sign}(gain*e + gain*corner*integral(e)), "
                "e = tension_ref - tension",
            }
            for loop, (sign, cell, gain) in signs.items()
        ],
        "tension_loop_sample_time_s": ROW_S,
    }


def _sensors() -> list[dict[str, Any]]:
    cell = {"low_pass_Hz": 20.0, "low_pass_order": 1, "noise_sd_N": 0.25, "lsb_N": 0.05}
    rows: list[dict[str, Any]] = [
        {"channel": channel, "roller": roller, **cell} for channel, roller in CELLS.items()
    ]
    for channel, roller in SPEEDS.items():
        row = {"channel": channel, "roller": roller, "noise_sd_rad_s": 0.0005, "lsb_rad_s": 0.002}
        scale = {"scale_radius_m": SIZES[roller][1]} if channel.endswith("_m_s") else {}
        rows.append({**row, **scale})
    for channel, roller in ANGLES.items():
        rows.append(
            {"channel": channel, "roller": roller, "lsb_rad": 0.001533981, "zero": "first row"}
        )
    rows.append({"channel": "unwind_radius_m", "roller": "unwind", "lsb_m": 1e-5})
    return rows


def told(rng: np.random.Generator) -> Told:
    """Return plateaus of speed with ramps between, and steps and ramps of tension."""
    end = ROWS * ROW_S
    time_s = ROW_S * np.arange(ROWS + 1)
    speed = _plateaus(rng, end, (0.45, 1.45), 0.25, (0.08, 0.17))
    tension = _plateaus(rng, end, (78.0, 101.0), 4.0, (), first=WOUND_N)
    return Told(
        speed_m_s=np.round(np.interp(time_s, *speed), 6),
        tension_N=np.round(np.interp(time_s[:-1], *tension), 3),
    )


def _plateaus(
    rng: np.random.Generator,
    end_s: float,
    between: tuple[float, float],
    least_step: float,
    rates: tuple[float, ...],
    first: float | None = None,
) -> tuple[Array, Array]:
    """Return knots of levels that are held for some seconds; without rates steps take a time."""
    level = rng.uniform(*between) if first is None else first
    times, levels, at = [0.0], [level], rng.uniform(2.0, 6.5)
    while at < end_s:
        wanted = rng.uniform(*between)
        if abs(wanted - level) < least_step:
            continue
        if rates:
            way = abs(wanted - level) / rng.uniform(rates[0], rates[1])
        else:
            way = float(rng.choice([0.05, 0.4, 1.7]))
        times += [at, at + way]
        levels += [level, wanted]
        level, at = wanted, at + way + rng.uniform(5.5, 11.5)
    return np.array(times), np.array(levels)
