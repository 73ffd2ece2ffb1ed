"""Start angles of effects on a record: a state of the rolls, not of the line.

Of a pool only the first twin counts here: one record at a time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.declaration import EffectEntry
from sim_plant.refine.model.hypotheses import turned
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Added, Case, Twin
from sim_plant.refine.noise.innovations import NoiseModel, declared_noise

COARSE_ANGLES = 24
"""Tries round a turn, the first grid: every 15 deg, four tries or more in a period of what repeats
up to six times per turn: the best try lies in the valley of the cost that holds the minimum."""
ZOOMS = 3
"""Grids about the best try after the first one: over 15, 4.5 and 1.35 deg."""
ZOOM_PARTS = (-0.5, -0.25, 0.0, 0.25, 0.5)
"""Tries of such a grid, in parts of its width."""
NARROWING = 0.3
"""Width of the next such grid over that of the one before."""


def at_start_angles(twin: Twin, measured: Array) -> tuple[Twin, dict[str, float]]:
    """Return the twin with its declared effects as they stood when the record began.

    A declaration's angles are those of the record it was made from; on every other one the rolls
    begin elsewhere. Also returned: by how much they are turned, rad, per location; none, and the
    twin as it was, where nothing declared has an angle or the line does not run with it.

    Parameters
    ----------
    measured : (channels, samples) in channel units, channels as in ``twin.channels``.

    Raises
    ------
    PlantError
        When the declaration gives a channel no noise at all.
    """
    entries = twin.declaration.effects
    stated = tuple(_added(e) for e in entries if phased(_added(e)))
    if not stated:
        return twin, {}
    others = tuple(e for e in entries if not phased(_added(e)))
    bare = _with_effects(twin, others)
    pool = SimulationPool([bare], workers=1)
    case = Case(effects=stated)
    runs = pool.run([replace(case, quick=False), replace(case, quick=False, seed=0)])
    if not all(np.isfinite(run[0]).all() for run in runs):
        return twin, {}
    model = declared_noise(bare, (runs[1][0] - runs[0][0])[None])
    effects, angles = start_angles(pool, measured, case, model)
    return _with_effects(twin, (*others, *(e.entry() for e in effects))), angles


def _added(entry: EffectEntry) -> Added:
    """Return a declared effect with every angle stated that it may be turned by."""
    effect, values = BY_NAME[entry.effect], dict(entry.parameters)
    amplitude = {pair.angle: pair.amplitude for pair in effect.quadratures if pair.angle}
    for name, row in effect.accepts.items():
        if row.role == "angle" and (name not in amplitude or amplitude[name] in values):
            values.setdefault(name, row.default)
    return Added(entry.effect, entry.location, tuple(values.items()))


def _with_effects(twin: Twin, entries: Sequence[EffectEntry]) -> Twin:
    """Return the twin with these effects declared, and no other."""
    line = twin.declaration.model_copy(update={"effects": tuple(entries)})
    return replace(twin, declaration=line)


def phased(effect: Added) -> bool:
    """Return whether an effect has an angle that another start of the rolls changes."""
    record = BY_NAME[effect.effect]
    return bool(record.quadratures) or any(
        record.accepts[name].role == "angle" for name, _ in effect.parameters
    )


def turned_effect(effect: Added, angle_rad: float) -> Added:
    """Return the effect with its body turned ``angle_rad`` further when the record begins."""
    values = turned(BY_NAME[effect.effect], dict(effect.parameters), angle_rad)
    return replace(effect, parameters=tuple(values.items()))


def with_turned(effects: tuple[Added, ...], location: str, angle_rad: float) -> tuple[Added, ...]:
    """Return the effects, those with an angle at ``location`` turned: one body, one angle."""
    return tuple(
        turned_effect(e, angle_rad) if e.location == location and phased(e) else e for e in effects
    )


def costs_of(
    pool: SimulationPool, measured: Array, model: NoiseModel, cases: Sequence[Case]
) -> Array:
    """Return the squared error of every case against one record (cases,), dimensionless.

    Infinite for a case with which the line does not run.

    Equation: sum over channels and judged samples of (w - mean w)^2, w the whitened residual;
    the mean of each channel is taken away, of an angle its zero before whitening as well.

    Quick runs may be given, though of these only differences count: what is compared is the cost
    of cases that are alike but for a few numbers. What the longer drive tick does to a run is
    nearly the same in all of them; its constant part goes with the mean, and the rest adds nearly
    the same to every cost. So the least one stands where it stood; the size of a cost says
    nothing. A change of level that a case itself makes goes with the mean too.

    Parameters
    ----------
    pool : its first twin is that of the record.
    measured : (channels, samples) in channel units.
    model : the noise of that twin, with the first judged sample.
    """
    zero = np.array([name.endswith("_angle_rad") for name in pool.twins[0].channels])
    found = []
    for run in pool.run(cases, keep=False):
        residual = measured - run[0]
        residual[zero] -= residual[zero, model.first :].mean(axis=1, keepdims=True)
        white = model.whiten(residual)
        white -= white.mean(axis=1, keepdims=True)
        found.append(float(np.sum(white**2)))
    costs = np.array(found)
    costs[np.isnan(costs)] = np.inf  # a line that does not run with this
    return costs


def _turns(case: Case, location: str, tries: Array) -> list[Case]:
    """Return the case with the effects at ``location`` turned by each try."""
    return [replace(case, effects=with_turned(case.effects, location, float(a))) for a in tries]


def start_angles(
    pool: SimulationPool, measured: Array, case: Case, model: NoiseModel
) -> tuple[tuple[Added, ...], dict[str, float]]:
    """Return the effects at this record's start angles, and the angles, rad per location.

    One location after the other, each with those before it already turned: a grid round the turn,
    then narrower ones about the best. Angles lie within +-pi and count from those in ``case``.

    Parameters
    ----------
    pool, measured, model : as for ``costs_of``.
    case : the effects, and what else is on the line, as simulated.
    """
    angles: dict[str, float] = {}
    for location in dict.fromkeys(e.location for e in case.effects if phased(e)):
        width = 2.0 * math.pi / COARSE_ANGLES
        grid: Array = np.arange(COARSE_ANGLES, dtype=np.float64) * width
        costs = costs_of(pool, measured, model, _turns(case, location, grid))
        best = float(grid[int(np.argmin(costs))])
        for _ in range(ZOOMS):
            grid = best + width * np.array(ZOOM_PARTS)
            best = _lowest(grid, costs_of(pool, measured, model, _turns(case, location, grid)))
            width *= NARROWING
        angles[location] = math.remainder(best, 2.0 * math.pi)
        case = replace(case, effects=with_turned(case.effects, location, best))
    return case.effects, angles


def _lowest(grid: Array, values: Array) -> float:
    """Return where the fitted parabola has its vertex, rad, kept inside the grid.

    Of a parabola that opens downwards, and where a line does not run at a try, the try of
    least cost stands in. ``grid`` (tries,) rad, ``values`` (tries,) the costs there.
    """
    if not np.isfinite(values).all():
        return float(grid[int(np.argmin(values))])
    centre = grid[len(grid) // 2]
    fit = np.polyfit(grid - centre, values, 2)
    if fit[0] <= 0.0:
        return float(grid[int(np.argmin(values))])
    return float(np.clip(centre - fit[1] / (2.0 * fit[0]), grid[0], grid[-1]))
