"""What refine was asked and what it found."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.reading.load import LineFile
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.report.site_edit import Proposal
from sim_plant.refine.report.verdict import Moment, Verdict
from sim_plant.refine.search.selection import Selection


@dataclass(frozen=True, slots=True, kw_only=True)
class RefineRequest:
    """What refine is to do.

    Attributes
    ----------
    line : path of the declaration.
    records : paths, to fit.
    holdout : the first is judged; empty: the first record fitted is, and the report calls it no
        proof.
    out : folder to write.
    without : names of effects left out of the library.
    workers : number of processes.
    site : site file that the AFF block is to go into; None: none.
    """

    line: Path
    records: tuple[Path, ...]
    holdout: tuple[Path, ...]
    out: Path
    without: tuple[str, ...] = ()
    workers: int = 2
    site: Path | None = None

    @property
    def command(self) -> str:
        """The command that repeats this run."""
        parts = ["sim-plant", "refine", str(self.line), *map(str, self.records)]
        for path in self.holdout:
            parts += ["--holdout", str(path)]
        for name in self.without:
            parts += ["--without", name]
        if self.site is not None:
            parts += ["--site", str(self.site)]
        return shlex.join([*parts, "--out", str(self.out)])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RecordOfOnset:
    """The fitted record in which something begins, and its error as declared and as amended."""

    moment: Moment
    evaluation: Evaluation


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Outcome:
    """What came out, with everything the report shows.

    Attributes
    ----------
    line : the line file.
    declared : the line as it was when the first record fitted began: its effects as they stood.
    caveats : what cannot be claimed, as sentences.
    record_of_onset : where what was found, or is unknown, begins; None where nothing has a moment.
    proposal : the site file with the AFF blocks, where one was given and there are blocks.
    """

    plan: RefineRequest
    line: LineFile
    declared: Declaration
    records: tuple[Recording, ...]
    caveats: tuple[str, ...]
    selection: Selection
    evaluation: Evaluation
    verdict: Verdict
    record_of_onset: RecordOfOnset | None = None
    proposal: Proposal | None = None

    @property
    def judged(self) -> Recording:
        """The record that was judged: the first held out, else the first fitted."""
        return self.records[len(self.plan.records) if self.plan.holdout else 0]

    @property
    def is_amended(self) -> bool:
        """Whether the amended line differs from the declared one."""
        return bool(self.selection.accepted or self.selection.adjustments)

    def records_said(self) -> str:
        """Return what was read: the records, their line speeds and their tensions."""
        names = [
            f"{record.path.name} ({'fitted' if k < len(self.plan.records) else 'held out'})"
            for k, record in enumerate(self.records)
        ]
        ends = [
            text
            for what, name, unit in (
                ("line speed", "line_speed_ref_m_s", "m/s"),
                ("tension", "tension_ref_N", "N"),
            )
            if (
                text := _ends(
                    what, unit, [r.columns[name] for r in self.records if name in r.columns]
                )
            )
        ]
        return "; ".join([f"Records: {', '.join(names)}", *ends]) + "."


def _ends(what: str, unit: str, columns: Sequence[Array]) -> str:
    """Return the least and the most of a channel over all records; empty without any."""
    if not columns:
        return ""
    low, high = min(map(np.min, columns)), max(map(np.max, columns))
    return f"{what} {low:.3g} to {high:.3g} {unit}"
