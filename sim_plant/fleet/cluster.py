"""Jobs on a Dask cluster: one of this machine's own, or one that a scheduler's address names.

Dask gives the work out, again where a worker was lost. Each job runs in a process of its own:
Dask cannot end a task that takes too long, nor one that has left its thread.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING, Generic, Self, TypeVar

from aff_runtime.base.errors import AffError, PlantError
from sim_plant.base.worker_pool import LostJobError
from sim_plant.fleet.job_process import DONE, RAISED, in_own_process, orders

if TYPE_CHECKING:
    from distributed import Client, Future

Job = TypeVar("Job")
Result = TypeVar("Result")
REPEATS = 2
"""Of a job whose process or worker was lost."""
ANSWER_S = 10.0
"""For the scheduler to be reached."""
SOON_S, FIRST_WORKER_S = 2.0, 120.0
"""For a first worker: without a word, and then said. Begun with the scheduler, on a machine with
other work, it may still be loading."""
QUIET = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "5s",
    "distributed.admin.system-monitor.disk": False,
    "distributed.worker.memory.monitor-interval": "5s",
}
"""Of a cluster made here: Dask looks at itself fifty times a second, for pages that nobody opens,
and takes a seventh of a core from the work."""


class ClusterError(AffError):
    """The cluster cannot be used; what is done stays done."""


@dataclass(slots=True)
class _Task(Generic[Job]):
    number: int
    job: Job
    losses: int = 0


class Cluster(Generic[Job, Result]):
    """Runs one function on many jobs on a Dask cluster; use as a context manager.

    Parameters
    ----------
    work : function of one job, found by import on the workers.
    workers : processes of the cluster made here, where no scheduler is given.
    scheduler : ``tcp://HOST:PORT`` or ``tls://HOST:PORT`` of one that runs.
    limit_s : for one job; then it is ended, and repeated.
    name : what an error calls a job.
    tell : takes a sentence whenever a job is repeated, or a first worker is awaited.

    Raises
    ------
    ClusterError
        When Dask is not installed, or no scheduler or worker answers.
    """

    def __init__(
        self,
        work: Callable[[Job], Result],
        workers: int,
        *,
        limit_s: float,
        scheduler: str = "",
        name: Callable[[Job], str] = str,
        tell: Callable[[str], None] = lambda _: None,
    ) -> None:
        self._work, self._limit_s = work, limit_s
        self._name, self._tell = name, tell
        self._client = _connected(scheduler, tell) if scheduler else _local(workers)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        own = self._client.cluster
        self._client.close()
        if own is not None:
            own.close()

    def run(self, jobs: Iterable[Job]) -> Iterator[tuple[int, Result | LostJobError]]:
        """Yield (number of the job, result) as they come, a lost job with its error.

        The next job is taken from ``jobs`` only when a worker is free for it.

        Raises
        ------
        ClusterError
            When the scheduler is lost.
        Exception
            What the function raised.
        """
        from distributed import wait  # noqa: PLC0415 (an extra)

        fresh = (_Task(number, job) for number, job in enumerate(jobs))
        again: list[_Task[Job]] = []
        busy: dict[Future, _Task[Job]] = {}
        try:
            while True:
                while len(busy) < max(1, sum(self._client.nthreads().values())):
                    task = again.pop() if again else next(fresh, None)
                    if task is None:
                        break
                    busy[self._given_out(task)] = task
                if not busy:
                    return
                try:
                    done = wait(list(busy), return_when="FIRST_COMPLETED").done
                except (OSError, RuntimeError) as error:
                    raise _scheduler_lost(error) from error
                for future in done:
                    task = busy.pop(future)
                    result = self._taken_back(future, task)
                    if result is None:
                        again.append(task)
                    else:
                        yield task.number, result[0]
        finally:
            for future in busy:
                future.cancel()

    def _given_out(self, task: _Task[Job]) -> Future:
        told = orders(self._work, task.job)
        return self._client.submit(in_own_process, told, self._limit_s, pure=False, retries=0)

    def _taken_back(self, future: Future, task: _Task[Job]) -> tuple[Result | LostJobError] | None:
        """Return what came of a task, in a tuple; None: it is to be done again."""
        from distributed import KilledWorker  # noqa: PLC0415 (an extra)

        if future.status == "finished":
            kind, value = future.result()
            if kind == DONE:
                return (value,)
            if kind == RAISED:
                raise value
            task.losses += 1
            if task.losses <= REPEATS:
                self._tell(f"{self._name(task.job)}: its process {value}; it is done again")
                return None
            return (self._lost(task, f"its last process {value}"),)
        if future.status != "error":  # cancelled or lost: nobody has it any more
            raise _scheduler_lost(future.status)
        error = future.exception()
        if not isinstance(error, KilledWorker):
            raise error
        return (self._lost(task, "it lost worker after worker"),)

    def _lost(self, task: _Task[Job], why: str) -> LostJobError:
        return LostJobError(
            f"{self._name(task.job)}: every try was lost, {why}; it has no result. Run it by "
            "itself to see what is wrong with it"
        )


def _local(workers: int) -> Client:
    """Return a client of a cluster on this machine's loopback, its web pages too."""
    distributed = _dask()
    importlib.import_module("dask").config.set(QUIET)
    cluster = distributed.LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        host="127.0.0.1",
        dashboard_address="127.0.0.1:0",
        worker_dashboard_address="127.0.0.1:0",
        memory_limit=0,  # the work is in processes of its own
    )
    return distributed.Client(cluster)


def _connected(scheduler: str, tell: Callable[[str], None]) -> Client:
    """Return a client of a scheduler that has at least one worker; where it waits it says so."""
    distributed = _dask()
    try:
        client = distributed.Client(scheduler, timeout=ANSWER_S)
    except (OSError, ValueError) as error:
        raise ClusterError(
            f"no scheduler answers at {scheduler} ({error}); start one with `dask scheduler`"
        ) from error
    try:
        if not _has_worker(client, SOON_S):
            tell(
                f"the scheduler at {scheduler} has no worker yet; a first one is awaited for "
                f"{FIRST_WORKER_S:g} s. Start one with `dask worker {scheduler}`"
            )
            if not _has_worker(client, FIRST_WORKER_S):
                raise ClusterError(
                    f"the scheduler at {scheduler} has no worker after "
                    f"{FIRST_WORKER_S:g} s; start one with `dask worker {scheduler}`"
                )
    except BaseException:
        client.close()
        raise
    return client


def _has_worker(client: Client, limit_s: float) -> bool:
    """Return whether a worker is there within a time."""
    distributed = _dask()
    try:
        client.wait_for_workers(1, timeout=limit_s)
    except (TimeoutError, distributed.TimeoutError):
        return False
    return True


def _dask() -> ModuleType:
    try:
        return importlib.import_module("distributed")
    except ImportError as error:
        raise PlantError(
            "a cluster needs Dask: pip install 'aff-runtime[cluster]', or give no --scheduler"
        ) from error


def _scheduler_lost(why: object) -> ClusterError:
    return ClusterError(
        f"the scheduler was lost ({why}); what is done is kept, and the same command goes on"
    )
