"""``python -m benchmarks.campaign --cases N --seed S --out DIR``; goes on where it was."""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Sequence
from concurrent.futures import Future, as_completed
from pathlib import Path
from typing import Any

from benchmarks.campaign.pool import pool_of
from benchmarks.campaign.work import do, tell_again

ROOT = Path(__file__).resolve().parents[2]


def run(seed: int, numbers: Sequence[int], workers: int, out: Path, until_s: float) -> None:
    """Run the cases that have no row yet; stop handing out new ones after ``until_s``."""
    rows = out / "rows"
    rows.mkdir(parents=True, exist_ok=True)
    todo = [n for n in numbers if not (rows / f"{n:05d}.json").exists()]
    begun = time.monotonic()  # noqa: TID251
    with pool_of(workers) as pool:
        running: dict[Future[dict[str, Any]], int] = {}
        while todo or running:
            late = time.monotonic() - begun > until_s  # noqa: TID251
            while todo and len(running) < workers and not late:
                number = todo.pop(0)
                job = pool.submit(do, seed, number, out / "work" / f"{os.getpid()}-{number:05d}")
                running[job] = number
            if not running:
                return
            done = next(as_completed(running))
            number = running.pop(done)
            row = done.result()
            text = json.dumps(row, indent=1, default=float) + "\n"
            (rows / f"{number:05d}.json").write_text(text, encoding="utf-8")
            said = row["refine"]["verdict"].get("verdict", "failed")
            names = ", ".join(
                f"{e['effect']} at {e['location']}"
                for e in row["refine"]["verdict"].get("effects", ())
            )
            true = ", ".join(f"{f['effect']} at {f['location']}" for f in row["faults"])
            sys.stderr.write(
                f"{number} {row['group']} [{true}]: {said} [{names}] {row['refine_s']:.0f} s\n"
            )


def tell_all_again(paths: Sequence[Path], workers: int) -> None:
    """Tell anew what the record of every row can show."""
    rows = [json.loads(p.read_text(encoding="utf-8")) for p in paths]
    with pool_of(workers) as pool:
        for path, row in zip(paths, pool.map(tell_again, rows), strict=True):
            path.write_text(json.dumps(row, indent=1, default=float) + "\n", encoding="utf-8")


def main() -> int:
    """Run, then write the page; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.campaign")
    parser.add_argument("--cases", type=int, default=600)
    parser.add_argument("--seed", type=int, default=100)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "campaign")
    parser.add_argument("--docs", type=Path, default=None, help="also write the page here")
    parser.add_argument("--for-s", type=float, default=1e9, help="hand out no case after this")
    parser.add_argument("--report-only", action="store_true")
    parser.add_argument(
        "--tell-again",
        action="store_true",
        help="tell anew what the rows' records can show, then report",
    )
    parser.add_argument("--note", default="", help="a sentence under the page's head")
    parser.add_argument(
        "--write-case",
        type=int,
        default=None,
        metavar="NUMBER",
        help="only write the files of one case into --out",
    )
    given = parser.parse_args()
    if given.write_case is not None:
        from benchmarks.campaign.cases import case_number
        from benchmarks.campaign.make import write_case

        given.out.mkdir(parents=True, exist_ok=True)
        case = case_number(given.seed, given.write_case)
        made = write_case(case, given.out)
        print(case.group, *made.faults, "SNR", *(f"{s:.3g}" for s in made.snr))
        return 0
    if not given.report_only and not given.tell_again:
        for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_NUM_THREADS"):
            os.environ.setdefault(name, "1")
        run(given.seed, range(given.cases), given.workers, given.out, given.for_s)
    from benchmarks.campaign.report import page

    paths = sorted((given.out / "rows").glob("*.json"))
    if given.tell_again:
        tell_all_again(paths, given.workers)
    text = page([json.loads(p.read_text(encoding="utf-8")) for p in paths], given.note)
    print(text)
    (given.out / "refine-campaign.md").write_text(text, encoding="utf-8")
    if given.docs is not None:
        (given.docs / "refine-campaign.md").write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
