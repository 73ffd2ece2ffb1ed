"""What a part of a run lacks, and what that costs the verdict; said before the work begins."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from aff_runtime.base.runs.window import run_window
from sim_plant.line.declared.declaration import Declaration, LoadCell
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.run_match import SPEED_REF
from sim_plant.refine.model.site_match import driven_roller
from sim_plant.refine.model.twin import Twin
from sim_plant.refine.records.recording import Recording

MODEL = CRITERIA.model


def run_caveats(record: Recording, twin: Twin) -> list[str]:
    """Return what this part of a run lacks, as sentences; none for a record that is no run's."""
    if record.run is None:
        return []
    line, name = twin.declaration, record.path.name
    sentences = []
    if not _reference_mapped(record):
        sentences.append(
            f"{name}: no speed reference: the measured speed stands in, some 100 ppm off; at "
            "which of several like idlers of a zone an effect sits is not told, nor what only "
            "the drives' common speed shows"
        )
    tension_N = twin.tension_N
    if float(np.ptp(tension_N)) < MODEL.tension_step_share * float(np.mean(np.abs(tension_N))):
        sentences.append(
            f"{name}: no step of the tension reference: the modulus, a loop's gains and a "
            "delay are told by ripple alone"
        )
    if _radius_change(line, record) < MODEL.radius_change_share:
        sentences.append(
            f"{name}: the unwind roll keeps its radius: an order of it and a roller of that "
            "radius look the same"
        )
    missing = [s.channel for s in line.sensors if s.channel not in record.columns]
    if missing:
        sentences.append(f"{name}: not recorded: {', '.join(missing)}; {_cost(line, record)}")
    for actuator, known in record.run.delivery_known.items():
        declared = record.run.site.actuators.get(actuator)
        roller = driven_roller(line, actuator, declared.roll if declared is not None else "")
        acted = [kind.get(roller, 0.0) for kind in (twin.aff_m_s, twin.aff_N_m)]
        if not known and any(np.any(values) for values in acted):
            sentences.append(
                f"{name}: when a correction of {actuator} acted is not recorded, the usual delay "
                "is taken: a delay of that drive is not told from it (map aff_echo or applied)"
            )
    return sentences


def lines_of(records: Sequence[Recording]) -> list[str]:
    """Return a sentence where runs are of lines with other names, by their own site files."""
    names = {r.run.site.name: r.path.name for r in records if r.run is not None}
    if len(names) < 2:
        return []
    said = ", ".join(f"{path} of {name}" for name, path in names.items())
    return [f"by their site files the runs are of several lines: {said}; are they of this one?"]


def site_of_other_line(name: str, records: Sequence[Recording]) -> list[str]:
    """Return a sentence where a site file is of a line of another name than all runs are.

    ``name`` : of its line; empty where it does not say.
    """
    runs = sorted({r.run.site.name for r in records if r.run is not None and r.run.site.name})
    if not name or not runs or name in runs:
        return []
    return [
        f"this site file is of line {name}, the runs are of {', '.join(runs)} by theirs: is it "
        "the one of this line?"
    ]


def rolls_of(records: Sequence[Recording]) -> list[str]:
    """Return a sentence where records of runs are of several rolls of web."""
    known = {r.run.roll_id for r in records if r.run is not None and r.run.roll_id >= 0.0}
    if len(known) < 2:
        return []
    return [
        f"the records are of {len(known)} rolls of web: what a roll itself does (out of round, "
        "its winding) is one effect to the fit, and not the same in each; for that give one roll"
    ]


def shared(fitted: Sequence[Recording], held: Sequence[Recording]) -> list[str]:
    """Return a sentence for every two windows of one run that overlap.

    What is fitted twice counts twice; an error held out on what was fitted proves less.
    """
    sentences = []
    for one, other in itertools.combinations((*fitted, *held), 2):
        if one.run is None or other.run is None or not _same_run(one, other):
            continue
        both = min(one.run.to_s, other.run.to_s) - max(one.run.from_s, other.run.from_s)
        if both > 0.0:
            is_judged = any(other is one for one in held)
            costs = "the error is judged on what was fitted" if is_judged else "it counts twice"
            sentences.append(
                f"{one.path.name} and {other.path.name} share {both:.3g} s of one run: {costs}; "
                "give windows that do not overlap"
            )
    return sentences


def _same_run(one: Recording, other: Recording) -> bool:
    """Return whether both are of one run, be it of two copies of its folder."""
    assert one.run is not None
    assert other.run is not None
    if one.run.run_id:
        return one.run.run_id == other.run.run_id
    return _folder(one) == _folder(other)


def _folder(record: Recording) -> Path:
    return run_window(record.path).folder.resolve()


def _reference_mapped(record: Recording) -> bool:
    assert record.run is not None
    return not any("no speed reference is recorded" in text for text in record.findings)


def _radius_change(line: Declaration, record: Recording) -> float:
    """Return by what share the unwind roll's radius changes, from web travel and thickness."""
    radius = line.initial_radii_m.unwind
    metres = float(np.sum(np.abs(record.columns[SPEED_REF]))) * record.sample_time_s
    area = radius**2 - metres * line.web.thickness_m / np.pi
    return 1.0 - float(np.sqrt(max(area, 0.0))) / radius


def _cost(line: Declaration, record: Recording) -> str:
    """Return what missing channels cost: zones between drives without a tension of their own."""
    names = [r.name for r in line.rollers]
    driven = sorted(line.body(d.roller) for d in line.control.drives)
    cells = [line.body(s.roller) for s in line.sensors if _read(s, record)]
    blind = [
        f"{names[a]} to {names[b]}"
        for a, b in itertools.pairwise(driven)
        if b - a > 1 and not any(a < k < b for k in cells)
    ]
    if not blind:
        return "where an effect sits rests on fewer channels"
    return f"nothing tells what happens from {' and from '.join(blind)}"


def _read(sensor: object, record: Recording) -> bool:
    return isinstance(sensor, LoadCell) and sensor.channel in record.columns
