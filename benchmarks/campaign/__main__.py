"""``python -m benchmarks.campaign --cases N --seed S --out DIR``; goes on where it was."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from benchmarks.campaign.cases import CYCLE, case_number, cases_for, numbers_of
from benchmarks.campaign.work import run_case, tell_again
from benchmarks.rows import read_row, write_row
from benchmarks.workers import Cluster, LostJobError, add_workers

ROOT = Path(__file__).resolve().parents[2]
LIMIT_S = 1800.0
"""For one case: it takes one to two minutes of a core."""
TIMES = 20
"""Every effect is drawn at least so often by default."""
KEYS = ("number", "group", "seed", "faults", "floor", "classes", "coordinate", "refine")
"""What a row is not whole without."""


class AnotherSeedError(Exception):
    """A campaign is to go on in the folder of another one."""


def run(
    seed: int, numbers: Sequence[int], workers: int, out: Path, until_s: float, scheduler: str = ""
) -> list[int]:
    """Run the cases that have no row yet; stop handing out new ones after ``until_s``.

    Returns
    -------
    The cases that lost every process that was given them.

    Raises
    ------
    AnotherSeedError
        The folder holds rows of another seed: a case of that number is not this one.
    """
    others = {row["seed"] for _, row in rows_of(out)} - {seed}
    if others:
        was = ", ".join(map(str, sorted(others)))
        raise AnotherSeedError(
            f"{out}: holds rows of seed {was}; go on with --seed {was}, or name another --out"
        )
    todo = [n for n in numbers if read_row(place(out, n), KEYS) is None]
    begun = time.monotonic()  # noqa: TID251

    def in_time() -> Iterator[tuple[int, int, Path]]:
        for number in todo:
            if time.monotonic() - begun > until_s:  # noqa: TID251
                return
            yield seed, number, out / "work" / f"{os.getpid()}-{number:05d}"

    lost = []
    with Cluster(
        run_case, workers, limit_s=LIMIT_S, scheduler=scheduler, name=_name, tell=_say
    ) as cluster:
        for at, row in cluster.run(in_time()):
            if isinstance(row, LostJobError):
                lost.append(todo[at])
                _say(f"{row}; it has no row")
                continue
            write_row(place(out, todo[at]), row)
            _say(line_of(row))
    return lost


def place(out: Path, number: int) -> Path:
    """Return the file of a case's row."""
    return out / "rows" / f"{number:05d}.json"


def _name(job: tuple[int, int, Path]) -> str:
    return f"case {job[1]} of seed {job[0]}"


def _say(text: str) -> None:
    sys.stderr.write(f"{text}\n")


def line_of(row: dict[str, Any]) -> str:
    """Return what became of a case in one line."""
    found = row["refine"]["verdict"]
    names = ", ".join(f"{e['effect']} at {e['location']}" for e in found.get("effects", ()))
    true = ", ".join(f"{f['effect']} at {f['location']}" for f in row["faults"])
    said = found.get("verdict", "failed")
    return f"{row['number']} {row['group']} [{true}]: {said} [{names}] {row['refine_s']:.0f} s"


def rows_of(out: Path) -> list[tuple[Path, dict[str, Any]]]:
    """Return every whole row with its file."""
    found = [(path, read_row(path, KEYS)) for path in sorted((out / "rows").glob("*.json"))]
    return [(path, row) for path, row in found if row is not None]


def tell_all_again(out: Path, workers: int, scheduler: str = "") -> list[int]:
    """Tell anew what the record of every row can show; return the cases that lost all workers."""
    kept, lost = rows_of(out), []
    with Cluster(
        tell_again,
        workers,
        limit_s=LIMIT_S,
        scheduler=scheduler,
        name=lambda row: f"case {row['number']}",
        tell=_say,
    ) as cluster:
        for at, row in cluster.run(row for _, row in kept):
            if isinstance(row, LostJobError):
                lost.append(kept[at][1]["number"])
                _say(f"{row}; its row stays as it was")
                continue
            write_row(kept[at][0], row)
    return lost


def main() -> int:
    """Run, then write the page; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.campaign")
    parser.add_argument(
        "--cases",
        type=int,
        default=cases_for(TIMES),
        help=f"default: as many as draw every effect {TIMES} times",
    )
    parser.add_argument(
        "--group", default="", choices=sorted(CYCLE), help="of the cases only those of this group"
    )
    parser.add_argument("--effect", default="", help="of the cases only those that have this one")
    parser.add_argument("--seed", type=int, default=100)
    add_workers(parser)
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
        from benchmarks.campaign.make import write_case

        given.out.mkdir(parents=True, exist_ok=True)
        case = case_number(given.seed, given.write_case)
        made = write_case(case, given.out)
        print(case.group, *made.faults, "SNR", *(f"{s:.3g}" for s in made.snr))
        return 0
    lost: list[int] = []
    if not given.report_only and not given.tell_again:
        numbers = numbers_of(given.cases, given.group, given.effect, given.seed)
        out = given.out.absolute()
        try:
            lost = run(given.seed, numbers, given.workers, out, given.for_s, given.scheduler)
        except AnotherSeedError as error:
            parser.error(str(error))
    from benchmarks.campaign.report import page

    if given.tell_again:
        lost = tell_all_again(given.out, given.workers, given.scheduler)
    text = page([row for _, row in rows_of(given.out)], given.note)
    print(text)
    (given.out / "refine-campaign.md").write_text(text, encoding="utf-8")
    if given.docs is not None:
        (given.docs / "refine-campaign.md").write_text(text, encoding="utf-8")
    return 1 if lost else 0


if __name__ == "__main__":
    raise SystemExit(main())
