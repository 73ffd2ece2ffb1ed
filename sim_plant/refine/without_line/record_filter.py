"""Records without a line declaration: what is declared of them, and how they are read."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable
from sim_plant.base.arrays import Array
from sim_plant.base.plain_file import read_plain
from sim_plant.line.declared.sections import Name
from sim_plant.line.reading.load import Source
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.noise.innovations import whitening_filter
from sim_plant.refine.records.limits import FILE_BYTES
from sim_plant.refine.records.read import read_record
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.records.sanity import oddities
from sim_plant.refine.records.text_table import number_table
from sim_plant.refine.without_line.general.effect import OutputRecord
from sim_plant.refine.without_line.stamps import Stamped, on_declared_grid

SCHEMA = "record-declaration/1"
MOST_FILTER_VALUES = 100_000_000
"""Rows times shifted inputs: 0.8 GB as doubles, held twice. An hour at 10 Hz has 4 million with
one input and 60 taps on either side."""
WITHOUT_LINE = CRITERIA.without_line


class RecordDeclaration(BaseModel):
    """What is known of a record that no line declaration belongs to."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    schema_: Literal["record-declaration/1"] = Field(alias="schema")
    note: str = ""
    columns: tuple[Name, ...] | None = Field(default=None, description="names, without a header")
    sample_time_s: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    outputs: tuple[Name, ...] = Field(min_length=1)
    inputs: tuple[Name, ...] = Field(default=(), description="none: outputs alone")
    derivative_of_inputs: bool = False
    taps: Annotated[int, Field(ge=1, le=500)] = Field(
        default=40, description="furthest shift of an input in the filter to either side, samples"
    )
    travel_speed: Name | None = Field(
        default=None, description="column with the web's own speed, no draw or ratio, m/s"
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Remainder:
    """A record less what inputs and general effects explain.

    Attributes
    ----------
    record : what was read.
    residual : outputs less what is explained (outputs, samples).
    outputs : as measured (outputs, samples).
    inputs : as read (inputs, samples).
    travel_m : integral of the web's speed, or None.
    speed_m_s : the web's speed, or None.
    """

    record: Recording
    residual: Array
    outputs: Array
    inputs: Array
    travel_m: Array | None
    speed_m_s: Array | None

    @property
    def whitened(self) -> Array:
        """Residual innovations of unit variance (outputs, samples)."""
        return np.stack([whiten(row) for row in self.residual])


def whiten(row: Array) -> Array:
    """Return unit-variance innovations of one series; its first samples are zero."""
    ar_weights, sd = whitening_filter(row[None, :])
    if sd == 0.0:
        return np.zeros_like(row)
    found = np.convolve(row - row.mean(), ar_weights)[: row.size] / sd
    found[: ar_weights.size] = 0.0
    return found


def is_record_declaration(source: Source) -> bool:
    """Return whether a file declares records instead of a line."""
    return isinstance(source.data, dict) and source.data.get("schema") == SCHEMA


def record_declaration_in(source: Source) -> RecordDeclaration:
    """Return the declaration; PlantError with key and reason when it is wrong."""
    path = source.path
    try:
        return RecordDeclaration.model_validate(source.data)
    except ValidationError as error:
        lines = [
            f"{path}: {printable('.'.join(map(str, e['loc'])), 200)}: "
            f"read {printable(repr(e.get('input')), 60)}; {e['msg']}"
            for e in error.errors()
        ]
        raise PlantError("\n".join(lines)) from error


def read_stamped(declaration: RecordDeclaration, path: Path) -> Stamped:
    """Return a record under this declaration; headerless files take its column names.

    Raises
    ------
    PlantError
        When a declared column is missing, or the record cannot be read or is too short.
    """
    has_header = declaration.columns is None
    record = read_record(path) if has_header else _headerless(declaration, path)
    used = {*declaration.outputs, *declaration.inputs}
    if declaration.travel_speed:
        used.add(declaration.travel_speed)
    absent = sorted(used - set(record.columns))
    if absent:
        raise PlantError(
            f"{path}: column {absent[0]} is missing; there are {sorted(record.columns)}"
        )
    least = 2 * declaration.taps + WITHOUT_LINE.rows_beyond_taps
    if record.samples < least:
        raise PlantError(
            f"{path}: {record.samples} rows are too few for a filter of {declaration.taps} taps "
            f"on both sides; give at least {least}, or fewer taps"
        )
    width = 1 + len(declaration.inputs) * (2 * declaration.taps + 1)
    if record.samples * width > MOST_FILTER_VALUES:
        raise PlantError(
            f"{path}: {record.samples} rows under a filter of {width} weights are "
            f"{record.samples * width} values, more than {MOST_FILTER_VALUES}; declare fewer taps "
            "or inputs, or cut the record"
        )
    if declaration.travel_speed:
        onward = float(np.mean(record.columns[declaration.travel_speed] > 0.0))
        if onward < WITHOUT_LINE.onward_share:
            raise PlantError(
                f"{path}: column {declaration.travel_speed} is above 0 in {100 * onward:.0f} % of "
                "the rows; travel_speed is the speed of a web that runs, counted forwards: "
                "correct it, or leave travel_speed empty"
            )
    if (
        abs(record.sample_time_s - declaration.sample_time_s)
        > WITHOUT_LINE.sample_time_share * declaration.sample_time_s
    ):
        raise PlantError(
            f"{path}: sampled every {record.sample_time_s:.5g} s, declared "
            f"{declaration.sample_time_s} s; correct sample_time_s"
        )
    if not has_header:
        return Stamped(record=record, time_s=None, readings={})
    return on_declared_grid(record, declaration.sample_time_s)


def _headerless(declaration: RecordDeclaration, path: Path) -> Recording:
    names = declaration.columns or ()
    payload = read_plain(path, FILE_BYTES)
    table = number_table(path, payload, len(names))
    bad = np.argwhere(~(np.abs(table) < CRITERIA.records.largest_reading))
    if bad.size:
        raise PlantError(
            f"{path}: column {names[bad[0][1]]}: no reading in file line {bad[0][0] + 1}"
        )
    columns = {n: table[:, k].copy() for k, n in enumerate(names)}
    return Recording(
        path=path,
        sha256=hashlib.sha256(payload).hexdigest(),
        sample_time_s=declaration.sample_time_s,
        columns=columns,
        findings=tuple(oddities(columns)),
    )


def output_record(declaration: RecordDeclaration, record: Recording, output: str) -> OutputRecord:
    """Return one output of a record with all inputs."""
    speed = declaration.travel_speed
    return OutputRecord(
        output=record.columns[output],
        inputs={name: record.columns[name] for name in declaration.inputs},
        speed_m_s=record.columns[speed] if speed else None,
        step_s=record.sample_time_s,
        derivative_of_inputs=declaration.derivative_of_inputs,
        end_samples=declaration.taps,
    )


def left_of(declaration: RecordDeclaration, record: Recording, explained: Array) -> Remainder:
    """Return what is left of a record less ``explained`` (outputs, judged samples)."""
    keep = slice(declaration.taps, record.samples - declaration.taps)
    outputs = np.stack([record.columns[n] for n in declaration.outputs])[:, keep]
    inputs = [record.columns[n][keep] for n in declaration.inputs]
    speed = travel = None
    if declaration.travel_speed:
        speed = record.columns[declaration.travel_speed][keep]
        travel = np.cumsum(speed) * record.sample_time_s
    return Remainder(
        record=record,
        residual=outputs - explained,
        outputs=outputs,
        inputs=np.stack(inputs) if inputs else np.zeros((0, outputs.shape[1])),
        travel_m=travel,
        speed_m_s=speed,
    )
