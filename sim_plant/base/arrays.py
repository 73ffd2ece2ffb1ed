"""The line as structured arrays: what the compiled kernel steps and what effects act on.

Every physical effect fills fields here; a field at its neutral value (0, or 1 for ratios and
gains) is exactly absent. Index letters: n bodies in web order, m = n - 1 spans, d drives,
c load cells, l loops, r torque-ripple terms, s shape tables, h parts of spans that are warm,
g carriages.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
Records = np.ndarray[Any, np.dtype[Any]]

IDLER, DRIVEN, UNWIND, REWIND = 0, 1, 2, 3
"""Values of the field ``kind`` of a body."""

DELAY_RING_TICKS = 512
"""Length of the ring buffer of corrections: the longest delay, plus one."""


def record_type(integers: str, floats: str) -> np.dtype[Any]:
    """Return a structured type with these integer and float fields, in this order."""
    return np.dtype(
        [(n, np.int64) for n in integers.split()] + [(n, np.float64) for n in floats.split()]
    )


BODY = record_type(
    # shape_row: row of the shape tables, -1 for a true circle; carriage: what moves it, or -1
    "kind shape_row carriage",
    "sigma centre_x_m centre_y_m "  # sigma: +1 counter-clockwise, -1 clockwise
    "radius_m "  # mean radius (perimeter / 2 pi) at the start
    "inertia_kg_m2 "  # rolls: core and drive only
    "friction_constant_N_m friction_viscous_N_m_s "
    "gravity_moment_N_m gravity_moment_angle_rad "  # m g e off axis, its angle
    "slip_s_m slip_speed_m_s",  # share of speed lost per m/s above slip_speed
)
SPAN = record_type(
    "heat_first heat_parts",  # its rows of heats, in web order; no part: web as it comes
    "EA_N free_strain",  # free strain (thermal, moisture) pulls nothing
)
HEAT = record_type("", "air_K time_s")  # one part of a span: surroundings, time constant
WEB = record_type(
    "",
    "viscosity_s "  # Kelvin-Voigt: T = EA (strain + viscosity * d strain/dt)
    "maxwell_ratio maxwell_time_s "  # one Maxwell branch, stiffness over EA
    "density_kg_m3 thickness_m width_m supply_strain core_radius_m "
    "bounce_mass_kg bounce_Hz bounce_damping "  # unwind on a soft mandrel, mass 0 = rigid
    "bounce_order "  # driven by unbalance of order 1 and of this order
    "bounce_cos1_kg_m bounce_sin1_kg_m bounce_cosn_kg_m bounce_sinn_kg_m "
    # web past splice_m of unstretched length differs by these ratios; 1 = the same web
    "splice_m splice_EA_ratio splice_thickness_ratio "
    # the seam, as long as splice_piece_m, lifts the web off a roller by splice_step_m
    "splice_step_m splice_piece_m "
    "expansion_1_K",  # thermal; temperatures count from that of the web on the unwind
)
DRIVE = record_type(
    "body delay_ticks loop",  # loop: tension loop that trims this drive, or -1
    "gain_rad_s damping draw "  # K_ref, zeta, reference = line speed * (1 + draw)
    "radius_ratio "  # radius the drive believes over the true one
    "limit_N_m slew_m_s2 correction_slew_m_s2 "  # slew 0 = none
    "shaft_stiffness_N_m shaft_damping_N_m_s shaft_backlash_rad "  # stiffness 0 = rigid
    "motor_share "  # share of the body's fixed inertia on the motor side
    "encoder_offset_ratio encoder_angle_rad "
    "encoder_loop_share "  # share of the eccentricity that the drive's own loop reads
    "noise_rad_s lsb_rad_s",
)
CELL = record_type(
    "body",
    "corner_Hz gain offset_N noise_N lsb_N resonance_Hz resonance_damping "
    "unbalance_kg_m unbalance_angle_rad hum_N hum_Hz hum_phase_rad",
)
LOOP = record_type(
    "cell carriage",  # a loop holds a cell's tension or, where cell is -1, a carriage's travel
    "gain_m_s_N corner_rad_s sign reference_m "  # of travel: gain in m/s per m
    "slew_m_s2",  # of its output, sample by sample; 0 = none
)
# what rollers move with: its travel, m, is 0 where the file puts them and lengthens the path
CARRIAGE = record_type(
    "pendulum",
    "axis_x axis_y "  # of a straight travel: its direction
    "pivot_x_m pivot_y_m turn_1_m "  # of an arm: angle over travel, + counter-clockwise
    "mass_kg load_N weight_N weight_x_m weight_y_m "  # weight: at this point at travel 0
    "stiffness_N_m damping_N_s_m friction_N from_m to_m "
    "gain_rad_s drive_damping limit_N speed_m_s",  # own drive, gain 0: none; its reference
)
RIPPLE = record_type("drive", "order cos_N_m sin_N_m")
# a number that changes while a line runs: what (below), whose index, by how much; it rises from
# from_s over rise_s, stays until until_s, falls as it rose; put: the part that is in force now
CHANGE = record_type("target place", "amount from_s rise_s until_s put")
CHANGEABLE = (
    "bodies.friction_constant_N_m",
    "bodies.slip_s_m",
    "bodies.inertia_kg_m2",
    "spans.free_strain",
    "spans.EA_N",
    "web.viscosity_s",
    "web.density_kg_m3",
    "web.thickness_m",
    "web.supply_strain",
    "web.expansion_1_K",
    "drives.gain_rad_s",
    "drives.damping",
    "drives.draw",
    "cells.corner_Hz",
    "cells.gain",
    "cells.offset_N",
    "loops.gain_m_s_N",
    "loops.corner_rad_s",
    "loops.reference_m",
    "heats.air_K",
    "heats.time_s",
    "carriages.speed_m_s",
    "carriages.mass_kg",
    "carriages.load_N",
    "carriages.stiffness_N_m",
    "carriages.damping_N_s_m",
    "carriages.friction_N",
)
"""Numbers that may change during a run, table and field; the field ``target`` of a change is the
index of one. What else a line is made from (radii, shapes) is read once, when the run begins."""
DRAG = CHANGEABLE.index("bodies.friction_constant_N_m")
FREE_STRAIN = CHANGEABLE.index("spans.free_strain")
SLIP = CHANGEABLE.index("bodies.slip_s_m")
TRAVEL_SPEED = CHANGEABLE.index("carriages.speed_m_s")

# noisy 0: sensors answer with their mean, a run is noise-free
TIMING = record_type("ticks_per_frame frames_per_loop substeps noisy", "drive_tick_s")


class LineArrays(NamedTuple):
    """Parameters of a line, SI. Fields may be changed in place before a run.

    During one only ``changes`` are at work, through the kernel.
    """

    bodies: Records  # (n,) BODY
    spans: Records  # (m,) SPAN
    web: Records  # (1,) WEB
    drives: Records  # (d,) DRIVE
    cells: Records  # (c,) CELL
    loops: Records  # (l,) LOOP
    ripples: Records  # (r,) RIPPLE
    changes: Records  # (e,) CHANGE
    heats: Records  # (h,) HEAT
    carriages: Records  # (g,) CARRIAGE
    timing: Records  # (1,) TIMING
    shape_h_m: Array  # (s, points + 1) support function minus mean radius
    shape_dh_m: Array
    shape_rho_m: Array  # h + h'' of the same deviation


class LineState(NamedTuple):
    """Everything that moves. ``y`` is the continuous state, see ``line/layout.py``."""

    y: Array
    phi_rad: Array  # (m,) span directions, refined from their last value
    drive_integral: Array  # (d,)
    torque_N_m: Array  # (d,)
    reference_m_s: Array  # (d,) velocity reference in force
    correction_m_s: Array  # (d,) its part from tension loop and AFF
    loop_integral: Array  # (l,)
    loop_correction_m_s: Array  # (l,)
    measured_N: Array  # (c,) latest load-cell words
    true_N: Array  # (c,) filtered tension without noise and quantisation
    measured_rad_s: Array  # (d,) latest speeds as recorded
    carriage_integral_m: Array  # (g,)
    carriage_force_N: Array  # (g,) of the carriages' own drives
    delay_m_s: Array  # (d, ticks) ring buffer of corrections
    counters: IntArray  # frame number, ring position
    time_s: Array  # (1,)


def copy_state(state: LineState) -> LineState:
    """Return an independent copy."""
    return LineState(**{name: part.copy() for name, part in state._asdict().items()})


def copy_arrays(arrays: LineArrays) -> LineArrays:
    """Return an independent copy."""
    return LineArrays(*(part.copy() for part in arrays))


def total_inertia_kg_m2(arrays: LineArrays, body: int) -> float:
    """Return the inertia of a body at the start, wound web included   [source 2.3, 2.4]."""
    record = arrays.bodies[body]
    fixed = float(record["inertia_kg_m2"])
    if int(record["kind"]) < UNWIND:
        return fixed
    web = arrays.web[0]
    ring = 0.5 * math.pi * float(web["density_kg_m3"]) * float(web["width_m"])
    return fixed + ring * float(record["radius_m"] ** 4 - web["core_radius_m"] ** 4)
