"""``python -m benchmarks.fleet``: the example of a fleet, refined, scored and put on a page.

Goes on where it was stopped: records and rows are kept in ``--out``. Without ``--scaling`` and
``--lost`` the lines are done; with one of them that alone, on a small example of its own.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

from benchmarks.fleet.measured import LOST, SCALING, Folders, lost_worker, scaling
from benchmarks.fleet.page import page
from benchmarks.fleet.scored import Scored, in_order
from sim_plant.cli.output import say
from sim_plant.fleet.example import drawn, name_of, write_fleet
from sim_plant.fleet.looks import fleet_in
from sim_plant.fleet.pipeline import TABLE, refine_fleet
from sim_plant.fleet.rows import kept_result, row_file

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "results" / "fleet.md"


def scored_lines(folders: Folders, seed: int, count: int) -> list[Scored]:
    """Return every look at the first lines that has a row, beside what it hides."""
    plan, found = folders.plan(""), []
    looks = fleet_in(plan.lines, plan.runs).looks if plan.lines.exists() else []
    for number in range(1, count + 1):
        name = name_of(number)
        own = [kept_result(row_file(plan.out, k.key), say) for k in looks if k.line == name]
        results = [result for result in own if result is not None]
        if results:
            found += in_order(drawn(seed, number)[1], results)
    return found


def main(arguments: list[str]) -> int:
    """Do a part, then write the page; 1 where looks were lost."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fleet", description=__doc__)
    parser.add_argument("--lines", type=int, default=200, help="of the example (200)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--most", type=int, default=None, help="looks this time; the rest waits")
    parser.add_argument("--scaling", type=int, default=0, metavar="N", help="by 1, 2, ...")
    parser.add_argument("--up-to", type=int, default=2, help="workers of --scaling (2)")
    parser.add_argument("--lost", type=int, default=0, metavar="N", help="a worker is killed")
    parser.add_argument("--records", action="store_true", help="only make the records")
    parser.add_argument("--report-only", action="store_true")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "fleet")
    parser.add_argument("--docs", action="store_true", help="write docs/results/fleet.md")
    given = parser.parse_args(arguments)
    folders, lost = Folders(root=given.out.absolute()), 0
    few = given.scaling or given.lost
    home = folders.plan("", lines=f"few-{few}" if few else "")
    if not given.report_only:
        write_fleet(few or given.lines, given.seed, home.lines, home.runs, say)
    if given.records:
        return 0
    if given.scaling:
        counts = [n for n in (1, 2, 4, 8, 16) if n <= given.up_to]
        scaling(folders, f"few-{few}", counts, say)
    elif given.lost:
        lost_worker(folders, f"few-{few}", say)
    elif not given.report_only:
        plan = replace(folders.plan("", given.workers), most=given.most)
        lost = len(refine_fleet(plan, say).lost)
    table = folders.root / TABLE
    text = page(
        scored_lines(folders, given.seed, given.lines),
        given.lines,
        table if table.exists() else None,
        folders.kept(SCALING),
        folders.kept(LOST),
    )
    target = PAGE if given.docs else folders.root / "fleet.md"
    target.write_text(text, encoding="utf-8")
    print(f"page: {target}")
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
