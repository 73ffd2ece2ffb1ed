"""Findings in words, and as JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from aff_runtime.app.report.comparison.turns import FEWEST_TURNS
from aff_runtime.app.report.watching.findings import FRICTION, Finding, Readings, Unread
from aff_runtime.app.report.watching.store import Taken
from aff_runtime.app.report.watching.suppliers import MedianSize, SupplierRanking
from aff_runtime.app.report.watching.trend import FEWEST_READINGS, SIGMA, Slope
from aff_runtime.app.report.watching.wound_rolls import Ranking
from aff_runtime.base.confidence import TWO_SIDED_95
from aff_runtime.base.numbers import finite_or_none

SHOWN = {"m": ("um", 1e6), "rad": ("deg", math.degrees(1.0))}
"""Unit and factor in which sizes are shown; others are shown as they are."""
PER_KM = 1000.0  # a slope is shown per so many km
A_LONG_TIME_WEEKS = 520.0
MOST_ROLLS = 20
WHOLE = FEWEST_TURNS + 2
"""Turns in which so many are whole, wherever the first one begins."""


def unit_shown(unit: str) -> tuple[str, float]:
    """Return the unit in which sizes of an SI unit are shown, and the factor to it."""
    return SHOWN.get(unit, (unit, 1.0))


def notes(findings: Sequence[Finding]) -> Iterator[str]:
    """Yield what somebody should know: a trend beyond 4 sigma, and a jump that may be a change."""
    for one in findings:
        if one.jump is not None:
            yield _jumped(one)
        elif one.stands_out:
            yield _grows(one)


def table(findings: Sequence[Finding]) -> Iterator[str]:
    """Yield one line per quantity that has been read at all."""
    for one in findings:
        readings = one.readings
        count = readings.size.size
        counted = "reading" if count == 1 else "readings"
        left = f"; {readings.left_out} hours at another speed" if readings.left_out else ""
        head = (
            f"{_name(readings)} ({readings.signal}): {count} {counted} in "
            f"{np.ptp(readings.days):.0f} days at {readings.at_m_s:.3g} m/s{left}"
        )
        if one.per_km is None:
            told = (
                f"{_shown(readings, float(readings.size[-1]))}, too few for a trend: it takes "
                f"{FEWEST_READINGS} readings and web that ran between them"
            )
        else:
            told = f"{_size_now(readings, one.per_km)}, {_slope(readings, one.per_km)}"
        yield f"{head}; {told}{_sign(readings)}"


def unread(rolls: Sequence[Unread]) -> Iterator[str]:
    """Yield why there is no line of a roller, or of the roll of web that is on."""
    for one in rolls:
        yield (
            f"{one.roll}: no line, {_too_few(one.turns)}"
            f"{f', {WHOLE * one.turn_s:.0f} s at one speed' if one.turn_s > 0.0 else ''}"
        )


def _too_few(turns: int) -> str:
    return f"{turns} whole turns in its longest steady stretch, {FEWEST_TURNS} are needed"


def rolls(rankings: Sequence[Ranking]) -> Iterator[str]:
    """Yield the rolls of web of each place, the farthest from round first, ``MOST_ROLLS`` at most.

    A place at which no second roll ran has nothing to compare.
    """
    for one in rankings:
        if one.by is None or len(one.rolls) < 2:
            continue
        quantity = one.by
        yield f"rolls at {one.roll}, the farthest from round first, by their {quantity.word}:"
        for rank, roll in enumerate(one.rolls[:MOST_ROLLS], start=1):
            worst = roll.worst.get(quantity.name)
            unit, factor = unit_shown(quantity.unit)
            size = "not known"
            if worst is not None:
                interval = f"(+- {factor * TWO_SIDED_95 * worst.error:.2g})"
                size = f"{factor * worst.size:.4g} {unit} {interval} at {worst.order}x"
            elif 0 < roll.turns < FEWEST_TURNS:
                size = f"not known, {_too_few(roll.turns)}"
            yield (
                f"  {rank}. roll {roll.roll_id}: {size}, {roll.hours} hours from "
                f"{np.datetime_as_string(roll.first, 'D')} on"
            )
        if len(one.rolls) > MOST_ROLLS:
            yield f"  {len(one.rolls) - MOST_ROLLS} more"


def suppliers(rankings: Sequence[SupplierRanking]) -> Iterator[str]:
    """Yield the suppliers of each place, those first whose rolls are the farthest from round."""
    for one in rankings:
        if not one.suppliers:
            yield (
                f"rolls at {one.roll} are not ranked by supplier: the record has no number of it; "
                f"where the PLC has one, map it and name it as rolls.{one.roll}.supplier"
            )
            continue
        rolls = "1 roll" if one.unknown == 1 else f"{one.unknown} rolls"
        without = f"; {rolls} without a number" if one.unknown else ""
        yield (
            f"suppliers of rolls at {one.roll}, the farthest from round first, median of their "
            f"{one.by.word} (95 % interval){without}:"
        )
        unit, factor = unit_shown(one.by.unit)
        for rank, who in enumerate(one.suppliers[:MOST_ROLLS], start=1):
            sizes = [_median(m, unit, factor) for m in who.medians]
            if who.worst is not None:
                largest = f"{factor * who.worst.size:.3g} {unit} at {who.worst.order}x"
                sizes.append(f"worst roll {who.worst_roll}, {largest}")
            told = "; ".join(sizes) or "not known"
            count = "1 roll" if who.rolls == 1 else f"{who.rolls} rolls"
            yield f"  {rank}. supplier {who.number}: {count}, {told}"
        if len(one.suppliers) > MOST_ROLLS:
            yield f"  {len(one.suppliers) - MOST_ROLLS} more"


def _median(one: MedianSize, unit: str, factor: float) -> str:
    interval = "fewer than 6 rolls"
    if math.isfinite(one.low):
        interval = f"{factor * one.low:.3g} to {factor * one.high:.3g}"
    return f"{one.order}x {factor * one.size:.3g} {unit} ({interval})"


def taken(what: Taken) -> str:
    """Return what became of a run."""
    parts = [f"{what.new} hours new"]
    if what.lacking:
        parts.append(f"{what.lacking} of them without a steady stretch")
    if what.known:
        parts.append(f"{what.known} known already")
    if what.too_old:
        parts.append(f"{what.too_old} older than what was thinned out, left out")
    return ", ".join(parts)


@dataclass(frozen=True, slots=True, kw_only=True)
class LineSaid:
    """A slope with its 95 % interval, for programs."""

    value: float
    low: float
    high: float
    scatter: float
    readings: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Said:
    """A finding for programs, SI; what is not known is None."""

    signal: str
    roll: str
    order: int
    life: int
    quantity: str
    frequency_Hz: float | None
    readings: int
    hours_at_another_speed: int
    speed_m_s: float
    last: float
    limit: float | None
    stands_out: bool
    per_km: LineSaid | None
    per_day: LineSaid | None
    weeks_to_limit: tuple[float | None, ...] | None
    jump_on: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class SupplierSaid:
    """A supplier of rolls of web for programs, SI; its rank is its place in the list."""

    place: str
    supplier: int
    quantity: str
    rolls: int
    medians: tuple[MedianSaid, ...]
    worst_roll: int | None
    worst: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class MedianSaid:
    """The median of an order over the rolls of a supplier; low and high None of too few."""

    order: int
    median: float
    low: float | None
    high: float | None
    rolls: int


@dataclass(frozen=True, slots=True, kw_only=True)
class UnreadSaid:
    """A roll without a line for programs: it turned too little at one speed."""

    roll: str
    turns: int
    turns_needed: int
    turn_s: float | None


def as_json(
    line: str,
    findings: Sequence[Finding],
    rankings: Sequence[SupplierRanking] = (),
    unread: Sequence[Unread] = (),
) -> str:
    """Return findings, suppliers and rolls without a line for programs, SI; null: not known."""
    said = {
        "version": 1,
        "line": line,
        "findings": [asdict(_said(one)) for one in findings],
        "suppliers": [asdict(one) for ranking in rankings for one in _suppliers_said(ranking)],
        "without_a_line": [asdict(_unread_said(one)) for one in unread],
    }
    return json.dumps(said, allow_nan=False)


def _unread_said(one: Unread) -> UnreadSaid:
    return UnreadSaid(
        roll=one.roll,
        turns=one.turns,
        turns_needed=FEWEST_TURNS,
        turn_s=finite_or_none(one.turn_s),
    )


def _suppliers_said(ranking: SupplierRanking) -> Iterator[SupplierSaid]:
    for one in ranking.suppliers:
        yield SupplierSaid(
            place=ranking.roll,
            supplier=one.number,
            quantity=ranking.by.name,
            rolls=one.rolls,
            medians=tuple(
                MedianSaid(
                    order=m.order,
                    median=m.size,
                    low=finite_or_none(m.low),
                    high=finite_or_none(m.high),
                    rolls=m.rolls,
                )
                for m in one.medians
            ),
            worst_roll=one.worst_roll,
            worst=None if one.worst is None else one.worst.size,
        )


def _said(one: Finding) -> Said:
    readings, step = one.readings, one.jump
    return Said(
        signal=readings.signal,
        roll=readings.roll,
        order=readings.order,
        life=readings.life,
        quantity=readings.quantity.name,
        frequency_Hz=finite_or_none(readings.quantity.frequency_Hz),
        readings=int(readings.size.size),
        hours_at_another_speed=readings.left_out,
        speed_m_s=readings.at_m_s,
        last=float(readings.size[-1]),
        limit=finite_or_none(readings.limit),
        stands_out=one.stands_out,
        per_km=_line(one.per_km),
        per_day=_line(one.per_day),
        weeks_to_limit=None if one.weeks is None else tuple(finite_or_none(w) for w in one.weeks),
        jump_on=None if step is None else str(readings.times[step.index].astype("M8[D]")),
    )


def _line(line: Slope | None) -> LineSaid | None:
    if line is None:
        return None
    return LineSaid(
        value=line.value,
        low=line.low,
        high=line.high,
        scatter=line.scatter,
        readings=line.readings,
    )


def _grows(one: Finding) -> str:
    readings, line = one.readings, one.per_km
    assert line is not None
    verb = "grows" if line.value > 0.0 else "falls"
    text = (
        f"{_name(readings)} {verb}: {_slope(readings, line)}, beyond {SIGMA:g} sigma in "
        f"{np.ptp(readings.days):.0f} days; {_size_now(readings, line)}"
    )
    if math.isfinite(readings.quantity.frequency_Hz) and one.per_day is not None:
        text += f"; {_answers(readings, one.per_day)}"
    if one.weeks is not None:
        text += f"; reaches {_shown(readings, readings.limit)} in {_weeks(one.weeks)}"
    return text


def _answers(readings: Readings, line: Slope) -> str:
    """Return in plain words how a response changed from the first reading to the last."""
    first, last = (line.at(float(readings.days[at])) for at in (0, -1))
    since = np.datetime_as_string(readings.times[0], "D")
    where = f"at {readings.quantity.frequency_Hz:g} Hz than on {since}"
    off, more, less = last - first, "earlier", "later"
    shown = f"{math.degrees(abs(off)):.2g} deg"
    if readings.quantity.unit != "rad":
        more, less = "more", "less"
        shown = f"{100.0 * abs(off) / abs(first):.2g} %" if first else ""
    return f"the line answers {readings.roll} {shown} {more if off > 0.0 else less} {where}"


def _jumped(one: Finding) -> str:
    readings, step = one.readings, one.jump
    assert step is not None
    day = np.datetime_as_string(readings.times[step.index], "D")
    text = (
        f"{_name(readings)} jumped from {_shown(readings, step.before)} to "
        f"{_shown(readings, step.after)} on or before {day}: "
    )
    if not readings.quantity.of_roller:
        return text + "what was changed at drive or web?"
    return text + (
        f"was {readings.roll} exchanged? "
        f"If so: aff-runtime watch exchange STORE {readings.roll} --on {day}"
    )


def _name(readings: Readings) -> str:
    life = f", life {readings.life}" if readings.life > 1 else ""
    order = f" {readings.order}x" if readings.order else ""
    return f"{readings.roll}{order} {readings.quantity.word}{life}"


def _slope(readings: Readings, line: Slope) -> str:
    unit, factor = unit_shown(readings.quantity.unit)
    value, low, high = (f"{PER_KM * factor * v:.3g}" for v in (line.value, line.low, line.high))
    return f"{value} {unit} per 1000 km ({low} to {high})".replace("  ", " ")


def _sign(readings: Readings) -> str:
    """Return what is said of a friction beyond doubt below 0, which no drive has."""
    highest = readings.size + SIGMA * readings.error
    is_below = readings.quantity is FRICTION and float(np.median(highest)) < 0.0
    return "; below 0: sign of torque" if is_below else ""


def _size_now(readings: Readings, line: Slope) -> str:
    return f"{_shown(readings, line.at(float(readings.travelled_km[-1])))} now"


def _shown(readings: Readings, size: float) -> str:
    unit, factor = unit_shown(readings.quantity.unit)
    return f"{factor * size:.3g} {unit}".strip()


def _weeks(weeks: tuple[float, float, float]) -> str:
    if weeks[0] > A_LONG_TIME_WEEKS:
        return "more than 10 years"
    factor, word = (7.0, "day") if weeks[0] < 1.0 else (1.0, "week")
    value, low, high = (factor * one for one in weeks)
    count = round(value)
    about = f"about {count} {word}" + ("" if count == 1 else "s")
    end = f"to {high:.1f} {word}s" if math.isfinite(high) else f"{word}s at least"
    return f"{about if count else 'less than a day'} ({low:.1f} {end})"
