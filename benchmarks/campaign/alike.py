"""What the record of a fault can show at all, by this generator alone: no tool can do better."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.signal import lfilter

from benchmarks.campaign import line as short
from benchmarks.campaign.cases import Case
from benchmarks.campaign.contact import Array
from benchmarks.campaign.effect_table import BY_NAME, LIBRARY
from benchmarks.campaign.fault import NAMES, Fault
from benchmarks.campaign.record import simulate
from benchmarks.campaign.stage import JUDGED_FROM_S, SIZED_BY, Stage, stage, tolerances

SAME_LINE = 0.003
"""Wavenumbers closer than this (relative) are one line in a record of 60 s."""
MARGIN = 10.0
"""Chi-square by which the true effect must fit better than another to be told from it."""
FIRST = round(JUDGED_FROM_S / short.SAMPLE_S)
ORDER = 30


def wavenumber(fault: Fault) -> float:
    """Return cycles per metre of web of a fault with one line; 0 where it has none or many."""
    row = BY_NAME[fault.effect]
    if row.alike != "one line":
        return 0.0
    if row.coordinate is not None:
        return row.coordinate(asdict(fault))["wavenumber_1_m"]
    radius = short.radii(short.NOMINAL_RADII)[NAMES.index(fault.location)]
    return row.order(fault.shape) / (2.0 * math.pi * radius)


def rivals(fault: Fault) -> list[Fault]:
    """Return other effects and places that may answer like ``fault``: same line, or standing.

    Of what begins at a moment only what may begin as well.
    """
    kind, at = BY_NAME[fault.effect].alike, wavenumber(fault)
    form = BY_NAME[fault.effect].form(fault)
    others = [
        replace(other, from_s=fault.from_s)
        for row in LIBRARY
        if kind and row.alike == kind
        for other in row.rivals()
        if (row.name, other.location) != (fault.effect, fault.location)
        and row.form(other).begins == form.begins
    ]
    found = [f for f in others if not at or abs(wavenumber(f) / at - 1.0) < SAME_LINE]
    return list(dict.fromkeys(found))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Quiet:
    """A healthy record without noise, and what makes its noise white, per channel."""

    stage: Stage
    healthy: dict[str, Array]
    taps: dict[str, Array]

    @classmethod
    def of(cls, at: Stage, channels: Sequence[str] = SIZED_BY) -> Quiet:
        """Return it for one stage and what is recorded, its noise taken from one more run."""
        healthy = at.quiet()
        noisy = simulate(at.machine, at.told, at.angles, at.seed, colour=at.colour).even()
        noise = {c: (noisy[c] - healthy[c])[FIRST:] for c in channels}
        return cls(stage=at, healthy=healthy, taps={c: whitener(x) for c, x in noise.items()})

    def response(self, fault: Fault) -> Array:
        """Return the answer of all tensions and speeds to a fault, in units of white noise."""
        return answer(self, fault)

    def turned(self, fault: Fault) -> Array:
        """Return the answers (rows, 2) to a fault with a line, at two angles."""
        turns = (0.0, 0.5 * math.pi)
        return np.stack([self.response(replace(fault, angle=a)) for a in turns], axis=1)

    def apart_from(self, quiet: dict[str, Array]) -> Array:
        """Return what another record without noise has more, in units of white noise (rows,)."""
        return np.concatenate(
            [lfilter(self.taps[c], [1.0], quiet[c] - self.healthy[c])[FIRST:] for c in self.taps]
        )


@lru_cache(maxsize=64)
def answer(record: Quiet, fault: Fault) -> Array:
    """Return ``record.response(fault)``: rivals are asked for more than one fault of a case."""
    return record.apart_from(record.stage.quiet((fault,)))


def whitener(noise: Array) -> Array:
    """Return taps that make this noise white with unit variance  [least squares, 30 lags]."""
    lags = np.stack([noise[ORDER - k : noise.size - k] for k in range(ORDER + 1)], axis=1)
    weights = np.linalg.lstsq(lags[:, 1:], lags[:, 0], rcond=None)[0]
    left = lags[:, 0] - lags[:, 1:] @ weights
    found: Array = np.concatenate(([1.0], -weights)) / float(np.std(left))
    return found


def apart(true: Array, columns: Array, hiding: Array | None = None) -> float:
    """Return the chi-square that the best mix of ``columns`` (rows, k) leaves of ``true``.

    ``hiding`` (rows, n) may take up the rest at the price of its priors, see ``beside``.
    """
    size = float(np.linalg.norm(columns))
    free = columns * (1e6 / size if size else 1.0)  # so large a prior is none
    return beside(true, free if hiding is None else np.concatenate([free, hiding], axis=1))


def alike(record: Quiet, fault: Fault, hiding: Array | None = None) -> list[tuple[str, str]]:
    """Return (effect, location) of what cannot be told from ``fault`` in this record.

    ``hiding`` are the answers to declared numbers, for a fault without a line of its own.
    """
    others = rivals(fault)
    standing = BY_NAME[fault.effect].standing
    if not others:
        return []
    true, found = record.response(fault), []
    for other in others:
        columns = record.response(other)[:, None] if standing else record.turned(other)
        if (other.effect, other.location) in found:
            continue
        if apart(true, columns, hiding) < MARGIN:
            found.append((other.effect, other.location))
    return found


def merged(record: Quiet, faults: Sequence[Fault]) -> list[list[tuple[str, str]]]:
    """Return per fault which single (effect, location) answers like it and its like together.

    Two rollers of one radius, both a little wrong, may answer as a third one does; the simpler
    story then has two numbers less to pay for, ln(N/4) each.
    """
    at = [wavenumber(f) for f in faults]
    found: list[list[tuple[str, str]]] = [[] for _ in faults]
    for k, fault in enumerate(faults):
        same = [j for j, w in enumerate(at) if at[k] and abs(w / at[k] - 1.0) < SAME_LINE]
        if len(same) < 2:
            continue
        true = np.sum([record.response(faults[j]) for j in same], axis=0)
        least = MARGIN + 2.0 * (len(same) - 1) * math.log(true.size / 4.0)
        for other in rivals(fault):
            if apart(true, record.turned(other)) < least:
                found[k].append((other.effect, other.location))
    return found


def beside(true: Array, columns: Array) -> float:
    """Return the chi-square of ``true`` (rows,) that tolerances cannot take up.

    ``columns`` (rows, k) are the answers to one standard deviation of every declared number.
    Equation: min over x of |true - C x|^2 + |x|^2   [each number moves at the price of its prior].
    """
    normal = columns.T @ columns + np.eye(columns.shape[1])
    taken = columns.T @ true
    return float(true @ true - taken @ np.linalg.solve(normal, taken))


def tolerated(case: Case, record: Quiet, draws: Sequence[int]) -> Array:
    """Return the answers (rows, k) to one standard deviation of these draws of the machine."""
    stages = (stage(case, "a", nudged) for nudged in draws)
    return np.stack([record.apart_from(s.quiet()) for s in stages], axis=1)


def healthy_record(case: Case) -> Quiet:
    """Return the healthy record ``a`` of a case, of what is kept of its tensions and speeds."""
    kept = [c for c in SIZED_BY if not case.channels or c in case.channels]
    return Quiet.of(stage(case, "a"), kept)


@lru_cache(maxsize=1)
def beside_tolerances(case: Case) -> tuple[Quiet, Array]:
    """Return the healthy record ``a`` of a case, and what tolerances do to what is kept of it."""
    record = healthy_record(case)
    return record, tolerated(case, record, tolerances(case))


def alternatives(case: Case, faults: tuple[Fault, ...]) -> dict[str, list[object]]:
    """Return per fault what cannot be told from it, and the chi-square by which it shows.

    What has no line of its own shows beside all that the tolerances may take up.
    """
    hidden = [BY_NAME[f.effect].standing for f in faults]
    if any(hidden):
        record, columns = beside_tolerances(case)
    else:
        record, columns = healthy_record(case), np.zeros((1, 0))
    shown = []
    for fault, hides in zip(faults, hidden, strict=True):
        true = record.response(fault)
        shown.append(beside(true, columns) if hides else float(true @ true))
    same = [
        [] if case.classes else alike(record, f, columns if hides else None)
        for f, hides in zip(faults, hidden, strict=True)
    ]
    together = [[] for _ in faults] if case.classes else merged(record, faults)
    known = [[*dict.fromkeys([*a, *b])] for a, b in zip(same, together, strict=True)]
    return {"alike": list(known), "evidence": list(shown)}
