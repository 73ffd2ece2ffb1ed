"""The size at which a fault has the wanted signal-to-noise ratio."""

from __future__ import annotations

import math
from dataclasses import replace

from benchmarks.campaign.alike import beside, beside_tolerances
from benchmarks.campaign.cases import Case
from benchmarks.campaign.contact import Array
from benchmarks.campaign.effect_table import BY_NAME
from benchmarks.campaign.effects import Fault
from benchmarks.campaign.stage import SIZED_BY, Stage, rms

ROUNDS = 5


def snr_of(with_it: dict[str, Array], without: dict[str, Array], floor: dict[str, float]) -> float:
    """Return effect rms over noise rms in the strongest tension or speed."""
    return max(rms(with_it[c] - without[c]) / floor[c] for c in SIZED_BY)


def visible(case: Case, fault: Fault) -> float:
    """Return the share (0..1) of a fault's answer that declared tolerances cannot take up.

    Equation: square root of the chi-square beside tolerances over that without any.
    """
    record, columns = beside_tolerances(case)
    true = record.response(fault)
    left = beside(true, columns)
    return math.sqrt(max(left, 0.0) / max(float(true @ true), 1e-300))


def sized(
    case: Case, at: Stage, fault: Fault, healthy: dict[str, Array], floor: dict[str, float]
) -> tuple[Fault, float]:
    """Return the fault at the size that has the case's ratio, and the ratio it reaches.

    Of a fault without a line of its own only what tolerances cannot take up counts; the largest
    size of its row ends its growth where they take up nearly all.
    """
    row = BY_NAME[fault.effect]
    share = visible(case, fault) if math.isfinite(row.largest) else 1.0
    reached = share * snr_of(at.quiet((fault,)), healthy, floor)
    for _ in range(ROUNDS):
        if case.snr == 0.0 or abs(reached / case.snr - 1.0) < 0.05:
            break
        size = abs(fault.size) * case.snr / max(reached, 1e-9)
        size = math.copysign(min(size, row.largest), fault.size)
        if row.proportional:
            return replace(fault, size=size), reached * size / fault.size
        if row.step:
            size = row.step * max(1, round(size / row.step))
        if size == fault.size:
            break
        fault = replace(fault, size=size)
        reached = share * snr_of(at.quiet((fault,)), healthy, floor)
    return fault, reached
