"""The same cases on two clusters, a worker of one killed half way, and the rows compared.

``python -m benchmarks.campaign.lost_worker [--cases 24] [--seed S] [--out DIR]``: first on a
cluster of this machine with two workers, then on a scheduler and two workers that are started here
as a person would, ``dask scheduler`` and ``dask worker``. When half of the cases have their rows
one worker is killed (SIGKILL) with the case that it has. Rows that are there are not done again,
so a stopped comparison goes on.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from aff_runtime.base.python_child import module_command
from benchmarks.campaign.__main__ import ROOT, place, rows_of, run
from benchmarks.campaign.cases import cases_for, numbers_of

OF_THE_CLOCK = ("made_s", "refine_s", "refine_cpu_s")
"""What no two runs have in common."""
FOR_EVER_S = 1e9
PATIENCE_S = 120.0


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


@contextmanager
def by_hand(folder: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """Start a scheduler and two workers on loopback; yield its address and the workers."""
    folder.mkdir(parents=True, exist_ok=True)
    address = folder / "scheduler.json"
    address.unlink(missing_ok=True)
    rest = ["--no-dashboard", "--scheduler-file", str(address)]
    scheduler = ["distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0"]
    worker = ["distributed.cli.dask_worker", "--nthreads", "1", "--no-nanny"]
    begun = [_begun([*scheduler, *rest], folder / "scheduler.log")]
    try:
        _until(lambda: address.exists() and address.stat().st_size > 0, "a scheduler")
        workers = [_begun([*worker, *rest], folder / f"worker{k}.log") for k in (1, 2)]
        begun += workers
        yield _told(address), workers
    finally:
        for process in reversed(begun):
            process.kill()
            process.wait()


def _begun(command: Sequence[str], log: Path) -> subprocess.Popen[bytes]:
    with log.open("wb") as said:
        begun = [*module_command(command[0]), *command[1:]]
        return subprocess.Popen(begun, stdout=said, stderr=said)


def _told(file: Path) -> str:
    return str(json.loads(file.read_text(encoding="utf-8"))["address"])


def _until(ready: Any, what: str) -> None:
    end = time.monotonic() + PATIENCE_S  # noqa: TID251
    while not ready():
        if time.monotonic() > end:  # noqa: TID251
            raise TimeoutError(f"{what}: nothing after {PATIENCE_S:g} s; see its log")
        time.sleep(0.05)  # noqa: TID251


def kill_half_way(out: Path, numbers: Sequence[int], process: subprocess.Popen[bytes]) -> None:
    """Kill a worker when half of the cases have rows."""
    while sum(place(out, n).exists() for n in numbers) < len(numbers) // 2:
        if process.poll() is not None:
            return
        time.sleep(0.2)  # noqa: TID251
    os.kill(process.pid, signal.SIGKILL)
    sys.stderr.write(f"worker {process.pid} killed\n")


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
            target=kill_half_way, args=(other, numbers, workers[0]), daemon=True
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
