"""What can be wrong with the machine: library effects, written again, and some beyond it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.campaign import line as short
from benchmarks.campaign.contact import Array, Bodies
from benchmarks.campaign.motion import TICK_S
from benchmarks.campaign.state import Machine

VERTICES = 4096
GRAVITY = 9.80665
NAMES = [b[0] for b in short.BODIES]
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


Change = Callable[[Machine, Fault], Machine]


def _eccentric(m: Machine, f: Fault) -> Machine:
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


def _out_of_round(m: Machine, f: Fault) -> Machine:
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


def _unbalanced(m: Machine, f: Fault) -> Machine:
    k = NAMES.index(f.location)
    m.heavy[k], m.heavy_angle[k] = f.size * GRAVITY, f.angle
    return m


def _unbalanced_cell(m: Machine, f: Fault) -> Machine:
    c = CELLS.index(f.location)
    m.cell_unbalance[c], m.cell_unbalance_angle[c] = f.size, f.angle
    return m


def _ripple(m: Machine, f: Fault) -> Machine:
    row = [
        DRIVES.index(f.location),
        f.shape,
        f.size * math.cos(f.angle),
        f.size * math.sin(f.angle),
    ]
    return m._replace(ripple=np.concatenate([m.ripple, [row]]))


def _drag(m: Machine, f: Fault) -> Machine:
    m.drag[NAMES.index(f.location)] += f.size
    return m


def _modulus(m: Machine, f: Fault) -> Machine:
    m.modulus[:] *= 1.0 + f.size
    m.web[4] /= 1.0 + f.size
    return m


def _wound_in(m: Machine, f: Fault) -> Machine:
    m.web[4] += f.size
    return m


def _thermal(m: Machine, f: Fault) -> Machine:
    first, second = NAMES.index("swrap"), NAMES.index("pull_roll")
    spans = {
        "unwind_zone": slice(0, first),
        "pull_roll_zone": slice(first, second),
        "rewind_zone": slice(second, None),
    }
    m.free[spans[f.location]] += f.size
    return m


def _slip(m: Machine, f: Fault) -> Machine:
    k = NAMES.index(f.location)
    m.slip[k], m.slip_speed[k] = f.size, f.shape
    return m


def _slow_cell(m: Machine, f: Fault) -> Machine:
    for c, name in enumerate(CELLS):
        if f.location in ("all", name):
            lag_s = 1.0 / (2.0 * math.pi * m.cell_Hz[c]) + f.size
            m.cell_Hz[c] = 1.0 / (2.0 * math.pi * lag_s)
    return m


def _hum(m: Machine, f: Fault) -> Machine:
    c = CELLS.index(f.location)
    m.cell_hum[c], m.cell_hum_Hz[c], m.cell_hum_phase[c] = f.size, f.shape, f.angle
    return m


def _delay(m: Machine, f: Fault) -> Machine:
    m.drive_delay[DRIVES.index(f.location)] += round(f.size / TICK_S)
    return m


def _encoder(m: Machine, f: Fault) -> Machine:
    d = DRIVES.index(f.location)
    m.encoder[d], m.encoder_angle[d], m.encoder_share[d] = f.size, f.angle, f.shape
    return m


def _believed_radius(m: Machine, f: Fault) -> Machine:
    m.drive_ratio[DRIVES.index(f.location)] *= 1.0 + f.size
    return m


def _shaken(m: Machine, f: Fault) -> Machine:
    """Let a span's length swing: in time (a dancer, a frame), or with web travel (a nip)."""
    row = [NAMES.index(f.location), 0.0 if f.kind == "time" else 1.0, f.shape, f.size, f.angle]
    return m._replace(shake=np.concatenate([m.shake, [row]]))


def _drifting_cell(m: Machine, f: Fault) -> Machine:
    m.cell_drift[CELLS.index(f.location)] += f.size
    return m


def _web_wave(m: Machine, f: Fault) -> Machine:
    m.web[6], m.web[7] = f.size, f.shape
    return m


def _stiffening(m: Machine, f: Fault) -> Machine:
    m.web[8] += f.size
    return m


def _gusty_drive(m: Machine, f: Fault) -> Machine:
    m.gust[:] = DRIVES.index(f.location), f.size
    return m


CHANGES: dict[str, Change] = {
    "eccentric_roller": _eccentric,
    "out_of_round_roll": _out_of_round,
    "unbalanced_roller": _unbalanced,
    "unbalanced_measuring_roller": _unbalanced_cell,
    "torque_ripple": _ripple,
    "bearing_drag": _drag,
    "web_modulus": _modulus,
    "wound_in_strain": _wound_in,
    "thermal_strain": _thermal,
    "slip": _slip,
    "load_cell_filter": _slow_cell,
    "mains_hum": _hum,
    "loop_delay": _delay,
    "encoder_eccentricity": _encoder,
    "radius_error": _believed_radius,
    # beyond any library
    "dancer_swing": _shaken,
    "hidden_nip": _shaken,
    "drifting_cell": _drifting_cell,
    "web_wave": _web_wave,
    "stiffening_web": _stiffening,
    "gusty_drive": _gusty_drive,
}


def copied(m: Machine) -> Machine:
    """Return an independent copy."""
    bodies = Bodies._make(part.copy() for part in m.bodies)
    return Machine._make([bodies, *(part.copy() for part in m[1:])])


def with_faults(m: Machine, faults: tuple[Fault, ...]) -> Machine:
    """Return a copy of the machine with these faults."""
    found = copied(m)
    for fault in faults:
        found = CHANGES[fault.effect](found, fault)
    return found
