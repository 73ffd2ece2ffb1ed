"""``python -m benchmarks.control``: run the tables, keep the numbers, write the page."""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

from benchmarks.control import cases, report
from benchmarks.control.jobs import Job, Row, do, timing
from benchmarks.control.laws import RIVALS
from benchmarks.control.lines import ROOT

TUNED_SEED, UNSEEN_SEED = 1, 101
SECTIONS = ("constant", "ramp", "roll", "follower", "mismatch")
ALL = ("shape-KF", *RIVALS)
OWN = ("shape-KF",)


def jobs_of(section: str, *, quick: bool, seed: int, unseen: bool) -> list[Job]:
    """Return the rows of a section; a second set of seeds runs the law alone."""
    laws = OWN if unseen else ALL
    if section == "constant":
        chosen = cases.constant_cases()
        chosen = [chosen[i] for i in (3, 8, 12)] if quick else chosen
        rich = {chosen[i].name for i in (0, 1)} if quick else {c.name for c in chosen[::3]}
        return [
            Job(section=section, case=c, laws=laws, seed=seed,
                extras=not unseen and c.name in rich)
            for c in chosen
        ]  # fmt: skip
    if section == "ramp":
        chosen = cases.ramp_cases()[: 1 if quick else None]
        return [Job(section=section, case=c, laws=laws, seed=seed) for c in chosen]
    if section == "roll":
        chosen = cases.roll_cases()[: 1 if quick else None]
        # quick: from before the 1x crossing at 6.05 in to behind it
        chosen = [replace(c, radius_in=6.3) for c in chosen] if quick else chosen
        return [
            Job(section=section, case=c, seed=seed, extras=i == 0 and not unseen and not quick,
                laws=laws if i == 0 else OWN, end_in=5.6 if quick else 2.5)
            for i, c in enumerate(chosen)
        ]  # fmt: skip
    if section == "follower":
        chosen = cases.follower_cases()[: 1 if quick else None]
        return [Job(section=section, case=c, laws=(), seed=seed) for c in chosen]
    chosen = cases.mismatch_cases()
    chosen = [c for c in chosen if c.note == "all5"][:1] if quick else chosen
    some = ("shape-KF", "plain blocks", "resonators", "FxLMS", "repetitive")
    return [
        Job(section=section, case=c, seed=seed,
            laws=some if c.note in ("all5", "delay50") and not unseen else OWN)
        for c in chosen
    ]  # fmt: skip


def main() -> int:
    """Run, print, write; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.control")
    parser.add_argument("--sections", default=",".join(SECTIONS))
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "control-bench")
    parser.add_argument("--docs", type=Path, default=None, help="also write the page and plots")
    parser.add_argument("--own", action="store_true", help="the shape law alone, no rivals")
    parser.add_argument("--report-only", action="store_true")
    given = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    quick = os.environ.get("QUICK", "") not in ("", "0")
    given.out.mkdir(parents=True, exist_ok=True)
    if not given.report_only:
        for section in given.sections.split(","):
            started = time.monotonic()  # noqa: TID251
            rows: list[Row] = []
            for found_rows in _run(section, quick, given.processes, given.own):
                rows += found_rows
                took_s = time.monotonic() - started  # noqa: TID251
                text = {"section": section, "quick": quick, "took_s": took_s, "rows": rows}
                (given.out / f"{section}.json").write_text(json.dumps(text, indent=1))
    found = [
        json.loads(path.read_text())
        for name in (*SECTIONS, "timing")
        if (path := given.out / f"{name}.json").exists()
    ]
    page = report.page(found)
    sys.stdout.write(page)
    (given.out / "control-bench.md").write_text(page)
    if given.docs is not None:
        (given.docs / "control-bench.md").write_text(page)
        report.plots(found, given.docs)
    return 0


def _run(section: str, quick: bool, processes: int, own: bool) -> Iterator[list[Row]]:
    if section == "timing":
        yield [timing(16), timing(24)]
        return
    jobs = jobs_of(section, quick=quick, seed=TUNED_SEED, unseen=False)
    if own:
        jobs = [replace(job, laws=job.laws and OWN, extras=False) for job in jobs]
    if not quick:
        jobs += jobs_of(section, quick=False, seed=UNSEEN_SEED, unseen=True)
    with ProcessPoolExecutor(processes) as pool:
        for rows in pool.map(do, jobs):
            for row in rows:
                sys.stderr.write(f"{report.line(row)}\n")
            yield rows


if __name__ == "__main__":
    raise SystemExit(main())
