"""How a fleet scales with workers, and what one killed worker costs it; on the example's lines."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from benchmarks.rows import read_row, write_row
from benchmarks.workers import by_hand, kill_when
from sim_plant.fleet.looks import fleet_in
from sim_plant.fleet.pipeline import TABLE, FleetPlan, refine_fleet

SCALING, LOST = "scaling.json", "lost.json"
KEYS = {
    SCALING: ("looks", "cores", "walls_s", "each_s", "tables_alike"),
    LOST: ("looks", "killed", "rows", "alike"),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Folders:
    """Where a bench of the fleet keeps what it has."""

    root: Path

    def plan(self, out: str, workers: int = 2, lines: str = "") -> FleetPlan:
        """Return a plan over the example of a name ("" is that of the whole table)."""
        home = self.root / lines
        return FleetPlan(
            lines=home / "lines", runs=home / "runs", out=self.root / out, workers=workers
        )

    def kept(self, name: str) -> dict[str, Any] | None:
        """Return what was measured, None where it was not."""
        return read_row(self.root / name, KEYS[name])


def scaling(
    folders: Folders, few: str, workers: Sequence[int], say: Callable[[str], None]
) -> None:
    """Refine the same looks with one worker, with two, ...; keep times and whether tables agree.

    A folder of results that is there from before would be no work: each run has a new one. One
    run goes before, unmeasured: it compiles what these looks need, once for this machine.
    """
    refine_fleet(folders.plan(f"{few}/before-{os.getpid()}", max(workers), few), say)
    walls, each, tables = {}, {}, []
    looks = 0
    for count in workers:
        plan = folders.plan(f"{few}/by-{count}-{os.getpid()}", count, few)
        outcome = refine_fleet(plan, say)
        looks = outcome.refined
        walls[str(count)], each[str(count)] = outcome.wall_s, outcome.each_s
        tables.append((plan.out / TABLE).read_bytes())
    row = {"looks": looks, "cores": os.cpu_count(), "walls_s": walls, "each_s": each}
    write_row(folders.root / SCALING, row | {"tables_alike": len(set(tables)) == 1})


def lost_worker(folders: Folders, few: str, say: Callable[[str], None]) -> None:
    """Refine with one worker of two killed half way, on a scheduler started as a person would.

    Beside it the same looks on a cluster of this machine; what is there of those is kept.
    """
    calm = folders.plan(f"{few}/calm", lines=few)
    refine_fleet(calm, say)
    plan = folders.plan(f"{few}/lost-{os.getpid()}", lines=few)
    looks, rows = len(fleet_in(plan.lines, plan.runs).looks), plan.out / "rows"
    with by_hand(folders.root / few / "dask") as (address, workers):
        threading.Thread(
            target=kill_when,
            args=(lambda: len(list(rows.glob("*.json"))) >= looks // 2, workers[0]),
            daemon=True,
        ).start()
        outcome = refine_fleet(replace(plan, scheduler=address), say)
        killed = workers[0].poll() is not None
    row = {
        "looks": looks,
        "killed": killed,
        "rows": outcome.refined,
        "alike": (calm.out / TABLE).read_bytes() == (plan.out / TABLE).read_bytes(),
    }
    write_row(folders.root / LOST, row)
