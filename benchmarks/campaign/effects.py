"""What can be wrong with the machine: library effects, written again, and some beyond it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from benchmarks.campaign import line as short
from benchmarks.campaign.contact import Array
from benchmarks.campaign.motion import TICK_S
from benchmarks.campaign.state import Machine

VERTICES = 4096
GRAVITY = 9.80665
NAMES = [b[0] for b in short.BODIES]
IDLERS = [b[0] for b in short.BODIES if b[1] == "idler"]
DRIVES = [b[0] for b in short.BODIES if b[1] != "idler"]
CELLS = list(short.CELLS.values())


@dataclass(frozen=True, slots=True, kw_only=True)
class Fault:
    """One thing wrong with the machine.

    Attributes
    ----------
    effect : name in a verdict, or of something no library has.
    location : as in a verdict.
    size : strength, in the unit of its first parameter.
    angle : phase, rad.
    shape : further numbers: order, frequency, wavelength, profile (mode).
    kind : class of the free line it makes for a library without it.
    """

    effect: str
    location: str
    size: float
    angle: float = 0.0
    shape: float = 0.0
    kind: str = ""


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
    """Let a bearing drag."""
    m.drag[NAMES.index(f.location)] += f.size
    return m


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
    m.free[spans[f.location]] += f.size
    return m


def slip(m: Machine, f: Fault) -> Machine:
    """Let the web slip on a roller above a speed."""
    k = NAMES.index(f.location)
    m.slip[k], m.slip_speed[k] = f.size, f.shape
    return m


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
    """Let a drive believe a wrong radius."""
    m.drive_ratio[DRIVES.index(f.location)] *= 1.0 + f.size
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
    m.web[6], m.web[7] = f.size, f.shape
    return m


def stiffening(m: Machine, f: Fault) -> Machine:
    """Make the web stiffer the more it is pulled."""
    m.web[8] += f.size
    return m


def gusty_drive(m: Machine, f: Fault) -> Machine:
    """Let a drive push irregularly."""
    m.gust[:] = DRIVES.index(f.location), f.size
    return m
