"""How often a dead control process may come back."""

from __future__ import annotations

from aff_runtime.app.supervisor.restart_policy import RestartPolicy


def test_the_third_death_within_a_minute_is_the_last() -> None:
    policy = RestartPolicy()
    assert policy.died(0.0) == 0.5
    assert policy.died(30.0) == 1.0
    assert policy.died(59.0) is None


def test_deaths_far_apart_always_get_the_short_pause() -> None:
    policy = RestartPolicy()
    assert [policy.died(70.0 * k) for k in range(5)] == [0.5] * 5
