import asyncio
import os
import select

import pytest

from sim_plant.servers.realtime import RealTimeStepper, ask_for_realtime
from sim_plant.servers.timer_fd import PeriodicTimer
from tests.each_case import each_case


@each_case(
    ("due", "steps", "late", "skipped"),
    [(0, 0, 0, 0), (1, 1, 0, 0), (4, 4, 3, 0), (5, 4, 3, 1), (100, 4, 3, 96)],
)
def test_at_most_four_samples_are_made_up_for_at_once(due, steps, late, skipped):
    done = []
    stepper = RealTimeStepper(lambda: done.append(1), 0.005)
    stepper.catch_up(due)
    assert (len(done), stepper.late_samples, stepper.skipped_samples) == (steps, late, skipped)


def test_the_timer_counts_every_period_even_when_nobody_reads():
    timer = PeriodicTimer(0.001)
    try:
        total = 0
        for _ in range(3):
            assert select.select([timer.fileno()], [], [], 10.0)[0]
            total += timer.expirations()
        assert total >= 3
    finally:
        timer.close()


def test_a_timer_that_has_not_expired_says_none():
    timer = PeriodicTimer(3600.0)
    try:
        assert timer.expirations() == 0
    finally:
        timer.close()
        timer.close()


def test_an_impossible_period_is_refused():
    with pytest.raises(OSError, match="timerfd_settime"):
        PeriodicTimer(-1.0)


def test_a_failing_step_ends_the_stepping_and_is_told():
    def fail():
        raise ArithmeticError("kernel")

    async def run():
        stepper = RealTimeStepper(fail, 0.001)
        await asyncio.wait_for(stepper.start(), 10.0)

    with pytest.raises(ArithmeticError, match="kernel"):
        asyncio.run(run())


@pytest.mark.parametrize("allowed", [True, False])
def test_realtime_rights_are_asked_for_and_the_answer_is_told(monkeypatch, allowed):
    asked = []

    def ask(pid, policy, parameters):
        asked.append((pid, policy, parameters.sched_priority))
        if not allowed:
            raise PermissionError

    monkeypatch.setattr(os, "sched_setscheduler", ask)
    assert ask_for_realtime() is allowed
    assert asked == [(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, 70)]
