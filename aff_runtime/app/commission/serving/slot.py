"""A place for one job at a time: what runs in it, what ran last, and how both are shown."""

from __future__ import annotations

import asyncio

from aff_runtime.app.commission.link.answers import Answer, Done
from aff_runtime.app.commission.link.messages import Refusal
from aff_runtime.app.commission.serving.worker import Worker
from aff_runtime.app.commission.views.of_line import JobView, LastJob
from aff_runtime.base.ports import Clock


class Slot:
    """Holds one job.

    Attributes
    ----------
    worker : what runs; None while nothing does. ``running`` : the task that waits for it.
    last : what ended last.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._began_ns = 0
        self.worker: Worker | None = None
        self.running: asyncio.Task[Answer] | None = None
        self.last: LastJob | None = None

    def hold(self, worker: Worker) -> None:
        """Take a job that begins now."""
        self.worker, self._began_ns = worker, self._clock.now_ns()

    def ended(self, worker: Worker, answer: Answer) -> tuple[bool, str]:
        """Take note of what became of a job; return whether it is done, and what it said."""
        is_done, text = _became(answer)
        asked = worker.asked
        self.last = LastJob(do=asked.do, step=asked.step, ok=is_done, text=text)
        return is_done, text

    def shown(self) -> JobView | None:
        """Return what runs, for a screen."""
        if self.worker is None:
            return None
        asked = self.worker.asked
        return JobView(
            do=asked.do,
            step=asked.step,
            said=tuple(self.worker.said),
            ask=self.worker.question,
            seconds=(self._clock.now_ns() - self._began_ns) * 1e-9,
        )

    def stop(self) -> None:
        """End what runs."""
        if self.worker is not None:
            self.worker.stop()


def _became(answer: Answer) -> tuple[bool, str]:
    if isinstance(answer, Refusal):
        return False, answer.name
    return True, answer.text if isinstance(answer, Done) else ""
