"""A settled line as C: its sizes, its numbers, its state, its tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from sim_plant.base.arrays import LineArrays, LineState
from sim_plant.codegen.target import RECORD_FIELDS
from sim_plant.export.c_text import c_bound, c_string
from sim_plant.export.interface import Interface
from sim_plant.line.running.simulation import LineSimulation

SHAPES = {"shape_h_m": "SHAPE_H", "shape_dh_m": "SHAPE_DH", "shape_rho_m": "SHAPE_RHO"}
OWN = (
    "EA_N",
    "wound_in_tension_N",
    "settle_s",
    "sample_time_s",
    "splice_EA_ratio",
    "splice_thickness_ratio",
    "splice_step_m",
    "splice_piece_m",
)
WHOLE = ("noise", "seed")
SCRATCH = ("moving", "contacts", "tensions")
"""Of the scratch memory: what stands there from the start on, or is logged."""


def line_data(line: LineSimulation, interface: Interface, token: str, fastest_rad_s: float) -> str:
    """Return ``line_data.h`` for a settled line.

    Parameters
    ----------
    token : what tells this model from another one.
    fastest_rad_s : fastest mode, by which a line with other parameters chooses its steps.
    """
    starts = {v.place.removeprefix("numbers."): v.start for v in interface.variables}
    state = [*_settled(line)]
    sections = (
        "/* Made from a line file by sim_plant.export; not by hand. */",
        _sizes(line, interface),
        *_meanings(line, starts, token, fastest_rad_s),
        _numbers_type(line.arrays),
        _state_type(state),
        "static const channel CHANNELS[OUTPUTS] = {",
        *(channel.c_row for channel in interface.channels),
        "};",
        *(_table(name, getattr(line.arrays, field)) for field, name in SHAPES.items()),
        _numbers(line.arrays, starts),
        "static const line_state STATE = {",
        *(f"    {_braces(values)}," for _name, values in state),
        "};",
    )
    return "\n".join(sections) + "\n"


def line_variables(interface: Interface) -> str:
    """Return ``line_variables.h``: what may be set and read, by value reference."""
    rows = []
    for found in interface.variables:
        kind = {"real": "REAL", "integer": "INTEGER", "truth": "TRUTH"}[found.kind]
        bounds = f"{c_bound(found.low)}, {c_bound(found.high)}"
        place = f"offsetof(line_memory, {found.place})"
        rows.append(f"    {{{c_string(found.name)}, {kind}, {found.when}, {place}, {bounds}}},")
    head = "/* Made from a line file by sim_plant.export; not by hand. */\n"
    return head + "\n".join(("static const variable VARIABLE[VARIABLES] = {", *rows, "};")) + "\n"


def _sizes(line: LineSimulation, interface: Interface) -> str:
    p, timing = line.arrays, line.timing
    sizes = {
        "BODIES": p.bodies.size,
        "SPANS": p.spans.size,
        "DRIVES": p.drives.size,
        "CELLS": p.cells.size,
        "LOOPS": p.loops.size,
        "RIPPLES": p.ripples.size,
        "CHANGES": p.changes.size,
        "HEATS": p.heats.size,
        "CARRIAGES": p.carriages.size,
        "LOOPS_": max(1, p.loops.size),
        "CHANGES_": max(1, p.changes.size),
        "SHAPES": p.shape_h_m.shape[0],
        "POINTS": p.shape_h_m.shape[1],
        "STATES": line.layout.size,
        "RING": line.state.delay_m_s.shape[1],
        "CONTACTS": line.work.contacts.shape[1],
        "TICKS_PER_FRAME": timing.ticks_per_frame,
        "FRAMES_PER_SAMPLE": timing.frames_per_sample,
        "LOGGED": line.log.width,
        "ROW": line.log.width + p.drives.size + 1,
        "OUTPUTS": len(interface.channels),
        "VARIABLES": len(interface.variables),
        "UNWIND": 2,
    }
    return "\n".join(("enum {", *(f"    {name} = {n}," for name, n in sizes.items()), "};"))


def _meanings(
    line: LineSimulation, starts: Mapping[str, float | None], token: str, fastest_rad_s: float
) -> Iterator[str]:
    yield f"#define TOKEN {c_string(token)}"
    yield f"#define SAMPLE_TIME_S {float(line.sample_time_s)!r}"
    yield f"#define START_SPEED_M_S {_start(starts, 'line_speed_ref_m_s')!r}"
    yield f"#define START_TENSION_N {_start(starts, 'tension_ref_N[0]')!r}"
    yield f"#define FASTEST_RAD_S {fastest_rad_s!r}"
    yield f"#define LINE_LAYOUT {{{', '.join(str(offset) for offset in line.layout)}}}"


def _start(starts: Mapping[str, float | None], place: str) -> float:
    return float(starts.get(place) or 0.0)


def _numbers_type(p: LineArrays) -> str:
    fields = [
        f"    {record} {name}[{max(1, getattr(p, name).size)}];"
        for name, record in RECORD_FIELDS.items()
    ]
    fields += [f"    double {', '.join(OWN)};", f"    int64_t {', '.join(WHOLE)};"]
    return "\n".join(("typedef struct {", *fields, "} line_numbers;"))


def _numbers(p: LineArrays, starts: Mapping[str, float | None]) -> str:
    rows = [f"    {{{_records(getattr(p, name))}}}," for name in RECORD_FIELDS]
    rows += [f"    {_start(starts, name)!r}," for name in OWN]
    rows += [f"    {int(_start(starts, name))}," for name in WHOLE]
    return "\n".join(("static const line_numbers NUMBERS = {", *rows, "};"))


def _records(records: np.ndarray[Any, Any]) -> str:
    if records.size == 0:
        return "{0}"
    rows = ("{" + ", ".join(_number(value) for value in record) + "}" for record in records)
    return ", ".join(rows)


def _number(value: Any) -> str:
    if isinstance(value, int | np.integer):
        return str(int(value))
    return c_bound(float(value))


def _settled(line: LineSimulation) -> Iterator[tuple[str, np.ndarray[Any, Any]]]:
    """Yield the state by name; of the ring of corrections what may still be asked for."""
    values = line.state._asdict() | {"delay_m_s": _awaited(line.arrays, line.state)}
    yield from values.items()
    for name in SCRATCH:
        yield name, getattr(line.work, name)


def _awaited(p: LineArrays, state: LineState) -> np.ndarray[Any, Any]:
    kept = np.zeros_like(state.delay_m_s)
    for d, ticks in enumerate(p.drives["delay_ticks"]):
        for back in range(1, int(ticks) + 1):
            at = (int(state.counters[1]) - back) % kept.shape[1]
            kept[d, at] = state.delay_m_s[d, at]
    return kept


def _state_type(state: list[tuple[str, np.ndarray[Any, Any]]]) -> str:
    fields = [
        f"    {'int64_t' if values.dtype.kind == 'i' else 'double'} {name}[{max(1, values.size)}];"
        for name, values in state
    ]
    return "\n".join(("typedef struct {", *fields, "} line_state;"))


def _braces(values: np.ndarray[Any, Any]) -> str:
    flat = values.ravel()
    last = int(np.flatnonzero(flat)[-1]) + 1 if np.any(flat) else 1  # C fills up with zeros
    return "{" + (", ".join(_number(value) for value in flat[:last]) or "0") + "}"


def _table(name: str, values: np.ndarray[Any, Any]) -> str:
    return f"static const double {name}[SHAPES * POINTS] = {_braces(values)};"
