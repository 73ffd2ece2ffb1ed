"""Run many simulations of the twins on all cores, each only once."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.base.worker_pool import WorkerPool
from sim_plant.refine.model.twin import Case, Twin, seen_by

LIMIT_S = 900.0
"""For one simulation. The longest record that makes sense (an hour) takes 20 s of a core at the
declared drive tick, the first start as long again to compile: twenty times that, for a machine
that has other work."""

_twins: list[Twin] = []


def _adopt(twins: Sequence[Twin]) -> None:
    _twins[:] = twins


def _work(job: tuple[int, Case]) -> Array:
    return attempt(_twins[job[0]], seen_by(job[1], job[0]))


def _name(job: tuple[int, Case]) -> str:
    case = job[1]
    put = [f"{added.effect} at {added.location}" for added in case.effects]
    put += [f"order {order} of body {body}" for body, order, _, _ in case.ripples]
    put += [f"{name} shifted" for name, _ in case.shifts]
    put += [] if case.seed is None else [f"noise {case.seed}"]
    return f"simulation of record {job[0] + 1} with {', '.join(put) or 'nothing added'}"


def attempt(twin: Twin, case: Case) -> Array:
    """Return the channels of a case, all NaN when these numbers make no line that runs."""
    try:
        return twin.simulate(case)
    except PlantError:
        return np.full((len(twin.channels), twin.speed_m_s.size), np.nan)


class SimulationPool:
    """Simulates cases on every twin, remembers results, uses ``workers`` processes.

    ``responses`` is a shelf for what a search has learned of the line and needs again: what
    effects change, by whatever names them, (channels, samples) per case and record.
    Use as a context manager; one worker runs in this process. ``say`` reports a simulation
    that is repeated because its process was lost.
    """

    def __init__(
        self,
        twins: Sequence[Twin],
        workers: int = 2,
        say: Callable[[str], None] = lambda _: None,
        limit_s: float = LIMIT_S,
    ) -> None:
        self.twins = list(twins)
        self.simulations = 0
        self.responses: dict[Hashable, list[list[Array]]] = {}
        self._known: dict[tuple[int, Case], Array] = {}
        self._pool: WorkerPool[tuple[int, Case], Array] | None = None
        if workers > 1:
            self._pool = WorkerPool(
                _work,
                workers,
                limit_s=limit_s,
                name=_name,
                tell=say,
                begin=_adopt,
                arguments=(self.twins,),
            )

    def __enter__(self) -> SimulationPool:
        return self

    def __exit__(self, *what: object) -> None:
        if self._pool is not None:
            self._pool.__exit__(*what)

    def run(self, cases: Sequence[Case], keep: bool = True) -> list[list[Array]]:
        """Return, per case, one (channels, samples) array per twin.

        Raises
        ------
        LostJobError
            When a simulation has lost every process that was given it.
        """
        jobs = [(t, case) for case in cases for t in range(len(self.twins))]
        fresh = [job for job in dict.fromkeys(jobs) if job not in self._known]
        self.simulations += len(fresh)
        if self._pool is not None:
            done = self._pool.map(fresh)
        else:
            done = [attempt(self.twins[t], seen_by(case, t)) for t, case in fresh]
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
