"""The folder that refine writes: checked before the work, filled once all results are there."""

from __future__ import annotations

import contextlib
import fcntl
import itertools
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from aff_runtime.base.errors import PlantError
from aff_runtime.base.refinement import SUMMARY
from sim_plant.refine.model.record_match import sidecar_of
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.report.outcome import RefineRequest

FRESH = ".refine-"
"""How the name of a folder begins that is filled before its files are put in place."""
FILES = (
    "verdict.json",
    SUMMARY,
    "report.html",
    "line_amended.yaml",
    "aff_block.yaml",
    "site_proposed.yaml",
)


def check_folder(plan: RefineRequest) -> None:
    """Refuse a folder that cannot be written, before minutes of work; makes nothing.

    Raises
    ------
    PlantError
        When a part of the path is a file, may not be written, or an input would be overwritten.
    """
    there = plan.out.absolute()
    while not os.path.lexists(there) and there != there.parent:
        there = there.parent
    if not there.is_dir():
        raise PlantError(f"--out {plan.out}: {there} is no folder; choose another --out")
    if not os.access(there, os.W_OK | os.X_OK):
        raise PlantError(f"--out {plan.out}: {there} may not be written; choose another --out")
    for name in FILES:
        if os.path.isdir(plan.out / name):  # Path's own raises on a long name
            raise PlantError(
                f"--out {plan.out}: its {name} is a folder; take it away, or choose another --out"
            )
    ours = {os.path.realpath(plan.out / name) for name in FILES}
    records = (*plan.records, *plan.holdout)
    given = () if plan.site is None else (plan.site,)
    for path in (
        plan.line,
        *given,
        *records,
        *(sidecar_of(path) for path in records if path.name),
    ):
        if os.path.realpath(path) in ours:  # unlike resolve, no error on links in a circle
            raise PlantError(f"{path}: would be overwritten; choose another --out")


def check_apart(records: Sequence[Recording], held: Sequence[Recording]) -> None:
    """Refuse a record that is given twice: an error on what was fitted proves nothing.

    Raises
    ------
    PlantError
        When two files hold the same readings, packed in another way or not.
    """
    for _, said in given_twice((*records, *held)):
        raise PlantError(said)


def given_twice(records: Sequence[Recording]) -> Iterator[tuple[int, str]]:
    """Yield the place of every record that is one before it again, and a sentence."""
    for first, second in itertools.combinations(range(len(records)), 2):
        if _same(records[first], records[second]):
            yield (
                second,
                f"{records[second].path}: is the same record as {records[first].path}; "
                "fit and judge on different records, or leave this one out",
            )


def _same(first: Recording, second: Recording) -> bool:
    if first.sha256 == second.sha256:
        return True
    return first.columns.keys() == second.columns.keys() and all(
        np.array_equal(values, second.columns[name]) for name, values in first.columns.items()
    )


@contextlib.contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Lock the folder against other refine processes; remove what a killed one has left there."""
    held = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(held, fcntl.LOCK_EX)  # the kernel lets go of it when this process ends
        for left in folder.glob(FRESH + "*"):
            shutil.rmtree(left, ignore_errors=True)
        yield
    finally:
        os.close(held)


def publish(plan: RefineRequest, write: Callable[[RefineRequest], None]) -> None:
    """Let ``write`` fill a folder next to the results, then put them in place together.

    A file of an earlier refine that this one does not write is removed: an old AFF block beside
    a new verdict would be pasted.

    Raises
    ------
    PlantError
        When the folder cannot be written.
    """
    try:
        plan.out.mkdir(parents=True, exist_ok=True)
        with _alone(plan.out), tempfile.TemporaryDirectory(prefix=FRESH, dir=plan.out) as name:
            fresh = Path(name)
            write(replace(plan, out=fresh))
            for file in FILES:
                if (fresh / file).exists():
                    (fresh / file).replace(plan.out / file)
                else:
                    (plan.out / file).unlink(missing_ok=True)
    except OSError as error:
        raise PlantError(f"--out {plan.out}: cannot be written ({error})") from error
