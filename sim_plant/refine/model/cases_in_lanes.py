"""Cases of one twin side by side in the lanes of the processor; one by one where that fails."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.lanes.library import Lanes, fitting
from sim_plant.lanes.packing import make_of
from sim_plant.lanes.side_by_side import SideBySide
from sim_plant.line.running.simulation import LineSimulation
from sim_plant.refine.model.twin import Case, Twin, seen_by

Job = tuple[int, Case]
"""A case and the number of the twin that runs it."""


def nothing_of(twin: Twin) -> Array:
    """Return the channels of a case that makes no line that runs: all NaN."""
    return np.full((len(twin.channels), twin.speed_m_s.size), np.nan)


def attempt(twin: Twin, case: Case) -> Array:
    """Return the channels of a case, all NaN when these numbers make no line that runs."""
    try:
        return twin.simulate(case)
    except PlantError:
        return nothing_of(twin)


def in_groups(
    jobs: Sequence[Job], width: int, rollers: Sequence[str] = ()
) -> list[tuple[int, tuple[Case, ...]]]:
    """Return jobs as groups that may run side by side, cases of the same bodies together.

    ``rollers`` are the names of the line's bodies in web order: neighbours have a span in common,
    and a tangent that one lane needs costs the time of all. A width of 1 keeps the order.
    """
    if width == 1:
        return [(twin, (case,)) for twin, case in jobs]
    groups: list[tuple[int, tuple[Case, ...]]] = []
    last: tuple[object, ...] = ()
    place = {name: number for number, name in enumerate(rollers)}
    for twin, case in sorted(jobs, key=lambda job: (_kind(job), _likeness(job[1], place))):
        kind = _kind((twin, case))
        if kind == last and len(groups[-1][1]) < width:
            groups[-1] = (twin, (*groups[-1][1], case))
        else:
            groups.append((twin, (case,)))
        last = kind
    return groups


def _kind(job: Job) -> tuple[int, bool, bool]:
    """Return what jobs side by side have in common: twin, drive tick, noise or none."""
    return job[0], job[1].quick, job[1].seed is None


def _likeness(case: Case, place: Mapping[str, int]) -> tuple[object, ...]:
    """Return what cases are sorted by: bodies with ripples, then effects and where they are."""
    bodies = sorted({body for body, *_ in case.ripples})
    effects = [(e.effect, place.get(e.location, -1), e.location) for e in case.effects]
    return bodies, effects


def takes_lanes(twin: Twin) -> bool:
    """Return whether a twin's own `simulate` is that of `Twin`; others are run one by one."""
    return getattr(type(twin), "simulate", None) is Twin.simulate


def simulated(twin: Twin, number: int, cases: Sequence[Case]) -> list[Array]:
    """Return the channels of each case of the twin with this number, as ``attempt`` does."""
    seen = [seen_by(case, number) for case in cases]
    if not takes_lanes(twin) or fitting(1) is None:
        return [attempt(twin, case) for case in seen]
    by_case: dict[int, Array] = {}
    alike: dict[bytes, list[tuple[int, LineSimulation]]] = {}
    for at, case in enumerate(seen):
        try:
            line = twin.line(case)
        except PlantError:
            by_case[at] = nothing_of(twin)
            continue
        alike.setdefault(make_of(line), []).append((at, line))
    for members in alike.values():
        lanes = fitting(len(members))
        assert lanes is not None  # there is one for a single line
        for first in range(0, len(members), lanes.width):
            places, lines = zip(*members[first : first + lanes.width], strict=True)
            records = _side_by_side(twin, lanes, [seen[at] for at in places], lines)
            by_case.update(zip(places, records, strict=True))
    return [by_case[at] for at in range(len(seen))]


def _side_by_side(
    twin: Twin, lanes: Lanes, cases: Sequence[Case], lines: Sequence[LineSimulation]
) -> list[Array]:
    """Return the channels of each case, its line already made; all NaN where it breaks down."""
    settling = [
        line.settling(case.settle_s, quiet=case.seed is None)
        for line, case in zip(lines, cases, strict=True)
    ]
    runs = SideBySide(lanes.functions, lanes.width, lines)
    for given in zip(*settling, strict=True):
        runs.run(given[0])  # the same for all: one twin
    for line, case in zip(lines, cases, strict=True):
        for offset in case.start:
            offset.put(line)
    running = [line for line in lines if np.isfinite(line.state.y).all()]
    if not running:
        return [nothing_of(twin) for _ in cases]
    if len(running) < len(lines):
        runs = SideBySide(lanes.functions, lanes.width, running)
    outputs = [line.measured(twin.channels) for line in running]
    given = twin.references(running[0])
    logs = runs.run(given, outputs[0].columns, running[0].timing.frames_per_sample)
    records = {
        id(line): columns.read(log)
        for line, columns, log in zip(running, outputs, logs, strict=True)
        if np.isfinite(line.state.y).all()
    }
    return [
        twin.in_words(records[id(line)], case.seed) if id(line) in records else nothing_of(twin)
        for line, case in zip(lines, cases, strict=True)
    ]
