"""What can be wrong with the machine: one row each, drawn as ``labels.yaml`` tells it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.blind.plant import DRAG, GRAVITY, WARM, Array, Plant
from benchmarks.blind.run import TICK_S

Parameters = dict[str, Any]
Rng = np.random.Generator
Names = list[str]
IDLERS = tuple(f"R{k}" for k in (1, 2, 3, 4, 5, 6, 7, 8, 9, 12, 13, 14, 15, 17, 18, 19))
DRIVES = ("unwind", "swrap_lead", "swrap_follower", "pull_roll", "rewind")
CELLS = ("R3", "R9", "R15", "R19")
ZONES = {"unwind_zone": (0, 10), "pull_roll_zone": (11, 16), "rewind_zone": (16, 20)}
FOREVER_S = 1e9
POINTS = 4096
FINEST_ORDER = 64


@dataclass(frozen=True, slots=True, kw_only=True)
class Hidden:
    """One drawn effect: its name and place, its numbers, an angle that no label tells."""

    effect: str
    location: str
    parameters: Parameters
    angle: float = 0.0
    accept: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class DrawableEffect:
    """What is known of one effect.

    Attributes
    ----------
    places : where it is drawn. draw : its numbers. put : the machine with it, of one record
        ("a" or "b"); it may change the arrays that it is given. accept : as in ``labels.yaml``.
    """

    places: tuple[str, ...]
    draw: Callable[[Rng], Parameters]
    put: Callable[[Plant, int, Hidden, str], Plant]
    accept: tuple[str, ...] = ()


def _drive(p: Plant, k: int) -> int:
    return int(np.flatnonzero(p.drive_body == k)[0])


def _cells(p: Plant, k: int) -> Any:
    """Return the cell at a body, or all."""
    return slice(None) if k < 0 else int(np.flatnonzero(p.cell_body == k)[0])


def _changed(p: Plant, rows: list[list[float]]) -> Plant:
    return p._replace(change=np.concatenate([p.change, np.array(rows, dtype=np.float64)]))


def eccentric(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Move the centre of a roller off its axis."""
    p.off[k], p.off_angle[k] = h.parameters["eccentricity_m"], h.angle
    return p


def outline(radius: float, kind: str, size: float) -> Array:
    """Return points (k, 2) of a roll that is not round: its radius elsewhere is ``radius``."""
    turn = 2.0 * math.pi * np.arange(POINTS * 4) / (POINTS * 4) - math.pi
    far = np.full(turn.size, radius)
    if kind == "flat":
        half = math.acos(1.0 - size / radius)
        inside = np.abs(turn) < half
        far[inside] = (radius - size) / np.cos(turn[inside])
    elif kind == "ellipse":
        a, b = radius + size, radius - size
        far = a * b / np.hypot(b * np.cos(turn), a * np.sin(turn))
    else:
        rise, fall = np.radians((30.0, 30.0) if kind == "bulge" else (45.0, 30.0))
        part = np.clip(np.where(turn < 0.0, 1.0 + turn / rise, 1.0 - turn / fall), 0.0, 1.0)
        far = far + size * part**2 * (3.0 - 2.0 * part)
    return np.stack([far * np.cos(turn), far * np.sin(turn)], axis=1)


