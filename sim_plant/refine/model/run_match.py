"""Gives a run's columns the line's channel names: the same name, else by its site file's use."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.line.declared.declaration import Declaration, LoadCell
from sim_plant.refine.model.site_match import channels_of, driven_roller, tension_references
from sim_plant.refine.model.speed_stand_in import stand_in_speed
from sim_plant.refine.records.recording import Recording, RunFacts
from sim_plant.refine.records.run_pieces import CORRECTION

SPEED_REF, TENSION_REF = "line_speed_ref_m_s", "tension_ref_N"
APPLIED = "applied_"
"""Columns ``applied_<driven roller>_<m_s or N_m>``: the correction that acted after the row."""


def run_on_line(line: Declaration, record: Recording) -> Recording:
    """Return a run's record with the line's own names for channels, references and corrections.

    A record that is no part of a run comes back as it is.

    Raises
    ------
    PlantError
        It has none of the line's channels, no tension, or corrections of an actuator that is no
        drive of the line.
    """
    if record.run is None:
        return record
    run = record.run
    names = channels_of(line, run.site, record.columns)
    if not any(isinstance(s, LoadCell) and s.channel in names for s in line.sensors):
        raise PlantError(
            f"{record.path}: holds no tension of this line: its site file maps "
            f"{', '.join(sorted(run.site.count_sizes))}; the line declares "
            f"{', '.join(s.channel for s in line.sensors if isinstance(s, LoadCell))}; "
            "is it a run of another line? Else name the sensors of the line file as the site does"
        )
    columns = {channel: record.columns[column] for channel, column in names.items()}
    findings = [f"{to} is the run's {column}" for to, column in names.items() if to != column]
    findings += _unused(run, names, record.columns)
    columns[SPEED_REF], speed_findings = _speed_reference(line, run, record, columns)
    tension, tension_findings = _tension_reference(line, run, record, columns, names)
    columns[TENSION_REF] = tension
    columns |= _corrections(line, record)
    return replace(
        record,
        columns=columns,
        findings=(*record.findings, *findings, *speed_findings, *tension_findings),
        zeros_rad={
            channel: record.zeros_rad[column]
            for channel, column in names.items()
            if column in record.zeros_rad
        },
        run=replace(run, site=replace(run.site, count_sizes=_count_sizes(run, names))),
    )


def _count_sizes(run: RunFacts, names: Mapping[str, str]) -> dict[str, float]:
    return {to: run.site.count_sizes.get(column, 0.0) for to, column in names.items()}


def _unused(run: RunFacts, names: Mapping[str, str], columns: Mapping[str, Array]) -> list[str]:
    """Return a sentence about readings of the run that the line file has no sensor for."""
    references = {run.site.speed_reference, *(a.reference for a in run.site.actuators.values())}
    known = {*names.values(), *references, run.site.speed, SPEED_REF, TENSION_REF}
    rest = [n for n in columns if n not in known and not n.startswith(CORRECTION)]
    if not rest:
        return []
    return [
        f"not used: {', '.join(sorted(rest))}: no sensor of the line file has that name or use; "
        "give a sensor of the line file that name where both are the same reading"
    ]


def _speed_reference(
    line: Declaration, run: RunFacts, record: Recording, columns: Mapping[str, Array]
) -> tuple[Array, list[str]]:
    """Return the line speed reference, measured or stood in for, and what is said of it."""
    for name in (run.site.speed_reference, SPEED_REF):
        if name and name in record.columns:
            return _mean_over_row(record, name), []
    straight, findings = stand_in_speed(line, columns, record)
    return mean_over_row(straight, 0.0), findings  # linear between the moments of the rows


def _mean_over_row(record: Recording, name: str) -> Array:
    assert record.run is not None
    return mean_over_row(record.columns[name], record.run.scan_s / record.sample_time_s)


def mean_over_row(reference: Array, scan_rows: float) -> Array:
    """Return the mean of a reference over the interval from each row to the next; (n,) as given.

    A row shows the value that acted in the scan of the PLC that ends with it, ``scan_rows`` rows
    long. 1: the mean is exactly the next row's value. Shorter: straight lines between the rows,
    at the middle of the interval. 0: rows are instants.
    """
    following = np.append(reference[1:], reference[-1:])
    weight_of_row = 0.5 * (1.0 - min(1.0, scan_rows))
    return np.asarray(weight_of_row * reference + (1.0 - weight_of_row) * following)


def _tension_reference(
    line: Declaration,
    run: RunFacts,
    record: Recording,
    columns: Mapping[str, Array],
    names: Mapping[str, str],
) -> tuple[Array, list[str]]:
    """Return the tension reference; the mean of the loop's own cell where none is mapped."""
    for name in (TENSION_REF, *tension_references(line, run.site, names)):
        if name in record.columns:
            return _mean_over_row(record, name), []
    cells = {s.roller: s.channel for s in line.sensors if isinstance(s, LoadCell)}
    looped = [cells[loop.load_cell] for loop in line.control.tension_pi]
    others = [s.channel for s in line.sensors if isinstance(s, LoadCell)]
    channel = next(c for c in (*looped, *others) if c in columns)
    mean = float(np.mean(columns[channel]))
    text = f"no tension reference is recorded: the mean of {channel}, {mean:.4g} N, stands in"
    return np.full(record.samples, mean), [text]


def _corrections(line: Declaration, record: Recording) -> dict[str, Array]:
    """Return what acted on every driven roller as ``applied_`` columns; none that is 0 throughout.

    Raises
    ------
    PlantError
        Something acted through an actuator that is no drive of the line.
    """
    assert record.run is not None
    corrections: dict[str, Array] = {}
    for name, actuator in record.run.site.actuators.items():
        values = record.columns.get(f"{CORRECTION}{name}_{actuator.suffix}")
        if values is None or not np.any(values):
            continue
        roller = driven_roller(line, name, actuator.roll)
        if not roller:
            known = ", ".join(drive.roller for drive in line.control.drives)
            raise PlantError(
                f"{record.path}: corrections went out through {name}, which is no drive of this "
                f"line ({known}); name the drive's roller in the line file "
                "as the site file does, or give a window in which they did not"
            )
        column = f"{APPLIED}{roller}_{actuator.suffix}"
        corrections[column] = corrections.get(column, 0.0) + values
    return corrections
