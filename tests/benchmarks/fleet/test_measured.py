"""Scaling is of runs that do the same work: nothing kept, nothing to compile, tables compared."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.fleet import measured
from benchmarks.fleet.measured import SCALING, Folders, scaling
from sim_plant.fleet.pipeline import TABLE, FleetOutcome, FleetPlan

LOOK_S = 30.0


class Fleet:
    """Stands for ``refine_fleet``: eight looks of 30 s; a first run has 20 s to compile."""

    def __init__(self, *tables: bytes) -> None:
        self.plans: list[FleetPlan] = []
        self._tables = tables

    def __call__(self, plan: FleetPlan, _: object) -> FleetOutcome:
        assert not (plan.out / TABLE).exists()
        plan.out.mkdir(parents=True)
        (plan.out / TABLE).write_bytes(self._tables[len(self.plans)])
        self.plans.append(plan)
        wall_s = 8 * LOOK_S / plan.workers + (20.0 if len(self.plans) == 1 else 0.0)
        return FleetOutcome(
            findings=(), lost=(), refined=8, waiting=0, wall_s=wall_s, each_s=LOOK_S
        )


@pytest.mark.parametrize(("last", "alike"), [(b"one", True), (b"two", False)])
def test_the_first_run_is_not_measured_and_the_others_are_compared(
    last: bytes, alike: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fleet = Fleet(b"before", b"one", last)
    monkeypatch.setattr(measured, "refine_fleet", fleet)
    folders = Folders(root=tmp_path)
    assert folders.kept(SCALING) is None
    scaling(folders, "few-8", (1, 2), print)
    kept = folders.kept(SCALING)
    assert kept is not None
    assert kept["walls_s"] == {"1": 240.0, "2": 120.0}
    assert (kept["looks"], kept["tables_alike"]) == (8, alike)
    assert [plan.workers for plan in fleet.plans] == [2, 1, 2]
    assert {plan.lines for plan in fleet.plans} == {tmp_path / "few-8" / "lines"}
    assert len({plan.out for plan in fleet.plans}) == 3
