"""A drawn effect as refine has it at the end of a search, and its intervals."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from aff_runtime.base.errors import PlantError
from benchmarks.campaign.cases import Case
from benchmarks.campaign.fault import Fault
from benchmarks.campaign.make import declared_for
from benchmarks.campaign.record import simulate, write_line, write_record
from benchmarks.campaign.stage import stage
from benchmarks.intervals.draws import true_numbers
from sim_plant.line.reading.load import load_line
from sim_plant.refine.confirm import RecordWithTwin
from sim_plant.refine.fit.gauss_newton import Fit, nominal_fit
from sim_plant.refine.fit.objective import Objective, declared_objective
from sim_plant.refine.fit.roll_synchronisation import synchronised, synchronising_shifts
from sim_plant.refine.model.hypotheses import Hypothesis, all_hypotheses, onset_hypotheses
from sim_plant.refine.model.record_match import twin_of
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.records.read import read_record
from sim_plant.refine.report.findings import effect_findings
from sim_plant.refine.search.added_effect import with_effect
from sim_plant.refine.search.effect_fit import fit_candidates
from sim_plant.refine.search.number_ranges import with_number_ranges
from sim_plant.refine.search.profile_detail import joint_refit
from sim_plant.refine.search.screening import screen
from sim_plant.refine.search.selection import AcceptedEffect, Selection

LOOKS = 3
"""Starts that are fitted, best first look first."""


def written(case: Case, folder: Path) -> Path:
    """Write record ``a`` of a case and its line; return the record."""
    folder.mkdir(parents=True, exist_ok=True)
    at = stage(case, "a")
    guilty = at.guilty(case.faults)
    columns = simulate(guilty, at.told, at.angles, at.seed, colour=case.colour)
    write_record(columns, folder / "a.csv")
    write_line(declared_for(case, "a"), folder / "a.yaml")
    return folder / "a.csv"


def starts(
    objective: Objective, nominal: Fit, fault: Fault, true: Mapping[str, float]
) -> list[Fit]:
    """Return fits of the drawn effect at its place: from its moment, or from first looks."""
    line = objective.pool.twins[0].declaration
    if fault.from_s < 0.0:
        here = [
            shaped_as(h, true)
            for h in all_hypotheses(line)
            if h.effect.name == fault.effect and h.location == fault.location
        ]
        looks = screen(objective, nominal, here, _quiet)[:LOOKS]
        return [c.fit for c in fit_candidates(objective, nominal, looks, _quiet)]
    found = []
    for h in onset_hypotheses(line, 0):
        if h.effect.name == fault.effect and h.location == fault.location:
            start = [true.get(n, s) for n, s in zip(h.names, h.start, strict=True)]
            found.append(with_effect(objective, nominal, h, start, nominal.shifts))
    return [fit for fit in found if fit is not None]


def shaped_as(h: Hypothesis, true: Mapping[str, float]) -> Hypothesis:
    """Return a start whose shapes are the true ones: to find them is the search's affair."""
    start = [
        true.get(name, value) if h.effect.accepts[name].role == "shape" else value
        for name, value in zip(h.names, h.start, strict=True)
    ]
    fixed = tuple((n, true.get(n, v) if n in h.effect.fitted_later else v) for n, v in h.fixed)
    return replace(h, start=tuple(start), fixed=fixed)


def fitted(case: Case, folder: Path) -> tuple[Objective, Selection] | None:
    """Return the drawn effect as refine has it at the end of a search; None where none stands."""
    record = written(case, folder)
    line = load_line(folder / "a.yaml").declaration
    read = read_record(record)
    recorded = RecordWithTwin(record=read, twin=twin_of(line, read))
    objective = declared_objective(SimulationPool([recorded.twin], workers=1), [recorded.measured])
    start = nominal_fit(objective, synchronising_shifts(objective, {}))
    nominal = synchronised(objective, start)
    fits = starts(objective, nominal, case.faults[0], true_numbers(case))
    if not fits:
        return None
    best = min(fits, key=lambda fit: fit.cost)
    objective, fit = joint_refit(objective, best)
    accepted = AcceptedEffect(
        hypothesis=fit.hypotheses[-1],
        score=nominal.cost - best.cost,
        runner_up=None,
        margin=0.0,
        rejected=(),
    )
    return objective, Selection(
        nominal=nominal,
        fit=fit,
        record_axes=(),
        spectra_declared=(),
        spectra_left=(),
        accepted=(accepted,),
    )


def row_of(name: str, case: Case, folder: Path) -> dict[str, Any]:
    """Return what the intervals of a draw say beside what is true, and what the fit leaves."""
    numbers, excess = [], math.nan
    try:
        found = fitted(case, folder)
    except PlantError as error:  # a line that is no line any more: its record is refused
        sys.stderr.write(f"{name}: {error}\n")
        found = None
    if found is not None:
        objective, selection = found
        selection = with_number_ranges(objective, selection)
        excess = objective.excess(selection.fit.cost, selection.fit.residual)
        excess /= objective.cost_standard_deviation
        (said,) = effect_findings(selection)
        for number, true in true_numbers(case).items():
            if number in said.interval95:
                low, high = said.interval95[number]
                value = float(said.parameters[number])
                numbers.append(
                    {"name": number, "value": value, "true": true, "low": low, "high": high}
                )
    return {"name": name, "effect": case.faults[0].effect, "numbers": numbers, "excess": excess}


def _quiet(_: str) -> None:
    """Say nothing."""
