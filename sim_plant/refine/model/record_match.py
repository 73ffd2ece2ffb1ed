"""Whether a record belongs to a line: refuse what does not, say what cannot be claimed."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.line.declared.declaration import (
    Declaration,
    DriveSpeed,
    LoadCell,
    RollAngle,
    RollRadius,
)
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.run_match import APPLIED
from sim_plant.refine.model.run_state import at_run, word_steps
from sim_plant.refine.model.twin import REFERENCES, Case, Twin, modelled_channels
from sim_plant.refine.records.read import KINDS
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.records.sanity import row_words

MATCH = CRITERIA.match
UNWIND_CORRECTION = "aff_correction_m_s"
"""A record's correction of the unwind; other rollers' are in ``applied_<roller>_m_s``."""


def sidecar_of(path: Path) -> Path:
    """Return where a record's own declaration would be: same stem, ``.yaml``."""
    endings = [ending for kind in KINDS for ending in kind if path.name.lower().endswith(ending)]
    longest = max(map(len, endings), default=0)
    return path.with_name(path.name[: len(path.name) - longest] + ".yaml")


def declaration_for(line: Declaration, record: Recording) -> Declaration:
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
    return own.model_copy(
        update={
            "effects": own.effects or line.effects,
            "corrections": {**line.corrections, **own.corrections},
            "tolerances": {**line.tolerances, **own.tolerances},
        }
    )


def twin_of(line: Declaration, record: Recording) -> Twin:
    """Return the twin of one record after checking that both belong together.

    Raises
    ------
    PlantError
        On a missing reference or channel, another sample time, or values that another unit
        would explain.
    """
    own = at_run(declaration_for(line, record), record)
    for name in REFERENCES:
        if name not in record.columns:
            raise PlantError(
                f"{record.path}: column {name} is missing; the line runs under its references"
            )
    named = {s.channel for s in own.sensors}
    absent = sorted(n for n in named - set(record.columns))
    if absent and record.run is None:
        raise PlantError(
            f"{record.path}: declared channels are missing: {', '.join(absent)}; "
            "record them, or take them out of the declaration"
        )
    sample = round(record.sample_time_s, 6)
    if abs(sample - own.sample_time_s) > MATCH.sample_time_share * own.sample_time_s:
        side = sidecar_of(record.path)
        where = side if side.exists() else "the line file"
        raise PlantError(
            f"{record.path}: sampled every {sample} s, declared {own.sample_time_s} s; "
            f"correct sample_time_s in {where}, or the unit of the time column"
        )
    _plausible(own, record)
    channels = modelled_channels(own, list(record.columns))
    twin = Twin(
        declaration=own,
        channels=channels,
        speed_m_s=record.columns[REFERENCES[0]],
        tension_N=record.columns[REFERENCES[1]],
        aff_m_s=_acted(own, record, "_m_s"),
        aff_N_m=_acted(own, record, "_N_m"),
        word_steps=word_steps(record, channels),
        speed_holds=record.run is not None,
        rested=record.run is None,
    )
    try:
        twin.line(Case(quick=False))
    except PlantError as error:
        raise PlantError(f"{record.path}: its line cannot be built: {error}") from error
    return twin


def _acted(line: Declaration, record: Recording, unit: str) -> dict[str, Array]:
    """Return the corrections that are not 0 throughout, by driven roller.

    Raises
    ------
    PlantError
        A column of corrections names a roller without a drive.
    """
    drives = [drive.roller for drive in line.control.drives]
    acted: dict[str, Array] = {}
    for name, values in record.columns.items():
        if not np.any(values):
            continue
        if name == UNWIND_CORRECTION and unit == "_m_s":
            first = line.rollers[0].name
            acted[first] = acted.get(first, 0.0) + values
        elif name.startswith(APPLIED) and name.endswith(unit):
            roller = name[len(APPLIED) : -len(unit)]
            if roller not in drives:
                raise PlantError(
                    f"{record.path}: column {name}: {roller} has no drive in this line "
                    f"({', '.join(drives)}); name the column after the drive's roller"
                )
            acted[roller] = acted.get(roller, 0.0) + values
    return acted


def _plausible(line: Declaration, record: Recording) -> None:
    """Refuse references, corrections and channels that this line cannot have had."""
    speed = record.columns["line_speed_ref_m_s"]
    tension = record.columns["tension_ref_N"]
    for name in REFERENCES:
        if not np.any(record.columns[name]):
            raise PlantError(
                f"{record.path}: column {name} is 0 throughout; give a record of the running line"
            )
    _runs(record, speed)
    strain = float(np.median(tension)) / line.web.EA_N
    if not 0.0 < strain < MATCH.highest_strain:
        raise PlantError(
            f"{record.path}: column tension_ref_N: {np.median(tension):.4g} N would strain the "
            f"declared web (EA {line.web.EA_N:g} N) by {100 * strain:.3g} %; a unit in the header "
            "is wrong, or the line file is another line's"
        )
    _within(record, "tension_ref_N", 0.0, MATCH.highest_strain * line.web.EA_N)
    _corrections_within(record, float(np.max(np.abs(speed))))
    _sensors_fit(line, record, speed, tension)


def _corrections_within(record: Recording, fastest_m_s: float) -> None:
    for name in record.columns:
        if name == UNWIND_CORRECTION or (name.startswith(APPLIED) and name.endswith("_m_s")):
            _within(record, name, -fastest_m_s, fastest_m_s)


