"""From a declaration to flat arrays and a start state."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import (
    BODY,
    CELL,
    DELAY_RING_TICKS,
    DRIVE,
    DRIVEN,
    IDLER,
    LOOP,
    REWIND,
    RIPPLE,
    SPAN,
    TIMING,
    UNWIND,
    WEB,
    LineArrays,
    LineState,
    Records,
)
from sim_plant.line.arrays.build_bodies import carriages_of, heats_of, moves_of
from sim_plant.line.declared.declaration import Declaration, DriveSpeed, LoadCell
from sim_plant.line.declared.laws import draws, sign_of
from sim_plant.line.equations.layout import Layout, layout_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Timing:
    """Whole-number time grid: drive tick, ticks per frame, frames per control sample and loop."""

    drive_tick_s: float
    ticks_per_frame: int
    frames_per_sample: int
    frames_per_loop: int


def timing_of(declaration: Declaration, sample_time_s: float) -> Timing:
    """Return the grid for a control sample time; PlantError when the periods do not divide."""
    tick = declaration.control.drive_sample_time_s
    sample = sample_time_s / tick
    loop = declaration.control.tension_loop_sample_time_s / tick
    if abs(sample - round(sample)) > 1e-6 or round(sample) < 1:
        raise PlantError(f"sample time {sample_time_s} s is not a multiple of {tick} s")
    frame = math.gcd(round(sample), round(loop))
    return Timing(
        drive_tick_s=tick,
        ticks_per_frame=frame,
        frames_per_sample=round(sample) // frame,
        frames_per_loop=round(loop) // frame,
    )


def cell_sensors(declaration: Declaration) -> list[LoadCell]:
    """Return the load-cell channels, in the order of the kernel's cells."""
    return [s for s in declaration.sensors if isinstance(s, LoadCell)]


def build_arrays(declaration: Declaration, timing: Timing, substeps: int = 1) -> LineArrays:
    """Return the nominal line: no effects, every effect field neutral."""
    spans = np.zeros(len(declaration.spans), SPAN)
    spans["EA_N"] = declaration.web.EA_N
    heats, spans["heat_first"], spans["heat_parts"] = heats_of(declaration)
    return LineArrays(
        bodies=_bodies(declaration),
        spans=spans,
        web=_web(declaration),
        drives=_drives(declaration),
        cells=_cells(declaration),
        loops=_loops(declaration),
        ripples=np.zeros(0, RIPPLE),
        changes=moves_of(declaration),
        heats=heats,
        carriages=carriages_of(declaration),
        timing=np.array(
            [(timing.ticks_per_frame, timing.frames_per_loop, substeps, 1, timing.drive_tick_s)],
            TIMING,
        ),
        shape_h_m=np.zeros((1, 9)),
        shape_dh_m=np.zeros((1, 9)),
        shape_rho_m=np.zeros((1, 9)),
    )


def _bodies(declaration: Declaration) -> Records:
    rollers = declaration.rollers
    bodies = np.zeros(len(rollers), BODY)
    for body, roller in zip(bodies, rollers, strict=True):
        body["kind"] = IDLER if roller.kind == "idler" else DRIVEN
        body["shape_row"], body["carriage"] = -1, declaration.carriage_of(roller.name)
        body["sigma"] = 1.0 if roller.rotation == "ccw" else -1.0
        body["centre_x_m"], body["centre_y_m"] = roller.center_x_m, roller.center_y_m
        body["radius_m"] = roller.radius_m
        body["inertia_kg_m2"] = roller.inertia_kg_m2
        body["friction_constant_N_m"] = roller.friction_constant_N_m
        body["friction_viscous_N_m_s"] = roller.friction_viscous_N_m_s
    radii, core = declaration.initial_radii_m, declaration.inertia_kg_m2
    bodies["kind"][0], bodies["kind"][-1] = UNWIND, REWIND
    bodies["radius_m"][0], bodies["radius_m"][-1] = radii.unwind, radii.rewind
    bodies["inertia_kg_m2"][0] = core.unwind_core_and_drive
    bodies["inertia_kg_m2"][-1] = core.rewind_core_and_drive
    return bodies


def _web(declaration: Declaration) -> Records:
    web = np.zeros(1, WEB)
    given = declaration.web
    web["viscosity_s"] = given.kelvin_voigt_eta_s
    web["maxwell_time_s"] = 1.0
    web["density_kg_m3"] = given.density_kg_m3
    web["thickness_m"] = given.thickness_m
    web["width_m"] = given.width_m
    web["supply_strain"] = given.wound_in_tension_N / given.EA_N
    web["core_radius_m"] = declaration.initial_radii_m.core
    web["bounce_Hz"], web["bounce_damping"], web["bounce_order"] = 1.0, 0.05, 1.0
    web["splice_EA_ratio"], web["splice_thickness_ratio"] = 1.0, 1.0
    web["splice_piece_m"] = 1.0
    web["expansion_1_K"] = given.thermal_expansion_1_K
    return web


