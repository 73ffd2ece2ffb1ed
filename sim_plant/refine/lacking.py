"""What records lack for a verdict, record by record, without a simulation."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable
from aff_runtime.base.refinement import Lacking, RecordLacks
from sim_plant.base.arrays import Array
from sim_plant.line.declared.declaration import Declaration
from sim_plant.refine.model.record_match import record_caveats, twin_of
from sim_plant.refine.model.run_caveats import (
    lines_of,
    rolls_of,
    run_caveats,
    shared,
    site_of_other_line,
)
from sim_plant.refine.model.run_match import run_on_line
from sim_plant.refine.model.twin import Twin
from sim_plant.refine.records.read import read_record
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.report.announce import holdout_caveats, shared_angle
from sim_plant.refine.report.folder import given_twice
from sim_plant.refine.report.outcome import RefineRequest
from sim_plant.refine.report.site_edit import SiteFile


def lacking(plan: RefineRequest, line: Declaration) -> Lacking:
    """Return what the records of a plan lack; one that cannot be used is named with its reason.

    Raises
    ------
    PlantError
        The site file of the plan is none.
    """
    site = SiteFile.read(plan.site) if plan.site is not None else None
    rows: list[RecordLacks] = []
    fitted: list[Recording] = []
    held: list[Recording] = []
    for paths, found in ((plan.records, fitted), (plan.holdout, held)):
        is_held = found is held
        for path in paths:
            try:
                record = run_on_line(line, read_record(path))
                twin = twin_of(line, record)
            except PlantError as error:
                name = printable(path.name)
                rows.append(RecordLacks(name=name, is_held=is_held, refused=str(error)))
                continue
            found.append(record)
            rows.append(_row(record, twin, is_held=is_held))
    rows, twice = _without_repeats(rows, (*fitted, *held))
    together = [] if twice else shared(fitted, held)
    together += [
        *shared_angle(fitted),
        *holdout_caveats(held),
        *lines_of((*fitted, *held)),
        *rolls_of(fitted),
    ]
    if site is not None:
        name = printable(site.path.name)
        of_other = site_of_other_line(site.names.name, (*fitted, *held))
        together += [f"--site {name}: {text}" for text in of_other]
    return Lacking(records=tuple(rows), together=tuple(together))


def caveats_of(known: Sequence[tuple[Recording, Twin]]) -> list[str]:
    """Return what cannot be claimed from records and their twins, each sentence once."""
    said = [text for _, twin in known for text in record_caveats(twin)]
    said += [text for record, twin in known for text in run_caveats(record, twin)]
    return list(dict.fromkeys(said))


def _row(record: Recording, twin: Twin, *, is_held: bool) -> RecordLacks:
    own = f"{record.path.name}: "
    return RecordLacks(
        name=printable(record.path.name),
        is_held=is_held,
        length_s=record.samples * record.sample_time_s,
        speed_m_s=_ends(twin.speed_m_s),
        tension_N=_ends(twin.tension_N),
        radius_m=twin.declaration.initial_radii_m.unwind,
        lacks=tuple(text.removeprefix(own) for text in caveats_of([(record, twin)])),
        said=tuple(map(printable, record.findings)),
    )


def _ends(values: Array) -> tuple[float, float]:
    return float(np.min(values)), float(np.max(values))


def _without_repeats(
    rows: Sequence[RecordLacks], records: Sequence[Recording]
) -> tuple[list[RecordLacks], bool]:
    """Return the rows, refused where a record is one before it again, and whether any is.

    ``records`` : of the rows that are not refused, in their order.
    """
    found, used = list(rows), [k for k, row in enumerate(rows) if not row.refused]
    for place, said in given_twice(records):
        row = rows[used[place]]
        found[used[place]] = RecordLacks(name=row.name, is_held=row.is_held, refused=said)
    return found, found != list(rows)
