from __future__ import annotations

from aff_runtime.safety.lease import Lease


def test_a_lease_lives_through_its_ticks_and_not_one_more() -> None:
    lease = Lease(3)
    assert [lease.tick(renewed=False) for _ in range(5)] == [False, False, False, True, True]


def test_renewal_starts_the_count_again() -> None:
    lease = Lease(2)
    pattern = [False, False, True, False, False, True]
    assert not any(lease.tick(renewed) for renewed in pattern)
