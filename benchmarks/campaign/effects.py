"""What can be wrong with the machine: library effects, written again, and some beyond it."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from benchmarks.campaign import line as short
from benchmarks.campaign.contact import Array
from benchmarks.campaign.fault import CELLS, DRIVES, FOREVER_S, NAMES, Fault
from benchmarks.campaign.sensing import TICK_S
from benchmarks.campaign.state import (
    CREEP,
    CREEP_S,
    DRAG,
    FREE,
    SLIP,
    STIFFENING,
    WAVE,
    WAVE_M,
    Machine,
)

VERTICES = 4096
GRAVITY = 9.80665
NIP_LEVER_M = 1e-3
"""How far ahead of the line of centres the force of a nip acts: a verdict assumes it too."""


def eccentric(m: Machine, f: Fault) -> Machine:
    """Move the centre of a body."""
    k = NAMES.index(f.location)
    m.bodies.off_x[k] += f.size * math.cos(f.angle)
    m.bodies.off_y[k] += f.size * math.sin(f.angle)
    return m


def outline(radius_m: float, rows: list[tuple[int, float, float]]) -> tuple[Array, Array]:
    """Return points and normals (vertices, 2) of a roll of these orders.

    Its tangents lie R + sum a cos(n psi - p) from the axis; rows are (n, a, p).
    """
    psi = 2.0 * math.pi * np.arange(VERTICES) / VERTICES
    far, slope = np.full(VERTICES, radius_m), np.zeros(VERTICES)
    for order, size, phase in rows:
        far += size * np.cos(order * psi - phase)
        slope -= order * size * np.sin(order * psi - phase)
    normal = np.stack([np.cos(psi), np.sin(psi)], axis=1)
    along = np.stack([-np.sin(psi), np.cos(psi)], axis=1)
    return far[:, None] * normal + slope[:, None] * along, normal


def flat_outline(
    radius_m: float, inner: float, depth_m: float, angle: float
) -> tuple[Array, Array]:
    """Return a roll with a chord ``depth_m`` deep pressed in at radius ``inner``, wound over.

    Points stand where the chord's corners are rounded by the web on top: the core outline's
    corner turns through its angle at one point, with as many normals as it takes.
    """
    half = math.acos(1.0 - depth_m / inner)
    share = max(8, round(VERTICES * 0.25))
    arc = np.linspace(half, 2.0 * math.pi - half, VERTICES - 2 * share + 2)[1:-1]
    fan = np.linspace(0.0, half, share + 1)
    facing = np.concatenate([fan[1:], arc, 2.0 * math.pi - fan[:0:-1]])
    place = np.clip(facing, half, 2.0 * math.pi - half)  # corners stand still while normals turn
    turn = np.exp(1j * (place + angle))
    look = np.exp(1j * (facing + angle))
    points = inner * turn + (radius_m - inner) * look
    return (np.stack([points.real, points.imag], axis=1), np.stack([look.real, look.imag], axis=1))


def out_of_round(m: Machine, f: Fault) -> Machine:
    """Make a roll a polygon: a flat wound over, or one low order and a third of the next."""
    k = NAMES.index(f.location)
    radius = float(m.radius[k])
    if f.shape == 0.0:
        inner = 0.8 * short.NOMINAL_RADII[0 if k == 0 else 1]
        points, normals = flat_outline(radius, inner, f.size, f.angle)
    else:  # one low order and a third of it at the next
        rows = [(int(f.shape), f.size, f.angle), (int(f.shape) + 1, f.size / 3.0, 2.0 * f.angle)]
        points, normals = outline(radius, rows)
    b = m.bodies
    b.polygon[k] = b.points.shape[0]
    stack = b.points[:, :VERTICES] if b.points.shape[1] == VERTICES else np.zeros((0, VERTICES, 2))
    other = b.normals if b.normals.shape[1] == VERTICES else np.zeros((0, VERTICES, 2))
    return m._replace(
        bodies=b._replace(
            points=np.concatenate([stack, points[None]]),
            normals=np.concatenate([other, normals[None]]),
        )
    )


def unbalanced(m: Machine, f: Fault) -> Machine:
    """Put a gravity torque on a body."""
    k = NAMES.index(f.location)
    m.gravity_moment[k], m.gravity_moment_angle[k] = f.size * GRAVITY, f.angle
    return m


def unbalanced_cell(m: Machine, f: Fault) -> Machine:
    """Let a measuring roller shake its own cell."""
    c = CELLS.index(f.location)
    m.cell_unbalance[c], m.cell_unbalance_angle[c] = f.size, f.angle
    return m


def ripple(m: Machine, f: Fault) -> Machine:
    """Let a motor push unevenly."""
    row = [
        DRIVES.index(f.location),
        f.shape,
        f.size * math.cos(f.angle),
        f.size * math.sin(f.angle),
    ]
    return m._replace(ripple=np.concatenate([m.ripple, [row]]))


def drag(m: Machine, f: Fault) -> Machine:
    """Let a bearing drag, always or from a moment on."""
    return changed(m, f, DRAG, [NAMES.index(f.location)], m.drag)


def modulus(m: Machine, f: Fault) -> Machine:
    """Make the web stiffer; the roll was wound at the same tension."""
    m.modulus[:] *= 1.0 + f.size
    m.web[4] /= 1.0 + f.size
    return m


def wound_in(m: Machine, f: Fault) -> Machine:
    """Wind the roll tighter."""
    m.web[4] += f.size
    return m


def thermal(m: Machine, f: Fault) -> Machine:
    """Give the web of a zone a free strain."""
    first, second = NAMES.index("swrap"), NAMES.index("pull_roll")
    spans = {
        "unwind_zone": slice(0, first),
        "pull_roll_zone": slice(first, second),
        "rewind_zone": slice(second, None),
    }
    cold = round(f.number("warm_from_span"))
    places = range(m.free.size)[spans[f.location]][cold:]
    return changed(m, f, FREE, places, m.free)


def changed(m: Machine, f: Fault, what: int, places: Iterable[int], always: Array) -> Machine:
    """Let a number be larger by the size of a fault: all along, or while the fault is there.

    ``always`` is the machine's own array of that number.
    """
    if f.from_s < 0.0:
        always[list(places)] += f.size
        return m
    rise, until = f.number("rise_s"), f.from_s + f.number("hold_s", FOREVER_S)
    rows = [[what, k, f.size, f.from_s, rise, until] for k in places]
    return m._replace(change=np.concatenate([m.change, np.array(rows, dtype=np.float64)]))


def slip(m: Machine, f: Fault) -> Machine:
    """Let the web slip on a roller above a speed."""
    k = NAMES.index(f.location)
    m.slip_speed[k] = f.shape
    return changed(m, f, SLIP, [k], m.slip)


def slow_cell(m: Machine, f: Fault) -> Machine:
    """Slow down the amplifier of a cell, or of all."""
    for c, name in enumerate(CELLS):
        if f.location in ("all", name):
            lag_s = 1.0 / (2.0 * math.pi * m.cell_Hz[c]) + f.size
            m.cell_Hz[c] = 1.0 / (2.0 * math.pi * lag_s)
    return m


def hum(m: Machine, f: Fault) -> Machine:
    """Put mains on a cell's cable."""
    c = CELLS.index(f.location)
    m.cell_hum[c], m.cell_hum_Hz[c], m.cell_hum_phase[c] = f.size, f.shape, f.angle
    return m


