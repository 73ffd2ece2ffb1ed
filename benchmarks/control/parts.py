"""Rows that share runs, together in one worker process."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchmarks.control import cases, store
from benchmarks.control.jobs import BenchRow, Job, do


def together(jobs: Sequence[Job]) -> list[list[Job]]:
    """Return the jobs in parts that share runs: one case, its seeds apart only for whole rolls.

    The line without any law, and what the law learned before a saved start, are run once a part.
    """
    parts: dict[tuple[str, cases.Case, int], list[Job]] = {}
    for job in jobs:
        seed = job.seed if job.section == "roll" else 0
        parts.setdefault((job.section, job.case, seed), []).append(job)
    return list(parts.values())


def do_together(part: tuple[Sequence[Job], Path]) -> list[BenchRow]:
    """Run jobs that share runs, keep every row as it comes, return them.

    A part that is done again goes on after the rows that its lost worker has kept.
    """
    jobs, folder = part
    rows = []
    for job in jobs:
        row = store.load(folder, job)
        if row is None:
            row = do(job)
            store.save(folder, job, row)
        rows.append(row)
    return rows
