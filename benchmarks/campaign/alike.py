"""What the record of a fault can show at all, by this generator alone: no tool can do better."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from benchmarks.campaign import line as short
from benchmarks.campaign.cases import IDLERS, LIBRARY, SMALLEST, Case
from benchmarks.campaign.contact import Array
from benchmarks.campaign.effects import CELLS, DRIVES, Fault
from benchmarks.campaign.make import JUDGED_FROM_S, SIZED_BY, Stage, floors, stage
from benchmarks.campaign.record import simulate

SAME_LINE = 0.003
"""Wavenumbers closer than this (relative) are one line in a record of 60 s."""
MARGIN = 10.0
"""Chi-square by which the true effect must fit better than another to be told from it."""
SHARES = (0.0, 1.0)
OWN_SD = {k: v / 4.0 for k, v in SMALLEST.items() if k != "loop_delay"}
"""Standard deviation of the declared number that says the same as the effect."""


def wavenumber(fault: Fault) -> float:
    """Return cycles per metre of web of a fault with one line; 0 where it has none or many."""
    single = ("eccentric_roller", "unbalanced_roller", "unbalanced_measuring_roller",
              "torque_ripple", "encoder_eccentricity")  # fmt: skip
    if fault.effect not in single:
        return 0.0
    names = [b[0] for b in short.BODIES]
    radius = short.radii(short.NOMINAL_RADII)[names.index(fault.location)]
    order = fault.shape if fault.effect == "torque_ripple" else 1.0
    return order / (2.0 * math.pi * radius)


def rivals(fault: Fault) -> list[Fault]:
    """Return other effects and places that may answer like ``fault``: same line, or a drag."""
    if fault.effect == "bearing_drag":
        return [replace(fault, location=k) for k in IDLERS if k != fault.location]
    at = wavenumber(fault)
    if at == 0.0:
        return []
    found = []
    rolls = [(e, p) for e in ("eccentric_roller", "unbalanced_roller")
             for p in (*IDLERS, "swrap", "pull_roll")]  # fmt: skip
    rolls += [("unbalanced_measuring_roller", p) for p in CELLS]
    rolls += [(e, p) for e in ("torque_ripple", "encoder_eccentricity") for p in DRIVES]
    for effect, place in rolls:
        _, size, shapes = LIBRARY[effect]
        for shape in (*shapes, 1.0) if effect == "torque_ripple" else shapes:
            other = Fault(effect=effect, location=place, size=size, shape=shape)
            same = (effect, place) == (fault.effect, fault.location)
            if not same and abs(wavenumber(other) / at - 1.0) < SAME_LINE:
                found.append(other)
    return list(dict.fromkeys(found))


def response(at: Stage, fault: Fault, healthy: dict[str, Array], floor: dict[str, float]) -> Array:
    """Return the answer of all tensions and speeds to a fault, in units of their noise."""
    quiet = at.quiet((fault,))
    first = round(JUDGED_FROM_S / short.SAMPLE_S)
    return np.concatenate([(quiet[c] - healthy[c])[first:] / floor[c] for c in SIZED_BY])


def apart(true: Array, columns: Array) -> float:
    """Return the chi-square that the best mix of ``columns`` (rows, k) leaves of ``true``."""
    best = np.linalg.lstsq(columns, true, rcond=None)[0]
    left = true - columns @ best
    return float(left @ left)


def alike(
    at: Stage, fault: Fault, healthy: dict[str, Array], floor: dict[str, float]
) -> list[tuple[str, str]]:
    """Return (effect, location) of what cannot be told from ``fault`` in this record."""
    others = rivals(fault)
    if not others:
        return []
    true = response(at, fault, healthy, floor)
    found = []
    for other in others:
        turns = (other.angle,) if fault.effect == "bearing_drag" else (0.0, 0.5 * math.pi)
        columns = [response(at, replace(other, angle=a), healthy, floor) for a in turns]
        if apart(true, np.stack(columns, axis=1)) < MARGIN:
            found.append((other.effect, other.location))
    return found


def evidence(
    at: Stage, fault: Fault, healthy: dict[str, Array], floor: dict[str, float]
) -> float:  # fmt: skip
    """Return the chi-square by which a fault shows, beside the tolerance that may hide it.

    Equation: 1/D = 1/sum (answer / noise)^2 + (sd / size)^2, as the declared number moves at the
    price of its prior  [two independent errors in a row].
    """
    true = response(at, fault, healthy, floor)
    direct = float(true @ true)
    sd = OWN_SD.get(fault.effect, 0.0)
    if direct == 0.0:
        return 0.0
    return 1.0 / (1.0 / direct + (sd / fault.size) ** 2)


def told(case: Case, faults: tuple[Fault, ...]) -> dict[str, list[object]]:
    """Return per fault what cannot be told from it, and how much it shows."""
    at = stage(case, "a")
    healthy = at.quiet()
    noisy = simulate(at.machine, at.told, at.angles, at.seed, colour=case.colour)
    floor = floors(noisy.even(), healthy)
    return {
        "alike": [alike(at, f, healthy, floor) for f in faults],
        "evidence": [evidence(at, f, healthy, floor) for f in faults],
    }
