"""The folder that a refinement writes: asked before the work, whole or not at all after it."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from aff_runtime.base.errors import PlantError
from sim_plant.refine.outcome import Plan
from sim_plant.refine.record import Record

FILES = ("verdict.json", "report.html", "line_amended.yaml", "aff_block.yaml")


def check_folder(plan: Plan) -> None:
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
    ours = {(plan.out / name).resolve() for name in FILES}
    for path in (plan.line, *plan.records, *plan.holdout):
        if path.resolve() in ours:
            raise PlantError(f"{path}: would be overwritten; choose another --out")


def check_apart(records: Sequence[Record], held: Sequence[Record]) -> None:
    """Refuse a record that is given twice: an error on what was fitted proves nothing.

    Raises
    ------
    PlantError
        When two files hold the same bytes.
    """
    known: dict[str, Record] = {}
    for record in (*records, *held):
        other = known.setdefault(record.sha256, record)
        if other is not record:
            raise PlantError(
                f"{record.path}: is the same record as {other.path}; "
                "fit and judge on different records, or leave this one out"
            )


def publish(plan: Plan, write: Callable[[Plan], None]) -> None:
    """Let ``write`` fill a folder beside the results, then put them in place together.

    A result of an earlier run that this one does not have is taken away: an old AFF block beside
    a new verdict would be pasted.

    Raises
    ------
    PlantError
        When the folder cannot be written.
    """
    try:
        plan.out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".refine-", dir=plan.out) as name:
            fresh = Path(name)
            write(replace(plan, out=fresh))
            for file in FILES:
                if (fresh / file).exists():
                    (fresh / file).replace(plan.out / file)
                else:
                    (plan.out / file).unlink(missing_ok=True)
    except OSError as error:
        raise PlantError(f"--out {plan.out}: cannot be written ({error})") from error
