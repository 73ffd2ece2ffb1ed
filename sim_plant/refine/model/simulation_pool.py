"""Run many simulations of the twins, side by side and in several processes, each only once."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence

from sim_plant.base.arrays import Array
from sim_plant.base.worker_pool import WorkerPool
from sim_plant.lanes.library import widest
from sim_plant.refine.model.cases_in_lanes import in_groups, simulated, takes_lanes
from sim_plant.refine.model.twin import Case, Twin

LIMIT_S = 900.0
"""For one group of simulations. The longest record that makes sense (an hour) takes 20 s of a core
at the declared drive tick, eight of them one by one 160 s, the first start 20 s to compile: five
times that, for a machine that has other work."""

Group = tuple[int, tuple[Case, ...]]
"""Index of a twin, and cases of it that run side by side."""

_twins: list[Twin] = []
"""Of this worker process."""


def _adopt(twins: Sequence[Twin]) -> None:
    _twins[:] = twins


def _work(group: Group) -> list[Array]:
    twin, cases = group
    return simulated(_twins[twin], twin, cases)


def _name(group: Group) -> str:
    """Return what a group is called where it was lost: its first case, and how many are beside."""
    twin, cases = group
    put = [f"{added.effect} at {added.location}" for added in cases[0].effects]
    put += [f"order {order} of body {body}" for body, order, _, _ in cases[0].ripples]
    put += [f"{name} shifted" for name, _ in cases[0].shifts]
    put += [f"another start of {o.of} {o.roller}" for o in cases[0].start]
    put += [] if cases[0].seed is None else [f"noise {cases[0].seed}"]
    beside = f" and {len(cases) - 1} beside it" if len(cases) > 1 else ""
    return f"simulation of record {twin + 1} with {', '.join(put) or 'nothing added'}{beside}"


class SimulationPool:
    """Simulates cases on every twin, remembers results, uses ``workers`` processes.

    Use as a context manager; one worker runs in this process.

    Attributes
    ----------
    simulations : how many were run so far, of one case on one twin each.
    responses : what a search has simulated of the line and needs again: what effects change, by
        whatever names them, (channels, samples) per case and record.

    Parameters
    ----------
    say : told of a simulation that is repeated because its process was lost.
    limit_s : for one group of simulations; see ``LIMIT_S``.
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
        self._width = widest() if twins and all(map(takes_lanes, twins)) else 1
        named = self.twins[0].declaration.rollers if self._width > 1 else ()
        self._rollers = [roller.name for roller in named]
        self.responses: dict[Hashable, list[list[Array]]] = {}
        self._known: dict[tuple[int, Case], Array] = {}
        self._pool: WorkerPool[Group, list[Array]] | None = None
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

        Parameters
        ----------
        keep : remember the results; without it only what was known before is not run again.

        Raises
        ------
        LostJobError
            When a simulation has lost every process that was given it.
        """
        jobs = [(t, case) for case in cases for t in range(len(self.twins))]
        fresh = [job for job in dict.fromkeys(jobs) if job not in self._known]
        self.simulations += len(fresh)
        groups = in_groups(fresh, self._width, self._rollers)
        if self._pool is not None:
            done = self._pool.map(groups)
        else:
            done = [simulated(self.twins[twin], twin, members) for twin, members in groups]
        known = dict(self._known)
        for (twin, members), records in zip(groups, done, strict=True):
            known.update(zip([(twin, case) for case in members], records, strict=True))
        if keep:
            self._known = known
        return [[known[t, case] for t in range(len(self.twins))] for case in cases]

    def forget(self) -> None:
        """Drop the results of ``run``: a search that goes on from elsewhere needs none of them.

        ``responses`` stay.
        """
        self._known.clear()

    def one(self, case: Case) -> list[Array]:
        """Return one case, per twin."""
        return self.run([case])[0]
