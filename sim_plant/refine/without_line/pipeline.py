"""Refine records without a line declaration: declared filter, then lines; judged held out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from jinja2 import Environment, PackageLoader
from numpy.typing import NDArray
from scipy.signal import lfilter

from sim_plant.base.arrays import Array
from sim_plant.refine.noise.innovations import whitening_filter
from sim_plant.refine.report.announce import announce, holdout_limits
from sim_plant.refine.report.folder import check_apart, check_folder, publish
from sim_plant.refine.report.verdict import ChannelError
from sim_plant.refine.search.candidate import Progress
from sim_plant.refine.without_line.free_lines import (
    SpectralLine,
    basis,
    clocks,
    find_spectral_lines,
    sharpest,
)
from sim_plant.refine.without_line.record_filter import (
    Explained,
    RecordDeclaration,
    explain,
    fit_filter,
    read_for,
)
from sim_plant.refine.without_line.verdict import RecordVerdict, headline, next_step

if TYPE_CHECKING:
    from sim_plant.refine.report.outcome import Plan

NO_TRAVEL = (
    "no column is an absolute speed or angle: a frequency cannot be tied to a roller, no roller "
    "is claimed"
)


def limits_of(declaration: RecordDeclaration) -> list[str]:
    """Return what cannot be claimed without a line, as sentences."""
    found = ["no line declaration: no place can be named, a line is named by its coordinate"]
    if declaration.travel_speed is None:
        found.append(NO_TRAVEL)
    return found


def refine_records(
    plan: Plan, declaration: RecordDeclaration, progress: Progress
) -> RecordVerdict:
    """Run filter and lines, write verdict and report, return the verdict.

    ``declaration`` is in the file that the plan names as its line.

    Raises
    ------
    PlantError
        On any input that cannot be judged; nothing is written then.
    """
    check_folder(plan)
    records = [read_for(declaration, p) for p in plan.records]
    held = [read_for(declaration, p) for p in plan.holdout]
    check_apart(records, held)
    cannot = [*limits_of(declaration), *holdout_limits(held)]
    announce(cannot, (*records, *held), progress)
    weights = fit_filter(declaration, records)
    items = [explain(declaration, r, weights) for r in records]
    progress("searching lines in time and travel")
    found = find_spectral_lines(items)
    machine = [x for x in found if not x.clock]
    for x in found:
        progress(f"  {x.kind} {x.coordinate:.5g}{': ' + x.clock if x.clock else ''}")
    judged = explain(declaration, held[0], weights) if held else items[0]
    verdict = RecordVerdict(
        unknown=tuple(machine),
        clocks=(*(x for x in found if x.clock), *clocks(items)),
        not_claimed=tuple(cannot),
        residual_rms=errors_with_lines(declaration, items, machine, judged, own=not held),
        holdout=str((plan.holdout or plan.records)[0]),
    )
    hashes = [(r.path.name, r.sha256) for r in (*records, *held)]
    publish(plan, lambda into: _write(into, declaration, verdict, hashes, plan.command))
    return verdict


def _fit(item: Explained, rows: Array, spectral: SpectralLine) -> Array:
    """Return weighted least squares of a line: residual and basis through the same whitening."""
    b = basis(item, spectral.kind, spectral.coordinate)
    columns = []
    for row in rows:
        taps, _ = whitening_filter(row[None, :])
        white = lfilter(taps, [1.0], np.column_stack([b, row]), axis=0)[taps.size :]
        columns.append(np.linalg.lstsq(white[:, :-1], white[:, -1], rcond=None)[0])
    return np.stack(columns, axis=1)


def errors_with_lines(
    declaration: RecordDeclaration,
    items: Sequence[Explained],
    spectral_lines: Sequence[SpectralLine],
    judged: Explained,
    *,
    own: bool,
) -> dict[str, ChannelError]:
    """Return rms of outputs: declared filter alone, and with lines.

    Sizes come from the fitted records. A record's own start phase and travel scale (two numbers a
    line) are found on the record judged: by chance that saves 2 / samples of its power per line.
    """
    gone = judged.residual.copy()
    white = judged.whitened
    for spectral in spectral_lines:
        here = spectral
        if not own:
            at = sharpest(judged, white, spectral.kind, spectral.coordinate)
            here = replace(spectral, coordinate=at)
        fitted = _fit(judged, gone, here)
        if not own:
            fitted = _known_size(items, spectral, fitted)
        gone = gone - (basis(judged, here.kind, here.coordinate) @ fitted).T
    noise = [float(np.std(row)) for row in gone]
    return {
        name: ChannelError(
            before=float(np.sqrt(np.mean(judged.residual[k] ** 2))),
            after=float(np.sqrt(np.mean(gone[k] ** 2))),
            noise_floor=noise[k],
        )
        for k, name in enumerate(declaration.outputs)
    }


def _known_size(items: Sequence[Explained], spectral: SpectralLine, fitted: Array) -> Array:
    """Return this record's phase with the size that the fitted records agree on."""
    sizes = []
    for item, own in zip(items, spectral.per_record, strict=True):
        alone = _fit(item, item.residual, replace(spectral, coordinate=own))
        sizes.append(np.abs(_complex(alone)[0]))
    here = _complex(fitted)[0]
    size = np.mean(sizes, axis=0)
    turned = here / np.maximum(np.abs(here), 1e-300) * size
    found = np.zeros_like(fitted)
    found[0], found[1] = turned.real, turned.imag
    return found


def _complex(fitted: Array) -> NDArray[np.complex128]:
    return np.stack([fitted[k] + 1j * fitted[k + 1] for k in range(0, fitted.shape[0], 2)])


def _write(
    plan: Plan,
    declaration: RecordDeclaration,
    verdict: RecordVerdict,
    records: Sequence[tuple[str, str]],
    command: str,
) -> None:
    (plan.out / "verdict.json").write_text(verdict.to_json(), encoding="utf-8")
    template = Environment(
        loader=PackageLoader("sim_plant.refine.without_line", "."), autoescape=True
    ).get_template("page.html.j2")
    page = template.render(
        note=declaration.note,
        verdict=verdict,
        records=records,
        command=command,
        headline=headline(verdict),
        held=bool(plan.holdout),
        next_step=next_step(verdict, travel=declaration.travel_speed is not None),
    )
    (plan.out / "report.html").write_text(page, encoding="utf-8")