def delay(m: Machine, f: Fault) -> Machine:
    """Let corrections reach a drive late."""
    m.drive_delay[DRIVES.index(f.location)] += round(f.size / TICK_S)
    return m


def encoder(m: Machine, f: Fault) -> Machine:
    """Mount an encoder off its centre."""
    d = DRIVES.index(f.location)
    m.encoder[d], m.encoder_angle[d], m.encoder_share[d] = f.size, f.angle, f.shape
    return m


def believed_radius(m: Machine, f: Fault) -> Machine:
    """Let a drive believe a wrong radius; what is declared of a roll, and told, is that one."""
    m.drive_ratio[DRIVES.index(f.location)] *= 1.0 + f.size
    k = NAMES.index(f.location)
    if k in (0, m.radius.size - 1):
        m.radius[k] /= 1.0 + f.size
    return m


def relaxing(m: Machine, f: Fault) -> Machine:
    """Let a share of the web's stiffness creep."""
    m.web[CREEP], m.web[CREEP_S] = f.size, f.number("time_s")
    return m


def wrong_gain(m: Machine, f: Fault) -> Machine:
    """Give a cell a wrong scale."""
    c = CELLS.index(f.location)
    m.cell_gain[c] *= 1.0 + f.size
    m.cell_offset[c] *= 1.0 + f.size
    return m


