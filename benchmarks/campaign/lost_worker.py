"""The same cases on two clusters, a worker of one killed half way, and the rows compared.

``python -m benchmarks.campaign.lost_worker [--cases 24] [--seed S] [--out DIR]``: first on a
cluster of this machine with two workers, then on a scheduler and two workers that are started here
as a person would, ``dask scheduler`` and ``dask worker``. When half of the cases have their rows
one worker is killed (SIGKILL) with the case that it has. Rows that are there are not done again,
so a stopped comparison goes on.
"""

from __future__ import annotations

import argparse
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks.campaign.__main__ import ROOT, place, rows_of, run
from benchmarks.campaign.cases import cases_for, numbers_of
from benchmarks.workers import by_hand, kill_when

OF_THE_CLOCK = ("made_s", "refine_s", "refine_cpu_s")
"""What no two runs have in common."""
FOR_EVER_S = 1e9


def differences(
    ours: Mapping[int, dict[str, Any]], theirs: Mapping[int, dict[str, Any]]
) -> list[str]:
    """Return in words which cases have no row on either side, and which keys differ in the others.

    What a run says on its way has times in it; of that only the verdict counts.
    """
    found = [f"case {n}: a row on one side only" for n in sorted(ours.keys() ^ theirs.keys())]
    for n in sorted(ours.keys() & theirs.keys()):
        one, other = _lasting(ours[n]), _lasting(theirs[n])
        keys = sorted(k for k in one.keys() | other.keys() if one.get(k) != other.get(k))
        if keys:
            found.append(f"case {n}: {', '.join(keys)}")
    return found


def _lasting(row: Mapping[str, Any]) -> dict[str, Any]:
    kept = {name: value for name, value in row.items() if name not in (*OF_THE_CLOCK, "refine")}
    verdict = {k: v for k, v in row["refine"]["verdict"].items() if k != "holdout"}  # a path
    return kept | {"verdict": verdict}


def half_done(out: Path, numbers: Sequence[int]) -> bool:
    """Whether half of the cases have rows."""
    return sum(place(out, n).exists() for n in numbers) >= len(numbers) // 2


def main() -> int:
    """Run both, compare; return 1 where anything differs."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.campaign.lost_worker", description=__doc__
    )
    parser.add_argument("--cases", type=int, default=24)
    parser.add_argument("--seed", type=int, default=100)
    parser.add_argument("--group", default="", help="of the cases only those of this group")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "campaign-lost-worker")
    given = parser.parse_args()
    out = given.out.absolute()
    numbers = numbers_of(cases_for(20), given.group)[: given.cases]
    local, other = out / "local", out / "by-hand"
    run(given.seed, numbers, 2, local, FOR_EVER_S)
    with by_hand(out / "dask") as (address, workers):
        threading.Thread(
            target=kill_when, args=(lambda: half_done(other, numbers), workers[0]), daemon=True
        ).start()
        run(given.seed, numbers, 0, other, FOR_EVER_S, address)
        killed = workers[0].poll()
    rows = [{row["number"]: row for _, row in rows_of(side)} for side in (local, other)]
    found = differences(*rows)
    if killed is None:
        found.append("no worker was killed: the rows were there before; give another --out")
    print("\n".join(found) or f"{len(numbers)} cases: the same rows, one worker killed half way")
    return 1 if found else 0


if __name__ == "__main__":
    raise SystemExit(main())
