"""Run many simulations of the twins on all cores, each only once."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from types import TracebackType

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.refine.model.twin import Case, Twin

_twins: list[Twin] = []


def _adopt(twins: Sequence[Twin]) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to answer
    threading.Thread(target=_end_with_parent, daemon=True).start()
    _twins[:] = twins


def _end_with_parent() -> None:
    """End this worker when its parent is gone, killed too: nobody else would end it."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _work(job: tuple[int, Case]) -> Array:
    return attempt(_twins[job[0]], job[1])


def attempt(twin: Twin, case: Case) -> Array:
    """Return the channels of a case, all NaN when these numbers make no line that runs."""
    try:
        return twin.simulate(case)
    except PlantError:
        return np.full((len(twin.channels), twin.speed_m_s.size), np.nan)


class SimulationPool:
    """Simulates cases on every twin, remembers results, uses ``workers`` processes.

    Use as a context manager; one worker runs in this process.
    """

    def __init__(self, twins: Sequence[Twin], workers: int = 2) -> None:
        self.twins = list(twins)
        self.simulations = 0
        self._known: dict[tuple[int, Case], Array] = {}
        self._pool: ProcessPoolExecutor | None = None
        if workers > 1:
            self._pool = ProcessPoolExecutor(
                workers, multiprocessing.get_context("spawn"), _adopt, (self.twins,)
            )

    def __enter__(self) -> SimulationPool:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)

    def run(self, cases: Sequence[Case], keep: bool = True) -> list[list[Array]]:
        """Return, per case, one (channels, samples) array per twin."""
        jobs = [(t, case) for case in cases for t in range(len(self.twins))]
        fresh = [job for job in dict.fromkeys(jobs) if job not in self._known]
        self.simulations += len(fresh)
        if self._pool is not None:
            done = list(self._pool.map(_work, fresh, chunksize=2))
        else:
            done = [attempt(self.twins[t], case) for t, case in fresh]
        found = {**self._known, **dict(zip(fresh, done, strict=True))}
        if keep:
            self._known = found
        return [[found[t, case] for t in range(len(self.twins))] for case in cases]

    def forget(self) -> None:
        """Drop all results: a search that goes on from elsewhere does not come back to them."""
        self._known.clear()

    def one(self, case: Case) -> list[Array]:
        """Return one case, per twin."""
        return self.run([case])[0]
