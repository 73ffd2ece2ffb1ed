"""Start angles of effects on a record: a state of the rolls, not of the line.

Of a pool only the first twin counts here: one record at a time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.base.signatures import Frequency, Orders
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.declaration import EffectEntry
from sim_plant.refine.fit.roll_synchronisation import shifts_in_step
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
MOST_PASSES = 6
"""Passes over pairs of bodies, and steps of all bodies together; each ends when nothing is won."""
STEP_RAD = 0.005
"""Angle over which a slope is taken: at order 12 a thirtieth of what changes its sign."""
MOST_RAD = 0.1
"""Longest step of all bodies together, some 6 deg: slopes hold no further at order 12."""


def at_start_angles(twin: Twin, measured: Array) -> tuple[Twin, dict[str, float]]:
    """Return the twin with its declared effects as they stood when the record began.

    A declaration's angles are those of the record it was made from; on every other one the rolls
    begin elsewhere. They are sought with wound rolls in step with recorded angles, as the fit has
    them. Also returned: by how much they are turned, rad, per location; none, and the twin as it
    was, where nothing declared has an angle or the line does not run with it.

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
    # out of step a roll is turned by half of what it loses: its angle would be that of the middle
    case = replace(case, shifts=shifts_in_step(pool, measured, case, model.first))
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


def turns_with(effect: Added) -> str:
    """Return what an effect's angle belongs to, by name: a body, or the effect alone.

    What repeats in time, what turns along at a ratio of its own (its orders change with the
    body's radius) and what has not come round after a turn (an order behind a gear) have an angle
    of their own, wherever they are.
    """
    shows = BY_NAME[effect.effect].shows
    values = {**BY_NAME[effect.effect].parameters, **dict(effect.parameters)}
    own = isinstance(shows, Frequency)
    if isinstance(shows, Orders):
        orders = shows.at(values, 1.0)
        own = orders != shows.at(values, 2.0) or any(order % 1.0 for order in orders)
    return f"{effect.effect} at {effect.location}" if own else effect.location


