"""The campaign's line as its owner declares it: nine bodies, built from directions and lengths.

unwind - R1 - R2 (cell) - R3 - swrap (drive) - R5 (cell) - pull_roll (drive) - R7 (cell) - rewind
"""

from __future__ import annotations

import cmath
import math
from typing import Any

SAMPLE_S = 0.01
TICK_S = 0.001
EA_N = 9300.0
WOUND_N = 88.9644
CORE_M = 0.04445
DENSITY_KG_M3, THICKNESS_M, WIDTH_M = 395.0, 0.00019, 0.1524

# name, kind, radius, inertia, friction constant, friction viscous, sense
BODIES: tuple[tuple[str, str, float, float, float, float, int], ...] = (
    ("unwind", "roll", 0.0, 0.25, 0.15, 0.01, 1),
    ("R1", "idler", 0.0381, 0.0014, 0.0172, 1.43e-4, -1),
    ("R2", "idler", 0.0381, 0.0014, 0.0172, 1.43e-4, 1),
    ("R3", "idler", 0.0381, 0.0014, 0.0172, 1.43e-4, -1),
    ("swrap", "driven", 0.12, 0.2, 0.15, 0.01, 1),
    ("R5", "idler", 0.0445, 0.002, 0.0172, 1.43e-4, -1),
    ("pull_roll", "driven", 0.0762, 0.05, 0.15, 0.01, 1),
    ("R7", "idler", 0.0445, 0.002, 0.0172, 1.43e-4, -1),
    ("rewind", "roll", 0.0, 0.25, 0.15, 0.01, 1),
)
# direction of web travel (degrees) and length of every span at the radii of record a
SPANS: tuple[tuple[float, float], ...] = (
    (0.0, 1.10),
    (-100.0, 0.60),
    (0.0, 0.75),
    (-95.0, 0.70),
    (75.0, 0.80),
    (-20.0, 0.65),
    (140.0, 0.80),
    (45.0, 0.90),
)
CELLS = {"unwind_tension_N": "R2", "pullroll_tension_N": "R5", "rewind_tension_N": "R7"}
SPEEDS = {
    "unwind_speed_rad_s": "unwind",
    "line_speed_m_s": "swrap",
    "pull_roll_speed_m_s": "pull_roll",
    "rewind_speed_rad_s": "rewind",
}
ANGLES = {"unwind_angle_rad": "unwind", "swrap_angle_rad": "swrap"}
NOMINAL_RADII = (0.18, 0.15)
LOOP_SIGNS = {"unwind": -1.0, "rewind": 1.0}
CELL_SD_N, CELL_LSB_N, CELL_HZ = 0.25, 0.05, 20.0
SPEED_SD, SPEED_LSB = 5e-4, 5e-4
ANGLE_LSB, RADIUS_LSB_M = 2.0 * math.pi / 4096, 1e-5


def centres() -> list[complex]:
    """Return the roller centres: contact point to contact point along the declared spans."""
    radius = radii(NOMINAL_RADII)
    found = [0j]
    for k, (degrees, length_m) in enumerate(SPANS):
        along = cmath.rect(1.0, math.radians(degrees))
        out = -1j * along  # from a centre to where a counter-clockwise body is touched
        leave = found[k] + BODIES[k][6] * radius[k] * out
        found.append(leave + length_m * along - BODIES[k + 1][6] * radius[k + 1] * out)
    return found


def radii(rolls_m: tuple[float, float]) -> list[float]:
    """Return all radii with these radii of unwind and rewind."""
    return [rolls_m[0], *(b[2] for b in BODIES[1:-1]), rolls_m[1]]