def _drives(declaration: Declaration) -> Records:
    control = declaration.control
    loops = [loop.acts_on for loop in control.tension_pi]
    loops += [loop.acts_on for loop in control.position_pi]
    trims = {roller: number for number, roller in enumerate(loops)}
    noise, lsb = _encoder(declaration)
    drives = np.zeros(len(control.drives), DRIVE)
    for drive, given in zip(drives, control.drives, strict=True):
        drive["body"] = declaration.body(given.roller)
        drive["loop"] = trims.get(given.roller, -1)
        drive["gain_rad_s"], drive["damping"] = given.K_ref_rad_s, given.zeta
        drive["draw"] = control.pull_roll_draw if draws(given.speed_reference) else 0.0
        drive["radius_ratio"] = 1.0
        drive["limit_N_m"] = control.drive_torque_limit_N_m
        drive["motor_share"] = 0.5
        drive["noise_rad_s"], drive["lsb_rad_s"] = noise, lsb
    return drives


def _cells(declaration: Declaration) -> Records:
    sensors = cell_sensors(declaration)
    cells = np.zeros(len(sensors), CELL)
    for cell, sensor in zip(cells, sensors, strict=True):
        cell["body"] = declaration.body(sensor.roller)
        cell["corner_Hz"] = sensor.low_pass_Hz
        cell["gain"] = 1.0
        cell["noise_N"], cell["lsb_N"] = sensor.noise_sd_N or 0.0, sensor.lsb_N or 0.0
        cell["resonance_damping"] = 0.05
    return cells


def _loops(declaration: Declaration) -> Records:
    number = {s.roller: c for c, s in enumerate(cell_sensors(declaration))}
    control = declaration.control
    loops = np.zeros(len(control.tension_pi) + len(control.position_pi), LOOP)
    for loop, given in zip(loops, control.tension_pi, strict=False):
        loop["cell"], loop["carriage"] = number[given.load_cell], -1
        loop["gain_m_s_N"], loop["corner_rad_s"] = given.gain_m_s_per_N, given.corner_rad_s
        loop["sign"] = sign_of(declaration, given.acts_on, given.load_cell, given.law)
    for loop, held in zip(loops[len(control.tension_pi) :], control.position_pi, strict=True):
        loop["cell"], loop["carriage"] = -1, declaration.carriage(held.carriage)
        loop["gain_m_s_N"], loop["corner_rad_s"] = held.gain_m_s_per_m, held.corner_rad_s
        rollers = declaration.carriages[int(loop["carriage"])].rollers
        feeds = declaration.body(held.acts_on) < declaration.body(rollers[0])
        loop["sign"], loop["reference_m"] = 1.0 if feeds else -1.0, held.position_m
    return loops


def _encoder(declaration: Declaration) -> tuple[float, float]:
    """Return noise and resolution of the speed signals, rad/s."""
    for sensor in declaration.sensors:
        if isinstance(sensor, DriveSpeed) and sensor.noise_sd_rad_s is not None:
            return sensor.noise_sd_rad_s, sensor.lsb_rad_s or 0.0
    return 0.0, 0.0


def start_state(
    p: LineArrays, spans_deg: list[float], line_speed_m_s: float, tension_N: float
) -> tuple[Layout, LineState]:
    """Return the layout and a first guess of a line running at this speed and tension.

    Not an equilibrium: ``LineSimulation.settle`` makes it one.
    """
    n, d, c, loops = p.bodies.size, p.drives.size, p.cells.size, p.loops.size
    radius = p.bodies["radius_m"]
    g = p.carriages.size
    lay = layout_of(n, d, c, g, p.heats.size)
    y = np.zeros(lay.size)
    y[lay.omega : lay.omega + n] = line_speed_m_s / radius
    y[lay.strain : lay.strain + n - 1] = tension_N / p.spans["EA_N"] + p.spans["free_strain"]
    y[lay.radius], y[lay.radius + 1] = radius[0], radius[-1]
    y[lay.cell : lay.cell + c] = tension_N
    y[lay.resonance : lay.resonance + 2 * c : 2] = tension_N
    y[lay.motor : lay.motor + d] = line_speed_m_s / radius[p.drives["body"]]
    state = LineState(
        y=y,
        phi_rad=np.radians(np.array(spans_deg)),
        drive_integral=np.zeros(d),
        torque_N_m=np.zeros(d),
        reference_m_s=np.full(d, line_speed_m_s),
        correction_m_s=np.zeros(d),
        loop_integral=np.zeros(loops),
        loop_correction_m_s=np.zeros(loops),
        measured_N=np.full(c, tension_N),
        true_N=np.full(c, tension_N),
        measured_rad_s=np.zeros(d),
        carriage_integral_m=np.zeros(g),
        carriage_force_N=np.zeros(g),
        delay_m_s=np.zeros((d, DELAY_RING_TICKS)),
        counters=np.zeros(2, dtype=np.int64),
        time_s=np.zeros(1),
    )
    return lay, state
