"""What is translated, and what of it differs from lane to lane."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from typing import Any, get_type_hints

import numpy as np

from sim_plant.base import arrays as records
from sim_plant.codegen.kinds import (
    FLOAT,
    INT,
    ArrayOf,
    Base,
    Kind,
    RecordArray,
    Scalar,
    Struct,
    TranslationError,
)
from sim_plant.line.equations import kernel
from sim_plant.line.equations.kernel import Work
from sim_plant.line.equations.layout import Layout
from sim_plant.line.equations.log_layout import LogLayout

RECORDS: dict[str, np.dtype[Any]] = {
    name: getattr(records, name)
    for name in (
        "BODY",
        "SPAN",
        "WEB",
        "DRIVE",
        "CELL",
        "LOOP",
        "RIPPLE",
        "CHANGE",
        "TIMING",
        "HEAT",
        "CARRIAGE",
    )
}
STRUCTS: dict[str, type] = {
    made.__name__: made
    for made in (records.LineArrays, records.LineState, Work, Layout, LogLayout)
}
RECORD_FIELDS = {
    "bodies": "BODY",
    "spans": "SPAN",
    "web": "WEB",
    "drives": "DRIVE",
    "cells": "CELL",
    "loops": "LOOP",
    "ripples": "RIPPLE",
    "changes": "CHANGE",
    "heats": "HEAT",
    "carriages": "CARRIAGE",
    "timing": "TIMING",
}
MATRICES = ("shape_h_m", "shape_dh_m", "shape_rho_m", "delay_m_s", "contacts", "rates")
"""Fields of the named tuples that are arrays of two axes; the others have one."""


@cache
def _fields_of(struct: str) -> dict[str, type]:
    """Return the fields of a named tuple by name; a translation asks a thousand times."""
    return get_type_hints(STRUCTS[struct])


@dataclass(frozen=True, kw_only=True)
class EntryPoint:
    """A function that others call: its arrays by number of axes, and which differ by lane."""

    name: str
    axes: dict[str, int] = field(default_factory=dict)
    per_lane: frozenset[str] = frozenset()


@dataclass(frozen=True, kw_only=True)
class Target:
    """What one translation makes.

    Attributes
    ----------
    lanes : several lines side by side; else one, and every value is plain.
    shared : ``RECORD.field`` or ``Tuple.field`` that is the same in every lane.
    """

    entries: tuple[EntryPoint, ...]
    lanes: bool = False
    shared: frozenset[str] = frozenset()

    def differs(self, name: str) -> bool:
        """Return whether a field has another value in each lane."""
        return self.lanes and name not in self.shared

    def record_field(self, record: str, name: str) -> Scalar:
        """Return what a field of a record is; TranslationError for an unknown one."""
        fields = RECORDS[record].fields
        if fields is None or name not in fields:
            raise TranslationError(f"{record} has no field {name}")
        base: Base = "int" if fields[name][0].kind == "i" else "float"
        return Scalar(base, self.differs(f"{record}.{name}"))

    def struct_field(self, struct: str, name: str) -> Kind:
        """Return what a field of a named tuple is; TranslationError for an unknown one."""
        hint = _fields_of(struct).get(name)
        if hint is None:
            raise TranslationError(f"{struct} has no field {name}")
        if hint in (int, float):
            return INT if hint is int else FLOAT
        if name in RECORD_FIELDS:
            return RecordArray(RECORD_FIELDS[name])
        base: Base = "int" if hint == records.IntArray else "float"
        return ArrayOf(base, 2 if name in MATRICES else 1, self.differs(f"{struct}.{name}"))

    def arguments(self, entry: EntryPoint) -> dict[str, Kind]:
        """Return what each argument of an entry is."""
        hints = get_type_hints(getattr(kernel, entry.name).py_func)
        hints.pop("return")
        found: dict[str, Kind] = {}
        for name, hint in hints.items():
            if hint in (int, float):
                found[name] = INT if hint is int else FLOAT
            elif hint == records.Array:
                lanes = self.lanes and name in entry.per_lane
                found[name] = ArrayOf("float", entry.axes.get(name, 1), lanes)
            else:
                found[name] = Struct(hint.__name__)
        return found


FRAMES = {"line_speed_m_s": 2, "tension_ref_N": 2, "aff_m_s": 2, "noise": 2, "out": 2}
SCALAR = Target(
    entries=(
        EntryPoint(name="run_frames", axes=FRAMES),
        EntryPoint(name="step_frame"),
        EntryPoint(name="advance_frame"),
        EntryPoint(name="measure"),
        EntryPoint(name="log_frame"),
    )
)

LANES = Target(
    entries=(
        EntryPoint(name="advance_frame", per_lane=frozenset({"noise"})),
        EntryPoint(name="log_frame", per_lane=frozenset({"row"})),
    ),
    lanes=True,
    shared=frozenset(
        {
            *(f"TIMING.{name}" for name in records.TIMING.names or ()),
            "BODY.kind",
            "BODY.carriage",
            "SPAN.heat_first",
            "SPAN.heat_parts",
            "CARRIAGE.pendulum",
            "DRIVE.body",
            "DRIVE.loop",
            "CELL.body",
            "LOOP.cell",
            "LOOP.carriage",
            "LineState.counters",
            "LineState.time_s",
        }
    ),
)
