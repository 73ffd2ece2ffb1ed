"""The line simulated at one `Case`, and what declared numbers and free shapes change there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.start_states import Changes, changes_by_starts
from sim_plant.refine.model.nuisances import Nuisance
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Case

FIT = CRITERIA.fit


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Linearisation:
    """Simulations at a linearisation point, and what single numbers change of them.

    Attributes
    ----------
    point : the simulation from which differences are taken, at the quick drive tick.
    quick_tick, declared_tick : its runs at the quick and at the declared drive tick, per record.
    nuisance_changes : per declared number, the change of the channels per unit of its shift.
    free_bodies : bodies whose shape is free in its low orders.
    shape_changes : per free body, order and component (cos, sin), the change by a typical ripple.
    wander_changes : slow changes of effects whose size is not quite constant.
    wander_sd : standard deviation of each in multiples of its change; none where sizes are free.
    start_changes : per start offset (`start_offsets`), the change by the largest that may be
        (``start_tension_share``); none where the line rested before every record.
    """

    point: Case
    quick_tick: Changes
    declared_tick: Changes
    nuisance_changes: tuple[Changes, ...]
    free_bodies: tuple[int, ...] = ()
    shape_changes: tuple[Changes, ...] = ()
    wander_changes: tuple[Changes, ...] = ()
    wander_sd: tuple[float, ...] = ()
    start_changes: tuple[Changes, ...] = ()


def linearised_at(
    pool: SimulationPool,
    nuisances: Sequence[Nuisance],
    case: Case,
    *,
    nuisance_changes: tuple[Changes, ...] | None = None,
    free_bodies: Sequence[int] = (),
    start_changes: tuple[Changes, ...] | None = None,
) -> Linearisation:
    """Simulate the line at ``case``, and what declared numbers, shapes and starts change there.

    ``nuisance_changes`` and ``start_changes`` are taken over as they are when given.

    Raises
    ------
    PlantError
        When the line does not run at the end of a tolerance.
    """
    point = replace(case, quick=True)
    quick, declared = (tuple(run) for run in pool.run([point, replace(case, quick=False)]))
    if nuisance_changes is None:
        nuisance_changes = changes_by_nuisances(pool, nuisances, point, quick)
    if start_changes is None:
        start_changes = changes_by_starts(pool, point, quick)
    bodies = tuple(sorted(set(free_bodies)))
    return Linearisation(
        point=point,
        quick_tick=quick,
        declared_tick=declared,
        nuisance_changes=nuisance_changes,
        free_bodies=bodies,
        shape_changes=changes_by_shapes(pool, bodies, point, quick),
        start_changes=start_changes,
    )


def with_free_bodies(
    pool: SimulationPool, linearisation: Linearisation, bodies: Sequence[int]
) -> Linearisation:
    """Return the linearisation with the shapes of ``bodies`` free, of no others."""
    free = tuple(sorted(set(bodies)))
    changes = changes_by_shapes(pool, free, linearisation.point, linearisation.quick_tick)
    return replace(linearisation, free_bodies=free, shape_changes=changes)


def changes_by_nuisances(
    pool: SimulationPool, nuisances: Sequence[Nuisance], point: Case, quick_tick: Changes
) -> tuple[Changes, ...]:
    """Simulate what a unit of every declared number changes, from a shift by its tolerance.

    Raises
    ------
    PlantError
        When the line does not run at the end of a tolerance.
    """
    shifts = dict(point.shifts)
    cases = [
        replace(
            point,
            shifts=tuple(
                sorted({**shifts, n.name: shifts.get(n.name, 0.0) + n.tolerance}.items())
            ),
        )
        for n in nuisances
    ]
    runs = pool.run(cases)
    for n, run in zip(nuisances, runs, strict=True):
        if not all(np.isfinite(y).all() for y in run):
            if not all(np.isfinite(y).all() for y in quick_tick):
                raise PlantError("the line does not run with the numbers that the fit came to")
            raise PlantError(
                f"tolerances: {n.name} may be {n.tolerance:g} off, and there the line does "
                "not run; a tolerance is two standard deviations, mostly a share of the "
                f"number (0.02 is 2 %): give {n.name} a smaller one"
            )
    return tuple(
        tuple((y - b) / n.tolerance for y, b in zip(run, quick_tick, strict=True))
        for n, run in zip(nuisances, runs, strict=True)
    )


def changes_by_shapes(
    pool: SimulationPool, bodies: Sequence[int], point: Case, quick_tick: Changes
) -> tuple[Changes, ...]:
    """Simulate what one typical ripple of each order of each body does, cos and sin."""
    cases = [
        replace(point, ripples=((body, n, FIT.ripple_m * c / n, FIT.ripple_m * s / n),))
        for body in bodies
        for n in range(1, FIT.free_orders + 1)
        for c, s in ((1.0, 0.0), (0.0, 1.0))
    ]
    return tuple(
        tuple(y - b for y, b in zip(run, quick_tick, strict=True)) for run in pool.run(cases)
    )
