"""What contradicts itself in dancers, accumulators and heated spans of a declaration."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Hashable, Iterator, Sequence
from typing import TypeVar

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.line.declared.declaration import CarriagePosition, Declaration
from sim_plant.line.declared.declared_bodies import (
    Accumulator,
    LinearDancer,
    PendulumDancer,
    section_of,
)
from sim_plant.line.rest.operating_point import declared_line
from sim_plant.line.rest.resting_bodies import spans_at

T = TypeVar("T", bound=Hashable)


def bodies_findings(line: Declaration) -> list[str]:
    """Return contradictions as sentences; for a line whose rollers and spans agree."""
    findings = [*_of_carriages(line), *_of_loops(line), *_of_heat(line)]
    if not findings:
        findings += _of_travels(line)
    return findings


def _where(carriage: LinearDancer | PendulumDancer | Accumulator) -> str:
    """Return where a carriage stands in the file."""
    return f"{section_of(carriage)}.{carriage.name}"


def _of_carriages(line: Declaration) -> Iterator[str]:
    kinds = {roller.name: roller.kind for roller in line.rollers}
    names = [carriage.name for carriage in line.carriages]
    yield from (f"dancers, accumulators: {n} appears twice" for n in _twice(names))
    mounted = [roller for carriage in line.carriages for roller in carriage.rollers]
    for roller in _twice(mounted):
        yield f"dancers, accumulators: roller {roller} moves with two of them, or is named twice"
    for carriage in line.carriages:
        where = _where(carriage)
        for roller in carriage.rollers:
            if roller not in kinds:
                yield f"{where}.rollers: roller {roller} does not exist"
            elif kinds[roller] != "idler":
                yield f"{where}.rollers: read {roller} of kind {kinds[roller]}; expected idlers"
        low, high = carriage.travel_m
        if not low < high or not low <= 0.0 <= high:
            yield (
                f"{where}.travel_m: read [{low}, {high}]; expected stops on both sides of 0, "
                "where the file puts the rollers"
            )
        if isinstance(carriage, Accumulator):
            yield from _of_schedule(where, carriage)
        elif isinstance(carriage, PendulumDancer) and carriage.rollers[0] in kinds:
            first = line.rollers[line.body(carriage.rollers[0])]
            arm = math.hypot(
                first.center_x_m - carriage.pivot_x_m, first.center_y_m - carriage.pivot_y_m
            )
            if not arm > 0.0:
                yield f"{where}.pivot_x_m: the pivot is the centre of {first.name}; it has no arm"
    for sensor in line.sensors:
        if isinstance(sensor, CarriagePosition) and sensor.roller not in mounted:
            yield (
                f"sensors.{sensor.channel}: {sensor.roller} moves with no dancer and no "
                f"accumulator; expected one of {mounted}"
            )


def _of_schedule(where: str, carriage: Accumulator) -> Iterator[str]:
    if carriage.schedule and carriage.drive is None:
        yield f"{where}.schedule: nothing follows it; declare the carriage's drive"
    for number, move in enumerate(carriage.schedule):
        if not move.until_s >= move.from_s + move.rise_s:
            yield (
                f"{where}.schedule.{number}.until_s: read {move.until_s}; expected at least "
                f"from_s + rise_s = {move.from_s + move.rise_s}"
            )


def _of_loops(line: Declaration) -> Iterator[str]:
    driven = {drive.roller for drive in line.control.drives}
    names = {carriage.name: carriage for carriage in line.carriages}
    loops = line.control.position_pi
    acting = [t.acts_on for t in line.control.tension_pi] + [loop.acts_on for loop in loops]
    if loops:
        yield from (f"control.position_pi: {n} is trimmed by two loops" for n in _twice(acting))
    yield from (
        f"control.position_pi: {n} is held by two loops"
        for n in _twice([p.carriage for p in loops])
    )
    for loop in loops:
        where = f"control.position_pi.{loop.loop}"
        if loop.acts_on not in driven:
            yield f"{where}.acts_on: no drive on {loop.acts_on}"
        if loop.carriage not in names:
            expected = sorted(names)
            yield f"{where}.carriage: read {loop.carriage!r}; expected one of {expected}"
            continue
        carriage = names[loop.carriage]
        low, high = carriage.travel_m
        if not low < loop.position_m < high:
            yield (
                f"{where}.position_m: read {loop.position_m}; expected a travel between the stops "
                f"{low} and {high}"
            )
        if isinstance(carriage, Accumulator) and carriage.drive is not None:
            yield f"{where}.carriage: {carriage.name} has a drive of its own, which holds it"
    for carriage in line.carriages:
        held = carriage.name in {loop.carriage for loop in loops}
        driven_itself = isinstance(carriage, Accumulator) and carriage.drive is not None
        if not (held or driven_itself or _stiffness(carriage) > 0.0):
            yield (
                f"{_where(carriage)}: nothing holds it between its stops; declare a loop in "
                "control.position_pi, a stiffness, or an accumulator's drive"
            )


def _stiffness(carriage: LinearDancer | PendulumDancer | Accumulator) -> float:
    if isinstance(carriage, LinearDancer):
        return carriage.stiffness_N_m
    return carriage.stiffness_N_m_rad if isinstance(carriage, PendulumDancer) else 0.0


def _of_heat(line: Declaration) -> Iterator[str]:
    spans = [(span.start, span.end) for span in line.spans]
    heated = [(given.start, given.end) for given in line.heated_spans]
    yield from (
        f"heated_spans: {n} appears twice" for n in _twice([h.name for h in line.heated_spans])
    )
    yield from (f"heated_spans: {a}-{b} is heated twice" for a, b in _twice(heated))
    for given in line.heated_spans:
        if (given.start, given.end) not in spans:
            yield (
                f"heated_spans.{given.name}: read {given.start}-{given.end}; expected the two "
                "rollers of one span, in web order"
            )
    if heated and line.web.thermal_expansion_1_K == 0.0:
        yield "web.thermal_expansion_1_K: a line with heated spans needs the web's expansion"


def _of_travels(line: Declaration) -> Iterator[str]:
    """Yield what is wrong with the spans somewhere between the stops."""
    resting = declared_line(line)
    if resting.bodies is None or not line.carriages:
        return
    for c, carriage in enumerate(line.carriages):
        low, high = carriage.travel_m
        travel_m = np.zeros((21, len(line.carriages)))
        travel_m[:, c] = np.linspace(low, high, 21)
        with np.errstate(invalid="ignore"):
            spans = spans_at(resting.bodies, resting.radius_m, travel_m)
        where = _where(carriage)
        without = np.argwhere(~np.isfinite(spans.length_m))
        if without.size:
            row, i = without[0]
            pair = f"{line.spans[i].start}-{line.spans[i].end}"
            yield (
                f"{where}.travel_m: at {travel_m[row, c]:.4g} m the bodies of {pair} overlap; "
                "correct the travel or the centres"
            )
            continue
        yield from _direction(line, c, where, spans.lever_a, spans.lever_b)


def _direction(
    line: Declaration, c: int, where: str, lever_a: Array, lever_b: Array
) -> Iterator[str]:
    mounted = np.array([line.carriage_of(r.name) == c for r in line.rollers])
    growth = np.sum(lever_b * mounted[1:] - lever_a * mounted[:-1], axis=-1)
    if not np.min(growth) > 0.05:
        key = "rotation" if isinstance(line.carriages[c], PendulumDancer) else "direction_deg"
        yield (
            f"{where}.{key}: somewhere between the stops the path grows by {np.min(growth):.3g} m "
            "per metre of travel; expected more than 0.05: turn it round, or look at the centres"
        )


def _twice(names: Sequence[T]) -> list[T]:
    return [name for name, count in Counter(names).items() if count > 1]
