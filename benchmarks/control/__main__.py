"""``python -m benchmarks.control``: run the tables row by row, keep every row, write the page."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from benchmarks.control import cases, extras, report, store
from benchmarks.control.jobs import BOTH, NO_SWRAP, ORACLE, PERFECT, SAVED, BenchRow, Job
from benchmarks.control.laws import OWN, RIVALS
from benchmarks.control.lines import ROOT
from benchmarks.control.parts import do_together, together
from benchmarks.workers import LostJobError, WorkerPool

LIMIT_S = 3600.0
"""For rows run together; those of a whole roll take a few minutes of a core."""
TUNED_SEED, UNSEEN_SEED = 1, 101
SECTIONS = ("constant", "ramp", "roll", "follower", "mismatch", "transient", "film")
FOLLOWERS = ("follower, tension", BOTH, "follower, velocity", "velocity and unwind")


def jobs_of(section: str, *, quick: bool, seed: int) -> list[Job]:
    """Return the rows of a section: every law on every case; the short set for ``quick``."""
    every = (OWN, *RIVALS)
    if section == "constant":
        chosen = cases.constant_cases()
        chosen = [chosen[i] for i in (3, 8, 12)] if quick else chosen
        laws: tuple[str, ...] = (*every, PERFECT, SAVED, ORACLE)
    elif section == "ramp":
        chosen, laws = cases.ramp_cases()[: 1 if quick else None], (*every, PERFECT)
    elif section == "roll":
        chosen, laws = cases.roll_cases()[: 1 if quick else None], every
        # quick: from before the 1x crossing at 6.05 in to behind it
        chosen = [replace(c, radius_in=6.3) for c in chosen] if quick else chosen
    elif section == "follower":
        chosen, laws = cases.follower_cases()[: 1 if quick else None], FOLLOWERS
    elif section == "transient":
        chosen, laws = cases.transient_cases()[: 3 if quick else None], (OWN,)
    elif section == "film":
        chosen, laws = [*cases.film_cases(), *cases.film_ramp_cases()], (OWN, PERFECT)
        chosen = chosen[:1] if quick else chosen
    else:
        chosen, laws = cases.mismatch_cases(), every
        chosen = [c for c in chosen if c.note == "all5"][:1] if quick else chosen
    end_in = 5.6 if quick and section == "roll" else 2.5
    jobs = [
        Job(section=section, case=c, law=law, seed=seed, end_in=end_in)
        for c in chosen
        for law in laws
    ]
    if section == "roll" and not quick:
        jobs.append(replace(jobs[0], law=NO_SWRAP))
    return jobs


def chosen_jobs(sections: Sequence[str], seeds: Sequence[int], *, quick: bool) -> list[Job]:
    """Return the jobs asked for, whole rolls first, because one of them takes longest."""
    jobs = [
        job
        for section in sections
        if section in SECTIONS
        for seed in seeds
        for job in jobs_of(section, quick=quick, seed=seed)
    ]
    return sorted(jobs, key=lambda job: job.section != "roll")


def only(jobs: Sequence[Job], *, laws: str, names: str) -> list[Job]:
    """Return the jobs of these laws and cases (divided by ;, empty: all).

    Raises
    ------
    SystemExit
        When one of them is the name of no job; the text lists what there is.
    """
    kept = set(jobs)
    for wanted, names_of in (
        (laws, {job: job.law for job in jobs}),
        (names, {job: job.case.name for job in jobs}),
    ):
        asked = wanted.split(";") if wanted else list(names_of.values())
        if unknown := [name for name in asked if name not in names_of.values()]:
            there = "; ".join(sorted(set(names_of.values())))
            raise SystemExit(f"no row of {unknown}; there are: {there}")
        kept &= {job for job, name in names_of.items() if name in asked}
    return [job for job in jobs if job in kept]


def run_jobs(jobs: Sequence[Job], folder: Path, processes: int) -> tuple[int, float, int]:
    """Run what has no row yet, keep every row as it comes.

    Returns
    -------
    How many rows there were to run, the CPU seconds, and how many parts lost all workers.
    """
    todo = [job for job in jobs if store.load(folder, job) is None]
    _say(f"{len(jobs)} rows, {len(jobs) - len(todo)} of them kept from before")
    spent_s, ended, lost = 0.0, 0, 0
    with WorkerPool(do_together, processes, limit_s=LIMIT_S, name=_name, tell=_say) as pool:
        for _, rows in pool.run((part, folder) for part in together(todo)):
            if isinstance(rows, LostJobError):
                lost += 1
                _say(f"{rows}; what it lacks is not on the page")
                continue
            for row in rows:
                ended, spent_s = ended + 1, spent_s + row["cpu_s"]
                _say(f"{ended}/{len(todo)} {row['cpu_s']:.0f} s {report.line(row)}")
    return len(todo), spent_s, lost


def _name(part: tuple[Sequence[Job], Path]) -> str:
    first = part[0][0]
    return f"{len(part[0])} rows of {first.section}, {first.case.name}, seed {first.seed}"


def _say(text: str) -> None:
    sys.stderr.write(f"{text}\n")


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.control")
    parser.add_argument("--sections", default=",".join(SECTIONS))
    parser.add_argument("--seeds", default=f"{TUNED_SEED},{UNSEEN_SEED}")
    parser.add_argument("--laws", default="", help="only these, divided by ;")
    parser.add_argument("--cases", default="", help="only these, as the tables name them; by ;")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "control-bench")
    parser.add_argument("--docs", type=Path, default=None, help="also write the page and plots")
    parser.add_argument("--fresh", action="store_true", help="run rows again that are there")
    parser.add_argument("--report-only", action="store_true")
    parser.add_argument(
        "--timing", action="store_true", help="cost of one tick; on a quiet machine"
    )
    parser.add_argument(
        "--memory", type=float, default=0.0, help="minutes of ticks without a plant"
    )
    parser.add_argument("--wire", action="store_true", help="three rows over the wire, real time")
    return parser.parse_args()


def main() -> int:
    """Run, print, write; return the exit code."""
    given = _arguments()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    quick = os.environ.get("QUICK", "") not in ("", "0")
    seeds = [int(s) for s in given.seeds.split(",")][: 1 if quick else None]
    folder = given.out / "quick" if quick else given.out
    jobs = chosen_jobs(given.sections.split(","), seeds, quick=quick)
    jobs = only(jobs, laws=given.laws, names=given.cases)
    if given.fresh:
        for job in jobs:
            store.place(folder, job).unlink(missing_ok=True)
    lost = 0
    started = time.monotonic()  # noqa: TID251
    if not given.report_only:
        count, spent_s, lost = run_jobs(jobs, folder, given.processes)
        took_s = time.monotonic() - started  # noqa: TID251
        _say(f"{count} rows: {took_s:.0f} s, {spent_s:.0f} CPU s")
        if count:
            extras.note_run(folder, count, took_s, spent_s)
    extras.run_asked(given, folder)
    everything = chosen_jobs(SECTIONS, seeds, quick=quick)
    rows: list[BenchRow] = [
        row for job in everything if (row := store.load(folder, job)) is not None
    ]
    rows += extras.rows(folder)
    missing = len(everything) - sum("cpu_s" in r for r in rows)
    page = report.page(rows, missing, quick=quick)
    sys.stdout.write(page)
    (folder / "control-bench.md").write_text(page)
    if given.docs is not None and not quick:
        (given.docs / "control-bench.md").write_text(page)
        report.plots(rows, given.docs)
    return 1 if lost else 0


if __name__ == "__main__":
    raise SystemExit(main())
