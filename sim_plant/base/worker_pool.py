"""Worker processes that may be killed: a job whose worker is lost is done again.

Every worker has a pipe of its own and one job at a time. One that ends therefore costs one job,
names it, and leaves the others at work. concurrent.futures shares one queue between its workers:
it gives up all jobs when one worker is killed, and waits for ever when that one was just handing
over a result (seen with Python 3.11).
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import pickle
import signal
import threading
import traceback
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from multiprocessing import connection
from typing import Any, Generic, Self, TypeVar

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import AffError
from sim_plant.base.worker_context import spawn_context
from sim_plant.base.worker_pipe import WorkerPipe, wait

Job = TypeVar("Job")
Result = TypeVar("Result")
READY = b"ready"

REPEATS = 2
"""A job that has lost this many workers gets a last try, with no other job beside it."""
START_S = 300.0
"""How long a new worker may take to be ready for its first job, on a busy machine too."""
GOODBYE_S = 5.0
"""How long a worker without a job may take to end itself."""


class LostJobError(AffError):
    """Every try of a job lost its worker process; the message names the job."""


@dataclass(slots=True)
class _Task(Generic[Job]):
    """A job on its way; ``number`` is its place among the jobs given."""

    number: int
    job: Job
    losses: int = 0


class WorkerPool(Generic[Job, Result]):
    """Runs one function on many jobs in ``workers`` processes; use as a context manager.

    Parameters
    ----------
    work : function of one job, found by import in the worker (not one of a ``__main__.py``, which
        no worker imports); so is ``begin``.
    limit_s : a job without an answer after this time has its worker ended, and is repeated; the
        start of a worker does not count.
    name : what an error calls a job.
    tell : takes a sentence whenever a job is repeated.
    begin, arguments : called once in every new worker, before its first job.
    """

    def __init__(
        self,
        work: Callable[[Job], Result],
        workers: int,
        *,
        limit_s: float,
        name: Callable[[Job], str] = str,
        tell: Callable[[str], None] = lambda _: None,
        begin: Callable[..., None] | None = None,
        arguments: tuple[Any, ...] = (),
    ) -> None:
        self._orders = pickle.dumps((work, begin, arguments))
        self._most, self._limit_s = workers, limit_s
        self._name, self._tell = name, tell
        self._idle: list[_Worker] = []
        self._busy: dict[_Worker, _Task[Job]] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._busy:
            worker.kill()
        for worker in self._idle:
            worker.dismiss()
        self._busy, self._idle = {}, []

    def map(self, jobs: Iterable[Job]) -> list[Result]:
        """Return the results in the order of the jobs.

        Raises
        ------
        LostJobError
            When all tries of a job have lost their worker.
        Exception
            What the function raised, with its traceback as a note.
        """
        found: dict[int, Result] = {}
        for number, result in self.run(jobs):
            if isinstance(result, LostJobError):
                raise result
            found[number] = result
        return [found[number] for number in sorted(found)]

    def run(self, jobs: Iterable[Job]) -> Iterator[tuple[int, Result | LostJobError]]:
        """Yield (number of the job, result) as they come, a lost job with its error.

        The next job is taken from ``jobs`` only when a worker is free for it.
        """
        fresh = (_Task(number, job) for number, job in enumerate(jobs))
        again: deque[_Task[Job]] = deque()
        try:
            while True:
                self._hand_out(fresh, again)
                if not self._busy:
                    return
                yield from self._take_back(again)
        finally:
            for worker in self._busy:  # the caller wants no more, or a job has failed
                worker.kill()
            self._busy = {}

    def _hand_out(self, fresh: Iterator[_Task[Job]], again: deque[_Task[Job]]) -> None:
        """Give jobs to free workers, those to repeat first; one at its last try is alone.

        Two large jobs beside each other may be what the memory did not hold.
        """
        while len(self._busy) < self._most:
            if any(task.losses == REPEATS for task in self._busy.values()):
                return
            if self._busy and again and again[0].losses == REPEATS:
                return
            task = again.popleft() if again else next(fresh, None)
            if task is None:
                return
            while self._idle and not self._idle[-1].is_alive():
                self._idle.pop().kill()
            worker = self._idle.pop() if self._idle else _Worker(self._orders)
            worker.allow(self._limit_s if worker.is_ready else START_S)
            worker.give(task.job)
            self._busy[worker] = task

    def _take_back(self, again: deque[_Task[Job]]) -> Iterator[tuple[int, Result | LostJobError]]:
        """Wait for an answer, an end or a limit; yield what is ready."""
        wait([w.pipe for w in self._busy], min(worker.left_s() for worker in self._busy))
        for worker in list(self._busy):
            worker.pipe.exchange()  # now: the caller may have taken long over another one
            while (answer := worker.answer()) == READY:  # its first answer may be here as well
                worker.allow(self._limit_s)
            if answer is None and not worker.pipe.has_ended and worker.left_s() > 0.0:
                continue
            task = self._busy.pop(worker)
            if answer is not None:
                self._idle.append(worker)
                yield task.number, _opened(answer)
                continue
            why = worker.how_it_ended() if worker.pipe.has_ended else worker.why_late()
            worker.kill()
            task.losses += 1
            if task.losses > REPEATS:
                yield task.number, self._lost(task, why)
                continue
            self._tell(f"{self._name(task.job)}: its worker process {why}; it is done again")
            again.append(task)

    def _lost(self, task: _Task[Job], why: str) -> LostJobError:
        return LostJobError(
            f"{self._name(task.job)}: {task.losses} worker processes in turn were lost at it, the "
            f"last one {why}; if memory was short (the kernel's log says so) give fewer workers "
            "or less at once, otherwise this job by itself shows what is wrong with it"
        )


class _Worker:
    """One process and the pipe to it."""

    def __init__(self, orders: bytes) -> None:
        self._clock, self._until_ns, self._allowed_s = MonotonicClock(), 0, 0.0
        self.is_ready = False
        near, far = multiprocessing.Pipe()
        self.pipe = WorkerPipe(near)
        self._process = spawn_context().Process(target=_serve, args=(far,), daemon=True)
        self._process.start()
        far.close()  # so that the pipe ends with the process
        # not among its arguments: a start waits for ever on a process that ends while it reads
        self.pipe.send(orders)

    def is_alive(self) -> bool:
        return self._process.is_alive()

    def give(self, job: Any) -> None:
        self.pipe.send(pickle.dumps(job))

    def allow(self, limit_s: float) -> None:
        """Give it this long from now."""
        self._until_ns, self._allowed_s = self._clock.now_ns() + round(1e9 * limit_s), limit_s

    def why_late(self) -> str:
        what = "gave no answer" if self.is_ready else "was not ready for a job"
        return f"{what} within {self._allowed_s:g} s"

    def left_s(self) -> float:
        return max(0.0, 1e-9 * (self._until_ns - self._clock.now_ns()))

    def answer(self) -> bytes | None:
        """Return what it has sent, None while that is not whole."""
        found = self.pipe.message()
        self.is_ready = self.is_ready or found is not None
        return found

    def how_it_ended(self) -> str:
        self._process.join(GOODBYE_S)
        code = self._process.exitcode
        if code is not None and code < 0:
            return f"was ended by signal {-code} ({signal.strsignal(-code)})"
        return f"ended with exit code {code}"

    def dismiss(self) -> None:
        """End it in its own time: it has no job."""
        self.pipe.close()
        self._process.join(GOODBYE_S)
        self.kill()

    def kill(self) -> None:
        self.pipe.close()
        self._process.kill()
        self._process.join()
        self._process.close()


def _serve(pipe: connection.Connection) -> None:
    """Take orders, then answer one job after the other until the pipe ends (a worker's life)."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to answer
    threading.Thread(target=_end_with_parent, daemon=True).start()
    with contextlib.suppress(EOFError, ConnectionError):
        orders = pipe.recv_bytes()
        try:
            work, begin, arguments = pickle.loads(orders)
            if begin is not None:
                begin(*arguments)
        except Exception as error:  # another worker would come no further
            pipe.send_bytes(_failure(error))
            return
        pipe.send_bytes(READY)
        while True:
            job = pipe.recv_bytes()
            try:
                answer = pickle.dumps((work(pickle.loads(job)), None))
            except Exception as error:  # whatever a job raises is its answer
                answer = _failure(error)
            pipe.send_bytes(answer)


def _end_with_parent() -> None:
    """End this worker when its parent is gone, killed too: nobody else would end it."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _failure(error: Exception) -> bytes:
    """Return an error as an answer, with its traceback; one that cannot travel as text."""
    text = "".join(traceback.format_exception(error))
    error.add_note(f"in a worker process:\n{text}")
    try:
        answer = pickle.dumps((None, error))
        pickle.loads(answer)
    except Exception:  # an exception class may do anything at that
        answer = pickle.dumps((None, RuntimeError(text)))
    return answer


def _opened(answer: bytes) -> Any:
    result, error = pickle.loads(answer)
    if error is not None:
        raise error
    return result