def _sensors_fit(line: Declaration, record: Recording, speed: Array, tension: Array) -> None:
    """Refuse a channel that another unit, or another line, would explain."""
    for sensor in line.sensors:
        if sensor.channel not in record.columns:
            continue
        values = record.columns[sensor.channel]
        if isinstance(sensor, DriveSpeed) and sensor.scale_radius_m is not None:
            _compare(record.path, sensor.channel, values, speed, MATCH.speed_mismatch)
        elif isinstance(sensor, DriveSpeed) and sensor.noise_sd_rad_s is not None:
            radius = line.rollers[line.body(sensor.roller)].radius_m
            _compare(
                record.path, sensor.channel, values, speed / radius, 2.0 * MATCH.speed_mismatch
            )
        elif isinstance(sensor, RollAngle):
            radius = line.rollers[line.body(sensor.roller)].radius_m
            _compare_angle(record, sensor.channel, speed / radius)
        elif isinstance(sensor, LoadCell):
            ratio = float(np.median(values) / np.median(tension))
            if not MATCH.tension_ratio[0] < ratio < MATCH.tension_ratio[1]:
                raise PlantError(
                    f"{record.path}: column {sensor.channel}: {ratio:.3g} times the tension "
                    "reference; its unit in the header, or the reference's, is wrong"
                )
            highest = MATCH.highest_strain * line.web.EA_N
            _within(record, sensor.channel, -highest, highest)
        elif isinstance(sensor, RollRadius):
            declared = line.rollers[line.body(sensor.roller)].radius_m
            if abs(values[0] / declared - 1.0) > MATCH.radius_share:
                raise PlantError(
                    f"{record.path}: column {sensor.channel} starts at {values[0]:g} m, the line "
                    f"file declares {declared:g} m: not this record's line file, or another unit"
                )


def _runs(record: Recording, speed: Array) -> None:
    """Refuse a line that hardly runs, or runs backwards."""
    fastest = float(np.max(np.abs(speed)))
    running = np.abs(speed) > MATCH.running_speed_share * fastest
    if float(np.mean(running)) < MATCH.least_running_share:
        raise PlantError(
            f"{record.path}: column line_speed_ref_m_s: the line stands, or creeps below a tenth "
            f"of its {fastest:.4g} m/s, in {100 * float(np.mean(~running)):.1f} % of the rows; "
            "give a record of the running line"
        )
    if float(np.median(speed[running])) < 0.0:
        raise PlantError(
            f"{record.path}: column line_speed_ref_m_s: the line runs backwards; give a record "
            "from unwind to rewind, speeds counted that way"
        )


def _within(record: Recording, name: str, low: float, high: float) -> None:
    """Refuse a value that this line cannot have: a marker of a lost reading, or another unit."""
    values = record.columns[name]
    bad = np.flatnonzero((values < low) | (values > high))
    if bad.size:
        raise PlantError(
            f"{record.path}: {row_words(record.path, int(bad[0]))}: column {name}: read "
            f"{values[bad[0]]:.6g}; this line can have {low:.4g} to {high:.4g} ({bad.size} rows "
            "are beyond); cut the record there, or correct the unit in the header"
        )


def _compare(path: Path, name: str, values, expected, share: float) -> None:  # type: ignore[no-untyped-def]
    """Refuse a speed that is off the expected one by more than ``share``, median while running."""
    moving = np.abs(expected) > MATCH.running_speed_share * np.max(np.abs(expected))
    ratio = float(np.median(values[moving] / expected[moving]))
    if abs(ratio - 1.0) > share:
        raise PlantError(
            f"{path}: column {name}: {ratio:.4g} times what the speed reference and the declared "
            f"radius give; {_causes(path)}"
        )


def _causes(path: Path) -> str:
    return (
        "a unit in the header is wrong, the line file is another line's, or a roll had another "
        f"radius (then declare the line as it was in {sidecar_of(path).name} beside the record)"
    )


def _compare_angle(record: Recording, name: str, expected: Array) -> None:
    """Refuse an angle whose steps belong to another unit; a step back is a new count."""
    steps = np.diff(record.columns[name])
    onward = steps * np.sign(np.median(steps)) >= 0.0
    turned = float(np.mean(steps[onward])) / record.sample_time_s
    wanted = float(np.mean(expected[1:][onward]))
    if turned < 0.0:
        raise PlantError(
            f"{record.path}: column {name}: counts backwards while the web runs forwards; "
            "change its sign"
        )
    if not abs(turned / wanted - 1.0) < 2.0 * MATCH.speed_mismatch:
        raise PlantError(
            f"{record.path}: column {name}: turns {turned / wanted:.4g} times as fast as the "
            f"speed reference and the declared radius give; {_causes(record.path)}"
        )


def record_caveats(twin: Twin) -> list[str]:
    """Return what cannot be claimed from this record, as sentences."""
    sentences = []
    angles = [c for c in twin.channels if c.endswith("_angle_rad")]
    if not angles:
        sentences.append("no roll angle is recorded: orders rest on simulated angles")
    recorded = [s for s in twin.declaration.sensors if s.channel in twin.channels]
    if not any(isinstance(s, DriveSpeed) and s.scale_radius_m for s in recorded):
        sentences.append("no web speed is recorded: wavelengths rest on the speed reference")
    if float(np.ptp(twin.speed_m_s)) < MATCH.one_speed_share * float(
        np.mean(np.abs(twin.speed_m_s))
    ):
        sentences.append("one speed only: a line in time and a line in travel look the same")
    if len([c for c in twin.channels if c.endswith("_N")]) < 2:
        sentences.append("one tension only: where an effect sits rests on the drive speeds")
    sentences.append(
        "a wrong scale or zero of the load cell that a tension loop controls: its integral hides "
        "it"
    )
    return sentences
