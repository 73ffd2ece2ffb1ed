"""Whether a record belongs to a line: refuse what does not, say what cannot be claimed."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.line.declaration import Declaration
from sim_plant.line.load import load_declaration
from sim_plant.refine.record import Record
from sim_plant.refine.twin import REFERENCES, Twin, modelled_channels

SPEED_MISMATCH = 0.2
TENSION_RANGE = (0.2, 5.0)
HIGHEST_STRAIN = 0.2


def sidecar_of(path: Path) -> Path:
    """Return where a record's own declaration would be: same stem, ``.yaml``."""
    name = path.name
    for ending in (".gz", ".csv", ".txt", ".parquet", ".mf4"):
        name = name.removesuffix(ending)
    return path.with_name(name + ".yaml")


def declaration_for(line: Declaration, record: Record) -> Declaration:
    """Return the line as it was at the start of this record: its sidecar overrides.

    Raises
    ------
    PlantError
        When the sidecar describes another line.
    """
    path = sidecar_of(record.path)
    if not path.exists():
        return line
    own = load_declaration(path)
    if [r.name for r in own.rollers] != [r.name for r in line.rollers]:
        raise PlantError(f"{path}: declares other rollers than the line it is to be judged by")
    effects = own.effects or line.effects
    tolerances = {**line.tolerances, **own.tolerances}
    return own.model_copy(update={"effects": effects,
                                  "tolerances": tolerances})  # fmt: skip


def twin_of(line: Declaration, record: Record) -> Twin:
    """Return the twin of one record after checking that both belong together.

    Raises
    ------
    PlantError
        On a missing reference or channel, another sample time, or values that another unit
        would explain.
    """
    own = declaration_for(line, record)
    for name in REFERENCES:
        if name not in record.columns:
            raise PlantError(
                f"{record.path}: column {name} is missing; the line runs under its references"
            )
    named = {s.channel for s in own.sensors}
    absent = sorted(n for n in named - set(record.columns))
    if absent:
        raise PlantError(
            f"{record.path}: declared channels are missing: {', '.join(absent)}; "
            "record them, or take them out of the declaration"
        )
    sample = round(record.sample_time_s, 6)
    if abs(sample - own.sample_time_s) > 1e-3 * own.sample_time_s:
        side = sidecar_of(record.path)
        where = side if side.exists() else "the line file"
        raise PlantError(
            f"{record.path}: sampled every {sample} s, declared {own.sample_time_s} s; "
            f"correct sample_time_s in {where}, or the unit of the time column"
        )
    _plausible(own, record)
    aff = {}
    for name, values in record.columns.items():
        if name == "aff_correction_m_s" and np.any(values):
            aff["unwind"] = values
    return Twin(
        declaration=own, channels=modelled_channels(own, list(record.columns)),
        speed_m_s=record.columns[REFERENCES[0]], tension_N=record.columns[REFERENCES[1]],
        aff_m_s=aff,
    )  # fmt: skip


def _plausible(line: Declaration, record: Record) -> None:
    speed = record.columns["line_speed_ref_m_s"]
    tension = record.columns["tension_ref_N"]
    for name in REFERENCES:
        if not np.any(record.columns[name]):
            raise PlantError(f"{record.path}: column {name} is 0 throughout; "
                             "give a record of the running line")  # fmt: skip
    strain = float(np.median(tension)) / line.web.EA_N
    if not 0.0 < strain < HIGHEST_STRAIN:
        raise PlantError(
            f"{record.path}: column tension_ref_N: {np.median(tension):.4g} N would strain the "
            f"declared web (EA {line.web.EA_N:g} N) by {100 * strain:.3g} %; a unit in the header "
            "is wrong, or the line file is another line's"
        )
    for sensor in line.sensors:
        values = record.columns[sensor.channel]
        if sensor.scale_radius_m is not None:
            _compare(record.path, sensor.channel, values, speed, SPEED_MISMATCH)
        elif sensor.noise_sd_rad_s is not None:
            radius = line.rollers[line.body(sensor.roller)].radius_m
            _compare(record.path, sensor.channel, values, speed / radius, 2.0 * SPEED_MISMATCH)
        elif sensor.lsb_rad is not None:
            radius = line.rollers[line.body(sensor.roller)].radius_m
            _compare_angle(record, sensor.channel, speed / radius)
        elif sensor.low_pass_Hz is not None:
            ratio = float(np.median(values) / np.median(tension))
            if not TENSION_RANGE[0] < ratio < TENSION_RANGE[1]:
                raise PlantError(
                    f"{record.path}: column {sensor.channel}: {ratio:.3g} times the tension "
                    "reference; its unit in the header, or the reference's, is wrong"
                )
        elif sensor.lsb_m is not None:
            declared = line.rollers[line.body(sensor.roller)].radius_m
            if abs(values[0] / declared - 1.0) > 0.02:
                raise PlantError(
                    f"{record.path}: column {sensor.channel} starts at {values[0]:g} m, the line "
                    f"file declares {declared:g} m: not this record's line file, or another unit"
                )


def _compare(path: Path, name: str, values, expected, share: float) -> None:  # type: ignore[no-untyped-def]
    moving = np.abs(expected) > 0.1 * np.max(np.abs(expected))
    ratio = float(np.median(values[moving] / expected[moving]))
    if abs(ratio - 1.0) > share:
        raise PlantError(
            f"{path}: column {name}: {ratio:.4g} times what the speed reference and the declared "
            "radius give; a unit in the header is wrong, or the line file is another line's"
        )


def _compare_angle(record: Record, name: str, expected: Array) -> None:
    """Refuse an angle whose steps belong to another unit; steps back: the count starts over."""
    steps = np.diff(record.columns[name])
    onward = steps * np.sign(np.median(steps)) >= 0.0
    turned = abs(float(np.mean(steps[onward]))) / record.sample_time_s
    wanted = abs(float(np.mean(expected[1:][onward])))
    if not abs(turned / wanted - 1.0) < 2.0 * SPEED_MISMATCH:
        raise PlantError(
            f"{record.path}: column {name}: turns {turned / wanted:.4g} times as fast as the "
            "speed reference and the declared radius give; a unit in the header is wrong, or the "
            "line file is another line's"
        )


def limits(twin: Twin) -> list[str]:
    """Return what cannot be claimed from this record, as sentences."""
    found = []
    angles = [c for c in twin.channels if c.endswith("_angle_rad")]
    if not angles:
        found.append("no roll angle is recorded: orders rest on simulated angles")
    if not any(s.scale_radius_m for s in twin.declaration.sensors if s.channel in twin.channels):
        found.append("no web speed is recorded: wavelengths rest on the speed reference")
    if float(np.ptp(twin.speed_m_s)) < 0.02 * float(np.mean(np.abs(twin.speed_m_s))):
        found.append("one speed only: a line in time and a line in travel look the same")
    if len([c for c in twin.channels if c.endswith("_N")]) < 2:
        found.append("one tension only: where an effect sits rests on the drive speeds")
    found.append("a wrong scale or zero of a load cell: the tension loop's integral hides it")
    return found
