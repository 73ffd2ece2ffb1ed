from __future__ import annotations

from math import nan

import pytest

from aff_runtime.base.signals import Outcome, Snapshot
from aff_runtime.safety.freshness import Freshness, FreshnessCheck
from aff_runtime.safety.params import FreshnessParams

MS = 1_000_000


def snapshot(*, fresh: bool, age_s: float, outcome: Outcome = Outcome.OK) -> Snapshot:
    return Snapshot(
        tick=0,
        t_ns=0,
        outcome=outcome,
        fresh=fresh,
        age_s=age_s,
        plc_heartbeat=0,
        status=0,
        roll_id=0,
        values=(),
    )


@pytest.fixture
def judge() -> FreshnessCheck:
    return FreshnessCheck(FreshnessParams(hold_after_s=0.015, fault_after_s=0.080))


def test_data_is_stale_until_a_heartbeat_has_moved(judge: FreshnessCheck) -> None:
    assert judge.judge(snapshot(fresh=False, age_s=0.0), 0) is Freshness.STALE
    assert judge.judge(snapshot(fresh=True, age_s=0.0), 5 * MS) is Freshness.GOOD


@pytest.mark.parametrize(
    ("age_ms", "expected"),
    [(15, Freshness.GOOD), (16, Freshness.HOLD), (80, Freshness.HOLD), (81, Freshness.STALE)],
)
def test_own_count_of_age_decides_when_the_snapshot_claims_youth(
    judge: FreshnessCheck, age_ms: int, expected: Freshness
) -> None:
    judge.judge(snapshot(fresh=True, age_s=0.0), 0)
    assert judge.judge(snapshot(fresh=False, age_s=0.0), age_ms * MS) is expected


@pytest.mark.parametrize("age_s", [0.081, nan, -1.0])
def test_an_old_or_senseless_age_in_the_snapshot_is_stale(
    judge: FreshnessCheck, age_s: float
) -> None:
    assert judge.judge(snapshot(fresh=True, age_s=age_s), 0) is Freshness.STALE


def test_failed_transactions_age_the_data(judge: FreshnessCheck) -> None:
    judge.judge(snapshot(fresh=True, age_s=0.0), 0)
    lost = snapshot(fresh=True, age_s=0.0, outcome=Outcome.TIMEOUT)
    assert judge.judge(lost, 20 * MS) is Freshness.HOLD
    assert judge.judge(lost, 85 * MS) is Freshness.STALE


def test_an_answering_plc_with_a_frozen_heartbeat_is_stale(judge: FreshnessCheck) -> None:
    judge.judge(snapshot(fresh=True, age_s=0.0), 0)
    for ms in range(5, 80, 5):
        judge.judge(snapshot(fresh=False, age_s=ms * 1e-3), ms * MS)
    assert judge.judge(snapshot(fresh=False, age_s=0.085), 85 * MS) is Freshness.STALE
