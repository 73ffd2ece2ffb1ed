"""Records without a line declaration: a filter explains outputs from inputs, lines the rest."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable
from sim_plant.base.arrays import Array
from sim_plant.base.plain_file import read_plain
from sim_plant.line.declaration import Name
from sim_plant.line.load import Source
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.noise.innovations import whitening_filter
from sim_plant.refine.records.limits import FILE_BYTES
from sim_plant.refine.records.read import read_record
from sim_plant.refine.records.recording import Record
from sim_plant.refine.records.sanity import oddities
from sim_plant.refine.records.text_table import number_table

SCHEMA = "record-declaration/1"
WITHOUT_LINE = CRITERIA.without_line


class RecordDeclaration(BaseModel):
    """What is known of a record that no line declaration belongs to."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    schema_: Literal["record-declaration/1"] = Field(alias="schema")
    note: str = ""
    columns: tuple[Name, ...] | None = Field(default=None, description="names, without a header")
    sample_time_s: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    outputs: tuple[Name, ...] = Field(min_length=1)
    inputs: tuple[Name, ...] = Field(min_length=1)
    derivative_of_inputs: bool = False
    taps: Annotated[int, Field(ge=1, le=500)] = 40
    travel_speed: Name | None = Field(
        default=None, description="column with an absolute speed, m/s"
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Explained:
    """A record after its declared filter.

    Attributes
    ----------
    record : what was read.
    residual : outputs less filtered inputs (outputs, samples).
    outputs : as measured (outputs, samples).
    inputs : as used (inputs, samples).
    travel_m : integral of the absolute speed, or None.
    speed_m_s : the absolute speed, or None.
    """

    record: Record
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
    taps, sd = whitening_filter(row[None, :])
    if sd == 0.0:
        return np.zeros_like(row)
    found = np.convolve(row - row.mean(), taps)[: row.size] / sd
    found[: taps.size] = 0.0
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


def read_for(declaration: RecordDeclaration, path: Path) -> Record:
    """Return a record under this declaration; headerless files take its column names.

    Raises
    ------
    PlantError
        When a declared column is missing, or the record cannot be read or is too short.
    """
    plain = declaration.columns is None
    record = read_record(path) if plain else _headerless(declaration, path)
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
    return record


def _headerless(declaration: RecordDeclaration, path: Path) -> Record:
    names = declaration.columns or ()
    payload = read_plain(path, FILE_BYTES)
    table = number_table(path, payload, len(names))
    bad = np.argwhere(~(np.abs(table) < CRITERIA.records.largest_reading))
    if bad.size:
        raise PlantError(f"{path}: column {names[bad[0][1]]}: no reading in line {bad[0][0] + 1}")
    columns = {n: table[:, k].copy() for k, n in enumerate(names)}
    return Record(
        path=path,
        sha256=hashlib.sha256(payload).hexdigest(),
        sample_time_s=declaration.sample_time_s,
        columns=columns,
        findings=tuple(oddities(columns)),
    )


def regressors(declaration: RecordDeclaration, record: Record) -> Array:
    """Return shifted inputs (samples, columns): a two-sided filter, and a constant."""
    columns = [np.ones(record.samples)]
    for name in declaration.inputs:
        series = record.columns[name]
        if declaration.derivative_of_inputs:
            series = np.gradient(series, record.sample_time_s)
        for shift in range(-declaration.taps, declaration.taps + 1):
            columns.append(np.roll(series, shift))
    return np.stack(columns, axis=1)


def fit_filter(declaration: RecordDeclaration, records: Sequence[Record]) -> Array:
    """Return filter weights (columns, outputs) by ridge regression over all records."""
    normal: Array | float = 0.0
    against: Array | float = 0.0
    for record in records:
        a = regressors(declaration, record)
        y = np.stack([record.columns[n] for n in declaration.outputs], axis=1)
        edge = slice(declaration.taps, record.samples - declaration.taps)
        normal = normal + a[edge].T @ a[edge]
        against = against + a[edge].T @ y[edge]
    matrix = np.asarray(normal)
    ridge = 1e-6 * float(np.trace(matrix)) / matrix.shape[0]
    found: Array = np.linalg.solve(matrix + ridge * np.eye(matrix.shape[0]), np.asarray(against))
    return found


def explain(declaration: RecordDeclaration, record: Record, weights: Array) -> Explained:
    """Return what the declared filter leaves of a record, its ends cut off."""
    keep = slice(declaration.taps, record.samples - declaration.taps)
    outputs = np.stack([record.columns[n] for n in declaration.outputs])[:, keep]
    inputs = np.stack([record.columns[n] for n in declaration.inputs])[:, keep]
    predicted = (regressors(declaration, record)[keep] @ weights).T
    speed = travel = None
    if declaration.travel_speed:
        speed = record.columns[declaration.travel_speed][keep]
        travel = np.cumsum(speed) * record.sample_time_s
    return Explained(
        record=record,
        residual=outputs - predicted,
        outputs=outputs,
        inputs=inputs,
        travel_m=travel,
        speed_m_s=speed,
    )
