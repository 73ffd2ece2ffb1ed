"""Steps a plant in real time inside an asyncio loop, on absolute deadlines of a kernel timer."""

from __future__ import annotations

import asyncio
import gc
import os
from collections.abc import Callable

from aff_runtime.base.errors import PlantError
from sim_plant.servers.timer_fd import PeriodicTimer

_PRIORITY = 70
_MOST_AT_ONCE = 4


def ask_for_realtime(priority: int = _PRIORITY) -> bool:
    """Ask for SCHED_FIFO for this process (children excepted); return whether it was granted."""
    policy = os.SCHED_FIFO | os.SCHED_RESET_ON_FORK
    try:
        os.sched_setscheduler(0, policy, os.sched_param(priority))
    except OSError:
        return False
    return True


def shorten_garbage_collections() -> None:
    """Leave what this process has loaded out of every collection from here on.

    It holds for the whole process and for good, so it is for a process that serves and then ends.
    """
    gc.collect()
    gc.freeze()


class RealTimeStepper:
    """Calls ``step`` once per period.

    After a pause at most four samples are made up for at once, so that the wire stays served;
    the rest never happens, neither for the line nor for its PLC, and is counted.

    Attributes
    ----------
    late_samples : samples that were made up for.
    skipped_samples : samples that never happened.
    failure : set when ``step`` raised; nothing is stepped any more.
    """

    def __init__(self, step: Callable[[], None], period_s: float) -> None:
        self._step = step
        self._period_s = period_s
        self._timer: PeriodicTimer | None = None
        self._waiting: list[asyncio.Future[None]] = []
        self.late_samples = 0
        self.skipped_samples = 0
        self.failure: asyncio.Future[None] | None = None

    def start(self) -> asyncio.Future[None]:
        """Begin; the future never completes but carries the exception of a failed step."""
        loop = asyncio.get_running_loop()
        self.failure = loop.create_future()
        self._timer = PeriodicTimer(self._period_s)
        loop.add_reader(self._timer.fileno(), self._on_timer)
        return self.failure

    def stop(self) -> None:
        """Step no more; who waits for a sample waits in vain."""
        for waiting in self._waiting:
            waiting.cancel()
        self._waiting.clear()
        if self._timer is not None:
            asyncio.get_running_loop().remove_reader(self._timer.fileno())
            self._timer.close()
            self._timer = None

    async def next_sample(self) -> None:
        """Wait for the end of the next sample."""
        waiting: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting.append(waiting)
        await waiting

    async def advance(self, samples: int) -> None:
        """Refuse: the time is real.

        Raises
        ------
        PlantError
            Always.
        """
        raise PlantError(
            f"step {samples}: this plant runs in real time; start it with serve --stepped"
        )

    def _on_timer(self) -> None:
        if self._timer is not None:
            self.catch_up(self._timer.expirations())

    def catch_up(self, due: int) -> None:
        """Step the ``due`` samples, at most four of them."""
        now = min(due, _MOST_AT_ONCE)
        self.skipped_samples += due - now
        self.late_samples += max(0, now - 1)
        try:
            for _ in range(now):
                self._step()
        except Exception as error:
            self.stop()
            if self.failure is not None and not self.failure.done():
                self.failure.set_exception(error)
        if now:
            self._tell_those_who_wait()

    def _tell_those_who_wait(self) -> None:
        for waiting in self._waiting:
            if not waiting.done():
                waiting.set_result(None)
        self._waiting.clear()