def declaration(rolls_m: tuple[float, float] = NOMINAL_RADII) -> dict[str, Any]:
    """Return the declaration (schema web-line-declaration/1) with these roll radii."""
    radius, centre = radii(rolls_m), centres()
    spans, directions = [], []
    for k in range(len(SPANS)):
        apart = centre[k + 1] - centre[k]
        reach = BODIES[k + 1][6] * radius[k + 1] - BODIES[k][6] * radius[k]
        direction = cmath.phase(apart) - math.asin(reach / abs(apart))
        directions.append(math.degrees(direction))
        spans.append(
            {
                "start": BODIES[k][0],
                "end": BODIES[k + 1][0],
                "length_m": math.sqrt(abs(apart) ** 2 - reach**2),
                "direction_deg": directions[k],
            }
        )
    rollers = []
    for k, (name, kind, _r, inertia, constant, viscous, sense) in enumerate(BODIES):
        inner = 0 < k < len(BODIES) - 1
        wrap = sense * (directions[k] - directions[k - 1]) % 360.0 if inner else None
        rollers.append(
            {
                "name": name,
                "kind": kind,
                "radius_m": radius[k],
                "inertia_kg_m2": inertia,
                "friction_constant_N_m": constant,
                "friction_viscous_N_m_s": viscous,
                "rotation": "ccw" if sense > 0 else "cw",
                "wrap_angle_deg": wrap,
                "center_x_m": centre[k].real,
                "center_y_m": centre[k].imag,
            }
        )
    return {
        "schema": "web-line-declaration/1",
        "sample_time_s": SAMPLE_S,
        "note": "short line of the campaign",
        "units": "SI",
        "web": {
            "EA_N": EA_N,
            "density_kg_m3": DENSITY_KG_M3,
            "thickness_m": THICKNESS_M,
            "width_m": WIDTH_M,
            "kelvin_voigt_eta_s": 0.001,
            "wound_in_tension_N": WOUND_N,
        },
        "initial_radii_m": {"unwind": rolls_m[0], "rewind": rolls_m[1], "core": CORE_M},
        "rollers": rollers,
        "spans": spans,
        "friction_law": "torque = constant*tanh(speed/0.3 rad/s) + viscous*speed",
        "inertia_kg_m2": {"unwind_core_and_drive": 0.25, "rewind_core_and_drive": 0.25},
        "control": control(),
        "sensors": sensors(),
        "reference_columns": ["line_speed_ref_m_s", "tension_ref_N"],
    }


def control() -> dict[str, Any]:
    """Return the control section."""
    plus = "line_speed_ref + tension correction"
    draw = "line_speed_ref*(1 + pull_roll_draw)"
    drives = [
        ("unwind", 15.0, plus),
        ("swrap", 20.0, "line_speed_ref"),
        ("pull_roll", 40.0, draw),
        ("rewind", 15.0, plus),
    ]
    return {
        "drives": [
            {
                "roller": r,
                "K_ref_rad_s": k,
                "zeta": 1.1,
                "speed_reference": text,
                "inertia_used": "declared, with the wound web at the current radius",
            }
            for r, k, text in drives
        ],
        "drive_law": "torque = J*K_ref*(e + K_ref/(4*zeta^2)*integral(e)), "
        "e = v_ref/radius - measured speed",
        "drive_sample_time_s": TICK_S,
        "drive_torque_limit_N_m": 120.0,
        "pull_roll_draw": 0.0005,
        "tension_pi": [
            {
                "loop": "unwind",
                "acts_on": "unwind",
                "load_cell": "R2",
                "gain_m_s_per_N": 0.002284,
                "corner_rad_s": 10.0,
                "law": "v_correction = -(gain*e + gain*corner*integral(e))",
            },
            {
                "loop": "rewind",
                "acts_on": "rewind",
                "load_cell": "R7",
                "gain_m_s_per_N": 0.003426,
                "corner_rad_s": 10.0,
                "law": "v_correction = +(gain*e + gain*corner*integral(e))",
            },
        ],
        "tension_loop_sample_time_s": SAMPLE_S,
    }


def sensors() -> list[dict[str, Any]]:
    """Return the sensor section."""
    radius = {b[0]: b[2] for b in BODIES}
    found: list[dict[str, Any]] = [
        {
            "channel": c,
            "roller": r,
            "low_pass_Hz": CELL_HZ,
            "low_pass_order": 1,
            "noise_sd_N": CELL_SD_N,
            "lsb_N": CELL_LSB_N,
        }
        for c, r in CELLS.items()
    ]
    for channel, roller in SPEEDS.items():
        row: dict[str, Any] = {
            "channel": channel,
            "roller": roller,
            "noise_sd_rad_s": SPEED_SD,
            "lsb_rad_s": SPEED_LSB,
        }
        if channel.endswith("_m_s"):
            row["scale_radius_m"] = radius[roller]
        found.append(row)
    found += [
        {"channel": c, "roller": r, "lsb_rad": ANGLE_LSB, "zero": "first row"}
        for c, r in ANGLES.items()
    ]
    found.append({"channel": "unwind_radius_m", "roller": "unwind", "lsb_m": RADIUS_LSB_M})
    return found
