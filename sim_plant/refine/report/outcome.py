"""What refine was asked and what it found."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path

from sim_plant.line.declaration import Declaration
from sim_plant.line.load import LineFile
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.report.site_edit import Proposal
from sim_plant.refine.report.verdict import Verdict
from sim_plant.refine.search.selection import Selection


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
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
class Outcome:
    """What came out, with everything the report shows.

    Attributes
    ----------
    line : the line file.
    declared : the line as it was when the first record fitted began: its effects as they stood.
    limits : what cannot be claimed, as sentences.
    proposal : the site file with the AFF blocks, where one was given and there are blocks.
    """

    plan: Plan
    line: LineFile
    declared: Declaration
    records: tuple[Recording, ...]
    limits: tuple[str, ...]
    selection: Selection
    evaluation: Evaluation
    verdict: Verdict
    proposal: Proposal | None = None