def wrong_zero(m: Machine, f: Fault) -> Machine:
    """Give a cell a wrong zero."""
    m.cell_offset[CELLS.index(f.location)] += f.size
    return m


def ringing_cell(m: Machine, f: Fault) -> Machine:
    """Let a measuring roller swing on its mounts, with the size of the fault as its period, s."""
    c = CELLS.index(f.location)
    m.cell_ring_Hz[c], m.cell_ring_damping[c] = 1.0 / f.size, f.number("damping")
    return m


def ramped_reference(m: Machine, f: Fault) -> Machine:
    """Let a drive follow its reference only so fast: 1 / size in m/s2."""
    m.drive_slew[DRIVES.index(f.location)] = 1.0 / f.size
    return m


def ramped_correction(m: Machine, f: Fault) -> Machine:
    """Let a drive follow its correction only so fast: 1 / size in m/s2."""
    m.drive_ramp[DRIVES.index(f.location)] = 1.0 / f.size
    return m


def soft_shaft(m: Machine, f: Fault) -> Machine:
    """Put a spring (size: its compliance, rad per N m) and play between a motor and its body."""
    d, k = DRIVES.index(f.location), NAMES.index(f.location)
    motor = body = 0.5 * m.inertia[k]  # wound web is on the body's side
    stiffness = 1.0 / f.size
    damping = 2.0 * 0.05 * math.sqrt(stiffness * motor * body / (motor + body))
    m.shaft[d] = motor, stiffness, damping, f.number("backlash_rad")
    return m


def bouncing(m: Machine, f: Fault) -> Machine:
    """Put the unwind on a soft mandrel; out of balance at one order, half as much at 1."""
    here, once = f.size * np.exp(1j * np.array([f.angle, 0.5 * f.angle])) * np.array([1.0, 0.5])
    m.axle[:4] = f.number("mass_kg"), f.number("frequency_Hz"), f.number("damping"), f.shape
    m.axle[4:] = here.real, here.imag, once.real, once.imag
    return m


def pressed(m: Machine, f: Fault) -> Machine:
    """Let a nip roller press unevenly (size: N) on its driven roller.

    The cover gives less back than it takes, so the force F acts a lever b ahead of the line of
    centres of either roller. The nip roller is turned by the pull S = F b / r at its face alone;
    the driven one is braked by F b and by S at its own radius.
    """
    body, nip_m = NAMES.index(f.location), f.shape
    pull = f.size * NIP_LEVER_M / nip_m
    brake = f.size * NIP_LEVER_M + pull * m.radius[body]
    row = [
        DRIVES.index(f.location),
        m.radius[body] / nip_m,
        -brake * math.cos(f.angle),
        -brake * math.sin(f.angle),
    ]
    return m._replace(ripple=np.concatenate([m.ripple, [row]]))


def other_web(m: Machine, f: Fault) -> Machine:
    """Join on another web: stiffer by the size, and of another thickness."""
    m.seam[:3] = f.from_s, 1.0 + f.size, f.number("thickness_factor", 1.0)
    return m


def thick_seam(m: Machine, f: Fault) -> Machine:
    """Join on the same web by a seam that stands out by the size, m."""
    m.seam[0] = f.from_s
    m.seam[3:] = f.size, f.number("piece_m")
    return m


def shaken(m: Machine, f: Fault) -> Machine:
    """Let a span's length swing: in time (a dancer, a frame), or with web travel (a nip)."""
    row = [NAMES.index(f.location), 0.0 if f.kind == "time" else 1.0, f.shape, f.size, f.angle]
    return m._replace(shake=np.concatenate([m.shake, [row]]))


def drifting_cell(m: Machine, f: Fault) -> Machine:
    """Let the zero of a cell drift."""
    m.cell_drift[CELLS.index(f.location)] += f.size
    return m


def web_wave(m: Machine, f: Fault) -> Machine:
    """Let the web's strain vary along its length."""
    m.web[WAVE], m.web[WAVE_M] = f.size, f.shape
    return m


def stiffening(m: Machine, f: Fault) -> Machine:
    """Make the web stiffer the more it is pulled."""
    m.web[STIFFENING] += f.size
    return m


def gusty_drive(m: Machine, f: Fault) -> Machine:
    """Let a drive push irregularly."""
    m.gust[:] = DRIVES.index(f.location), f.size
    return m