def with_turned(effects: tuple[Added, ...], body: str, angle_rad: float) -> tuple[Added, ...]:
    """Return the effects, those with an angle that ``turns_with`` this body turned."""
    return tuple(
        turned_effect(e, angle_rad) if phased(e) and turns_with(e) == body else e for e in effects
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
    costs = np.array(
        [
            float(np.sum(_white(pool, model, measured - run[0]) ** 2))
            for run in pool.run(cases, keep=False)
        ]
    )
    costs[np.isnan(costs)] = np.inf  # a line that does not run with this
    return costs


def _white(pool: SimulationPool, model: NoiseModel, residual: Array) -> Array:
    """Return a residual (channels, samples) whitened, without means; see ``costs_of``."""
    zero = np.array([name.endswith("_angle_rad") for name in pool.twins[0].channels])
    residual[zero] -= residual[zero, model.first :].mean(axis=1, keepdims=True)
    white = model.whiten(residual)
    white -= white.mean(axis=1, keepdims=True)
    return white


def start_angles(
    pool: SimulationPool, measured: Array, case: Case, model: NoiseModel
) -> tuple[tuple[Added, ...], dict[str, float]]:
    """Return the effects at this record's start angles, and the angles, rad by ``turns_with``.

    A grid round the turn, all bodies together; then narrower ones about the best, one body after
    the other; in the end all together once more. Angles lie within +-pi and count from those in
    ``case``.

    Parameters
    ----------
    pool, measured, model : as for ``costs_of``.
    case : the effects, and what else is on the line, as simulated.
    """
    bodies = list(dict.fromkeys(turns_with(e) for e in case.effects if phased(e)))
    if not bodies:
        return case.effects, {}
    angles = _on_grid(pool, measured, case, model, bodies)
    width = 2.0 * math.pi / COARSE_ANGLES
    for _ in range(ZOOMS):
        for k, body in enumerate(bodies):
            grid = angles[k] + width * np.array(ZOOM_PARTS)
            here = _turned(case, bodies, angles)
            costs = costs_of(
                pool,
                measured,
                model,
                [_turned(here, [body], [float(a) - angles[k]]) for a in grid],
            )
            angles[k] = _lowest(grid, costs)
        width *= NARROWING
    if len(bodies) > 1:
        angles = _together(pool, measured, case, model, bodies, angles)
    found = _turned(case, bodies, angles)
    within = [math.remainder(angle, 2.0 * math.pi) for angle in angles]
    return found.effects, dict(zip(bodies, within, strict=True))


def _turned(case: Case, bodies: Sequence[str], angles: Sequence[float]) -> Case:
    """Return the case with every body turned by its angle, rad."""
    for body, angle in zip(bodies, angles, strict=True):
        case = replace(case, effects=with_turned(case.effects, body, angle))
    return case


def _on_grid(
    pool: SimulationPool, measured: Array, case: Case, model: NoiseModel, bodies: Sequence[str]
) -> list[float]:
    """Return the angles, rad, of a grid round the turn at which all bodies together cost least.

    Their responses are added up: each is simulated alone, at every angle of the grid.
    """
    grid = np.arange(COARSE_ANGLES) * (2.0 * math.pi / COARSE_ANGLES)
    still = tuple(e for e in case.effects if not phased(e))
    tries = [replace(case, effects=still)]
    for body in bodies:
        own = tuple(e for e in case.effects if phased(e) and turns_with(e) == body)
        tries += [replace(case, effects=(*still, *with_turned(own, body, float(a)))) for a in grid]
    base, *runs = (run[0] for run in pool.run(tries, keep=False))
    rows = np.stack([_white(pool, model, run - base).ravel() for run in runs])
    runs_through = np.isfinite(rows).all(axis=1)
    rows[~runs_through] = 0.0
    alone = np.where(runs_through, 0.0, np.inf)
    alone -= 2.0 * rows @ _white(pool, model, measured - base).ravel()
    shape = (len(bodies), COARSE_ANGLES)
    found = _least_together(alone.reshape(shape), (rows @ rows.T).reshape(shape * 2))
    return [float(grid[k]) for k in found]


def _least_together(alone: Array, products: Array) -> list[int]:
    """Return per body the try of least cost together.

    Equation: sum_i alone[i, a_i] + sum_ij products[i, a_i, j, a_j], two bodies at a time over all
    their tries, until that changes none.

    Parameters
    ----------
    alone : (bodies, tries), infinite for one that does not run.
    products : of responses (bodies, tries, bodies, tries).
    """
    count = len(alone)
    own = alone + np.einsum("iaia->ia", products)
    found = [int(k) for k in np.argmin(own, axis=1)]
    pairs = [(i, j) for i in range(count) for j in range(i)]
    for _ in range(MOST_PASSES):
        before = list(found)
        for i, j in pairs:
            beside = [k for k in range(count) if k not in (i, j)]
            cost_i, cost_j = (
                own[m] + 2.0 * sum(products[m, :, k, found[k]] for k in beside) for m in (i, j)
            )
            both = cost_i[:, None] + cost_j[None, :] + 2.0 * products[i, :, j, :]
            found[i], found[j] = (int(k) for k in divmod(int(np.argmin(both)), both.shape[1]))
        if found == before:
            break
    return found


def _together(
    pool: SimulationPool,
    measured: Array,
    case: Case,
    model: NoiseModel,
    bodies: Sequence[str],
    angles: list[float],
) -> list[float]:
    """Return the angles after steps of all together, each as long as the cost falls.

    Bodies that act nearly alike lie in a narrow valley: steps of one alone end on its wall.
    """
    before, cost = angles, math.inf
    for _ in range(MOST_PASSES):
        moved = [
            [a + STEP_RAD * (k == m) for m, a in enumerate(angles)] for k in range(len(bodies))
        ]
        tries = [_turned(case, bodies, each) for each in (angles, *moved)]
        base, *runs = (run[0] for run in pool.run(tries, keep=False))
        left = _white(pool, model, measured - base).ravel()
        now = float(left @ left)
        if not now < cost:
            return before
        before, cost = angles, now
        slopes = np.stack([_white(pool, model, run - base).ravel() for run in runs]) / STEP_RAD
        if not np.isfinite(slopes).all():
            return angles
        step = np.linalg.lstsq(slopes.T, left, rcond=None)[0]
        steps = np.clip(step, -MOST_RAD, MOST_RAD)
        angles = [float(a) for a in np.array(angles) + steps]
    return before


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
