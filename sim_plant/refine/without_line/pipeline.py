"""Refine records without a line declaration: declared filter, then lines; judged held out."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from jinja2 import Environment, PackageLoader
from scipy.signal import lfilter

from sim_plant.base.arrays import Array
from sim_plant.refine.noise.innovations import whitening_filter
from sim_plant.refine.report.amend import plain
from sim_plant.refine.report.folder import check_apart, check_folder, publish
from sim_plant.refine.report.wording import record_headline, record_next
from sim_plant.refine.without_line.free_lines import Line, basis, clocks, find_lines, sharpest
from sim_plant.refine.without_line.record_filter import (
    Explained,
    RecordDeclaration,
    explain,
    fit_filter,
    load_record_declaration,
    read_for,
)

if TYPE_CHECKING:
    from sim_plant.refine.report.outcome import Plan

NO_TRAVEL = (
    "no column is an absolute speed or angle: a frequency cannot be tied to a roller, no roller "
    "is claimed"
)


def limits_of(declaration: RecordDeclaration, held: bool) -> list[str]:
    """Return what cannot be claimed, as sentences."""
    said = ["no line declaration: no place can be named, a line is named by its coordinate"]
    if declaration.travel_speed is None:
        said.append(NO_TRAVEL)
    if not held:
        said.append("no held-out record: the error after is that of the record fitted")
    return said


def refine_records(plan: Plan, progress: Callable[[str], None]) -> dict[str, Any]:
    """Run filter and lines, write verdict and report, return the verdict.

    Raises
    ------
    PlantError
        On any input that cannot be judged; nothing is written then.
    """
    check_folder(plan)
    declaration = load_record_declaration(plan.line)
    records = [read_for(declaration, p) for p in plan.records]
    held = [read_for(declaration, p) for p in plan.holdout]
    check_apart(records, held)
    said = limits_of(declaration, bool(held))
    if len(held) > 1:
        said.append(f"more than one held-out record: the errors are those of {held[0].path.name}")
    for text in said:
        progress(f"cannot be claimed: {text}")
    for record in (*records, *held):
        for text in record.findings:
            progress(f"{record.path.name}: {text}")
    weights = fit_filter(declaration, records)
    items = [explain(declaration, r, weights) for r in records]
    progress("searching lines in time and travel")
    lines = find_lines(items)
    machine = [x for x in lines if not x.clock]
    for line in lines:
        progress(f"  {line.kind} {line.coordinate:.5g}{': ' + line.clock if line.clock else ''}")
    others = [x for x in lines if x.clock] + clocks(items)
    judged = explain(declaration, held[0], weights) if held else items[0]
    rms = judge_lines(declaration, items, machine, judged, own=not held)
    result = {
        "version": 1,
        "verdict": "unknown" if machine else "nothing",
        "effects": [],
        "unknown": [_row(x) for x in machine],
        "clocks": [{**_row(x), "why": x.clock} for x in others],
        "not_claimed": said,
        "residual_rms": rms,
        "holdout": str((plan.holdout or plan.records)[0]),
    }
    hashes = [(r.path.name, r.sha256) for r in (*records, *held)]
    publish(plan, lambda into: _write(into, declaration, result, hashes, plan.command))
    return result


def _row(line: Line) -> dict[str, Any]:
    if line.kind == "time":
        where = {"frequency_Hz": line.coordinate}
    else:
        where = {
            "wavenumber_1_m": line.coordinate,
            "equivalent_radius_m": line.equivalent_radius_m,
        }
    return {
        "class": line.kind,
        "coordinate": where,
        "per_record": list(line.per_record),
        "strength": line.strength,
    }


def _fit(item: Explained, rows: Array, line: Line) -> Array:
    """Return weighted least squares of a line: residual and basis through the same whitening."""
    b = basis(item, line.kind, line.coordinate)
    columns = []
    for row in rows:
        taps, _ = whitening_filter(row[None, :])
        white = lfilter(taps, [1.0], np.column_stack([b, row]), axis=0)[taps.size :]
        columns.append(np.linalg.lstsq(white[:, :-1], white[:, -1], rcond=None)[0])
    return np.stack(columns, axis=1)


def judge_lines(
    declaration: RecordDeclaration,
    items: Sequence[Explained],
    lines: Sequence[Line],
    judged: Explained,
    *,
    own: bool,
) -> dict[str, dict[str, float]]:
    """Return rms of outputs: declared filter alone, and with lines.

    Sizes come from the fitted records. A record's own start phase and travel scale (two numbers a
    line) are found on the record judged: by chance that saves 2 / samples of its power per line.
    """
    gone = judged.residual.copy()
    white = judged.whitened
    for line in lines:
        here = line
        if not own:
            at = sharpest(judged, white, line.kind, line.coordinate)
            here = replace(line, coordinate=at)
        fitted = _fit(judged, gone, here)
        if not own:
            fitted = _known_size(items, line, fitted)
        gone = gone - (basis(judged, here.kind, here.coordinate) @ fitted).T
    noise = [float(np.std(row)) for row in gone]
    return {
        name: {
            "before": float(np.sqrt(np.mean(judged.residual[k] ** 2))),
            "after": float(np.sqrt(np.mean(gone[k] ** 2))),
            "noise_floor": noise[k],
        }
        for k, name in enumerate(declaration.outputs)
    }


def _known_size(items: Sequence[Explained], line: Line, fitted: Array) -> Array:
    """Return this record's phase with the size that the fitted records agree on."""
    sizes = []
    for item, own in zip(items, line.per_record, strict=True):
        alone = _fit(item, item.residual, replace(line, coordinate=own))
        sizes.append(np.abs(_complex(alone)[0]))
    here = _complex(fitted)[0]
    size = np.mean(sizes, axis=0)
    turned = here / np.maximum(np.abs(here), 1e-300) * size
    found = np.zeros_like(fitted)
    found[0], found[1] = turned.real, turned.imag
    return found


def _complex(fitted: Array) -> Any:
    return np.stack([fitted[k] + 1j * fitted[k + 1] for k in range(0, fitted.shape[0], 2)])


def _write(
    plan: Plan,
    declaration: RecordDeclaration,
    result: dict[str, Any],
    records: Sequence[tuple[str, str]],
    command: str,
) -> None:
    text = json.dumps(plain(result), indent=1) + "\n"
    (plan.out / "verdict.json").write_text(text, encoding="utf-8")
    template = Environment(
        loader=PackageLoader("sim_plant.refine.without_line", "."), autoescape=True
    ).get_template("page.html.j2")
    page = template.render(
        note=declaration.note,
        verdict=result,
        records=records,
        command=command,
        headline=record_headline(result),
        held=bool(plan.holdout),
        next_step=record_next(result, travel=declaration.travel_speed is not None),
    )
    (plan.out / "report.html").write_text(page, encoding="utf-8")
