"""The size at which a fault has the wanted signal-to-noise ratio."""

from __future__ import annotations

import math
from dataclasses import replace

from benchmarks.campaign.alike import beside, beside_tolerances
from benchmarks.campaign.cases import Case
from benchmarks.campaign.contact import Array
from benchmarks.campaign.effect_table import BY_NAME
from benchmarks.campaign.fault import Fault
from benchmarks.campaign.stage import SIZED_BY, Stage, rms

ROUNDS = 5
HALVINGS = 10
"""Further rounds where one size is too small and one too large: a limit that is not reached shows
nothing, and a little lower the line does not follow any more."""
MOST = 1e4


def snr_of(with_it: dict[str, Array], without: dict[str, Array], floor: dict[str, float]) -> float:
    """Return effect rms over noise rms in the strongest tension or speed, ``MOST`` at most.

    A loop that an effect makes unstable has no finite answer.
    """
    ratios = [rms(with_it[c] - without[c]) / floor[c] for c in SIZED_BY]
    return min(MOST, max(r if math.isfinite(r) else MOST for r in ratios))


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
    size of its form ends its growth where they take up nearly all.
    """
    row = BY_NAME[fault.effect]
    form = row.form(fault)
    standing = row.standing and not case.classes
    share = visible(case, fault) if standing else 1.0
    reached = share * snr_of(at.quiet((fault,)), healthy, floor)
    power, size = 1.0, abs(fault.size)
    small, large = 0.0, math.inf
    for turn in range(ROUNDS + HALVINGS):
        bracketed = 0.0 < small < large < math.inf
        near = case.snr == 0.0 or abs(reached / case.snr - 1.0) < 0.05
        if near or (turn >= ROUNDS and not bracketed):
            break
        if reached < case.snr:
            small = max(small, size)
        else:
            large = min(large, size)
        before, size = size, size * (case.snr / max(reached, 1e-9)) ** (1.0 / power)
        if 0.0 < small < large < math.inf and not small < size < large:
            size = math.sqrt(small * large)
        size = min(max(size, form.least), form.largest)
        if form.proportional:
            return replace(fault, size=math.copysign(size, fault.size)), reached * size / before
        if form.step:
            size = form.step * max(1, round(size / form.step))
        if size == before:
            break
        fault, last = replace(fault, size=math.copysign(size, fault.size)), reached
        if last == 0.0 and standing:
            share = visible(case, fault)  # of nothing no share is told
        reached = share * snr_of(at.quiet((fault,)), healthy, floor)
        # how steeply it really grows, for what is no straight line
        slope = math.log(max(reached, 1e-9) / max(last, 1e-9)) / math.log(size / before)
        power = min(max(slope, 0.3), 3.0)
    return fault, reached