def tangents(points: Array) -> Array:
    """Return h, h' and h + h'' (3, k + 1) of the hull of points, up to the finest order.

    A web is stiff: corners are rounded by a normal curve of 1 degree.
    """
    look = 2.0 * math.pi * np.arange(POINTS) / POINTS
    reach = np.array([np.max(points @ (math.cos(a), math.sin(a))) for a in look])
    order = np.arange(POINTS // 2 + 1)
    wave = np.fft.rfft(reach) * np.exp(-0.5 * (order * math.radians(1.0)) ** 2)
    wave[FINEST_ORDER + 1 :] = 0.0
    rows = [np.fft.irfft(f * wave) for f in (1.0 + 0.0 * order, 1j * order, 1.0 - order**2)]
    return np.array([np.append(row, row[0]) for row in rows])


def out_of_round(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Give the unwind a profile; its web is then also off balance."""
    radius = float(p.radius[0])
    points = outline(radius, h.parameters["shape"], h.parameters["size_m"])
    shape = tangents(points)
    at = round(h.angle / (2.0 * math.pi) * POINTS) % POINTS
    shape = np.roll(shape[:, :-1], at, axis=1)
    shape = np.concatenate([shape, shape[:, :1]], axis=1)
    shape[0] -= radius
    shape[2] -= radius
    x, y = points.T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    moment = np.array([np.sum((a + np.roll(a, -1)) * cross) / 6.0 for a in (x, y)])
    p.heavy[0] = p.web[3] * GRAVITY * math.hypot(*moment)
    p.heavy_angle[0] = math.atan2(moment[1], moment[0]) + 2.0 * math.pi * at / POINTS
    return p._replace(shape=shape)


def unbalanced(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Put a weight on one side of a roller."""
    p.heavy[k], p.heavy_angle[k] = h.parameters["imbalance_kg_m"] * GRAVITY, h.angle
    return p


def drag(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Let a bearing drag, always or from a moment on."""
    amount = h.parameters["added_torque_N_m"]
    if "from_record_time_s" not in h.parameters:
        p.drag[k] += amount
        return p
    from_s = h.parameters["from_record_time_s"][record]
    return _changed(p, [[DRAG, k, amount, from_s, 0.0, FOREVER_S]])


def ripple(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Let a motor push unevenly."""
    p.ripple[_drive(p, k)] = h.parameters["amplitude_N_m"], h.parameters["order"], h.angle
    return p


def slip(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Let web creep on both S-wrap rollers above a speed."""
    for body in p.drive_body[1:3]:
        p.slip[body] = h.parameters["creep_per_m_s"]
        p.slip_above[body] = h.parameters["above_m_s"]
    return p


def warm(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Warm the web of a zone for a while."""
    q = h.parameters
    from_s = q["from_record_time_s"][record]
    first, end = ZONES[h.location]
    times = [from_s, q["rise_s"], from_s + q["hold_s"]]
    return _changed(p, [[WARM, i, q["strain"], *times] for i in range(first, end)])


def seam(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Send a thick seam through the line."""
    q = h.parameters
    p.seam[:3] = q["record_time_s"][record], q["step_m"], q["length_m"]
    return p


def ramped(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Let a drive follow its reference, or the correction in it, only so fast."""
    limited = p.drive_slew if h.parameters["of"] == "reference" else p.drive_ramp
    limited[_drive(p, k)] = h.parameters["limit_m_s2"]
    return p


def late(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Let corrections reach a drive late."""
    p.drive_delay[_drive(p, k)] = round(h.parameters["delay_s"] / TICK_S)
    return p


def slow_cell(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Set another corner of one cell's amplifier, or of all."""
    p.cell_Hz[_cells(p, k)] = h.parameters["corner_Hz"]
    return p


def wrong_scale(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Give a cell another scale and zero."""
    c = _cells(p, k)
    p.cell_gain[c] *= h.parameters["gain"]
    p.cell_zero[c] = h.parameters["gain"] * p.cell_zero[c] + h.parameters["offset_N"]
    return p


def ringing(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Let a measuring roller swing on its mounts."""
    c = _cells(p, k)
    p.cell_ring_Hz[c] = h.parameters["frequency_Hz"]
    p.cell_ring_damping[c] = h.parameters["damping_ratio"]
    return p


def hum(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Put mains on the cables: on all cells at one phase."""
    p.hum[_cells(p, k)] = h.parameters["amplitude_N"], h.parameters["frequency_Hz"], h.angle
    return p


def wrong_radius(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Let a drive believe a radius that is too large; of a roll that one is declared and told."""
    ratio = 1.0 + h.parameters["relative"]
    p.drive_ratio[_drive(p, k)] *= ratio
    if p.growth[k] != 0.0:
        p.radius[k] /= ratio
    return p


def wound(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Wind the roll tighter or looser."""
    p.web[2] *= h.parameters["factor"]
    return p


def stiffer(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Make the web stiffer; it was wound at the same tension."""
    p.web[0] *= h.parameters["factor"]
    p.web[2] /= h.parameters["factor"]
    return p


def relaxing(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Put a spring and dashpot beside the web's spring."""
    p.web[5], p.web[6] = h.parameters["branch_fraction"], h.parameters["relaxation_s"]
    return p


def bouncing(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Put the unwind on a soft mandrel, off balance at an order and half as much at 1."""
    q = h.parameters
    unbalance = q["unbalance_kg_m"]
    p.axle[:4] = q["mass_kg"], q["frequency_Hz"], q["damping"], q["order"]
    p.axle[4:] = unbalance, h.angle, 0.5 * unbalance
    return p


def soft_shaft(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Put a spring with play between motor and roller, each with half the core's inertia."""
    half, stiffness = 0.5 * p.inertia[k], h.parameters["stiffness_N_m_rad"]
    damping = 2.0 * 0.05 * math.sqrt(0.5 * half * stiffness)
    p.inertia[k] = half
    p.shaft[_drive(p, k)] = half, stiffness, damping, h.parameters["gap_rad"]
    return p


def outside(p: Plant, k: int, h: Hidden, record: str) -> Plant:
    """Do what no library holds."""
    q = h.parameters
    if "hold_s" in q:
        p.freeze[:] = q["every_s"], q["hold_s"]
    elif "band_N" in q:
        p.play_N[0] = q["band_N"]
    elif "strain" in q:
        first, end = ZONES[h.location]
        p.pulse[first:end], p.pulse[-1] = q["strain"], q["frequency_Hz"]
    else:
        way = q["velocity_m_s"] / (2.0 * math.pi * q["frequency_Hz"])
        p.shake[:] = k, way, q["frequency_Hz"], q["every_s"]
    return p
