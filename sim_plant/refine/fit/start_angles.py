"""Start angles of effects on a record: a state of the rolls, not of the line.

Of a pool only the first twin counts here: one record at a time.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.declared.declaration import EffectEntry
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.roll_synchronisation import shifts_in_step
from sim_plant.refine.fit.turning import Turning, has_start_angle, turns_with, with_turned
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Added, Case, Twin
from sim_plant.refine.noise.innovations import NoiseModel, declared_noise

ANGLES = CRITERIA.fit.start_angles
AT_ONCE = 24
"""Tries of the first grid that are held at a time: each is as large as the record."""


def with_effects_as_the_record_begins(
    twin: Twin, measured: Array
) -> tuple[Twin, dict[str, float]]:
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
    stated = tuple(_added(e) for e in entries if has_start_angle(_added(e)))
    if not stated:
        return twin, {}
    others = tuple(e for e in entries if not has_start_angle(_added(e)))
    bare = _with_effects(twin, others)
    pool = SimulationPool([bare], workers=1)
    case = Case(effects=stated)
    runs = pool.run([replace(case, quick=False), replace(case, quick=False, seed=0)])
    if not all(np.isfinite(run[0]).all() for run in runs):
        return twin, {}
    model = declared_noise(bare, (runs[1][0] - runs[0][0])[None])
    # a roll out of step with its recorded angle drifts off over the record: the angle found would
    # fit the middle, and be off at the start by half the drift
    case = replace(case, shifts=shifts_in_step(pool, measured, case, model.first))
    effects, angles = find_start_angles(pool, measured, case, model)
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
    is_angle = np.array([name.endswith("_angle_rad") for name in pool.twins[0].channels])
    means = residual[:, model.first :].mean(axis=1, keepdims=True)
    white = model.whiten(np.where(is_angle[:, None], residual - means, residual))
    white -= white.mean(axis=1, keepdims=True)
    return white


def find_start_angles(
    pool: SimulationPool, measured: Array, case: Case, model: NoiseModel
) -> tuple[tuple[Added, ...], dict[str, float]]:
    """Return the effects at this record's start angles, and the angles, rad by ``turns_with``.

    What turns together is a group (`Turning`): what is on one body, or a hum in time alone. A grid
    round the turn, or the part of one that is a period, all groups together; then narrower ones
    about the best, one group after the other; in the end all at once. Angles lie within +-pi and
    count from those in ``case``.

    Parameters
    ----------
    pool, measured, model : as for ``costs_of``.
    case : the effects, and what else is on the line, as simulated.
    """
    names = list(dict.fromkeys(turns_with(e) for e in case.effects if has_start_angle(e)))
    if not names:
        return case.effects, {}
    groups = [Turning.of(name, case.effects) for name in names]
    angles = _on_grid(pool, measured, case, model, groups)
    share = 1.0
    for _ in range(ANGLES.zooms):
        for k, group in enumerate(groups):
            width = share * group.period_rad / group.angle_count
            grid = angles[k] + width * np.array(ANGLES.zoom_parts)
            here = _turned(case, groups, angles)
            costs = costs_of(
                pool,
                measured,
                model,
                [_turned(here, [group], [float(a) - angles[k]]) for a in grid],
            )
            angles[k] = _vertex(grid, costs)
        share *= ANGLES.narrowing
    if len(groups) > 1:
        angles = _together(pool, measured, case, model, groups, angles)
    found = _turned(case, groups, angles)
    within = [math.remainder(angle, 2.0 * math.pi) for angle in angles]
    return found.effects, dict(zip(names, within, strict=True))


def _turned(case: Case, groups: Sequence[Turning], angles: Sequence[float]) -> Case:
    """Return the case with every group turned by its angle, rad."""
    for group, angle in zip(groups, angles, strict=True):
        case = replace(case, effects=with_turned(case.effects, group.name, angle))
    return case


def _on_grid(
    pool: SimulationPool, measured: Array, case: Case, model: NoiseModel, groups: Sequence[Turning]
) -> list[float]:
    """Return the angles, rad, of a grid round the turn at which all groups together cost least.

    Their responses are added up: each is simulated alone, at every angle of its grid. Of the group
    of most tries only the products with the others are needed, so few of its own are held.
    """
    still = replace(case, effects=tuple(e for e in case.effects if not has_start_angle(e)))
    base = pool.run([still], keep=False)[0][0]
    left = _white(pool, model, measured - base).ravel()
    # groups have unlike counts of tries: what a shorter grid lacks costs without end
    shape = (len(groups), max(group.angle_count for group in groups))
    alone, products = np.full(shape, np.inf), np.zeros(shape * 2)
    kept: dict[int, Array] = {}
    fewest_tries_first = sorted(range(len(groups)), key=lambda k: groups[k].angle_count)
    for k in fewest_tries_first:
        parts: list[Array] = []
        for first, responses in _responses(pool, model, case, base, groups[k]):
            tries = np.arange(first, first + len(responses))
            runs_through = np.isfinite(responses).all(axis=1)
            responses[~runs_through] = 0.0
            alone[k, tries] = np.where(runs_through, 0.0, np.inf) - 2.0 * responses @ left
            products[k, tries, k, tries] = np.sum(responses**2, axis=1)
            for other, of_other in kept.items():
                crossed = responses @ of_other.T
                products[k, tries, other, : len(of_other)] = crossed
                products[other, : len(of_other), k, tries] = crossed
            if k != fewest_tries_first[-1]:  # that of most tries: no other needs its responses
                parts.append(responses)
        if parts:
            kept[k] = np.concatenate(parts)
    found = _least_together(alone, products)
    return [float(group.grid[k]) for group, k in zip(groups, found, strict=True)]


def _responses(
    pool: SimulationPool, model: NoiseModel, case: Case, base: Array, group: Turning
) -> Iterator[tuple[int, Array]]:
    """Yield the index of the first of some tries of a group's grid, and their responses.

    A response is what a try changes from ``base``, white: one row per try, of all channels and
    judged samples.
    """
    still = tuple(e for e in case.effects if not has_start_angle(e))
    own = tuple(e for e in case.effects if has_start_angle(e) and turns_with(e) == group.name)
    for first in range(0, group.angle_count, AT_ONCE):
        angles = group.grid[first : first + AT_ONCE]
        turned = [with_turned(own, group.name, float(a)) for a in angles]
        cases = [replace(case, effects=(*still, *effects)) for effects in turned]
        runs = (run[0] for run in pool.run(cases, keep=False))
        yield first, np.stack([_white(pool, model, run - base).ravel() for run in runs])


def _least_together(alone: Array, products: Array) -> list[int]:
    """Return per group the try of least cost together.

    Equation: sum_i alone[i, a_i] + sum_ij products[i, a_i, j, a_j], two groups at a time over all
    their tries, until that changes none, or ``most_passes`` times.

    Parameters
    ----------
    alone : (groups, tries), infinite for one that does not run.
    products : of responses (groups, tries, groups, tries); of one group those with themselves.
    """
    count = len(alone)
    own = alone + np.einsum("iaia->ia", products)
    found = [int(k) for k in np.argmin(own, axis=1)]
    pairs = [(i, j) for i in range(count) for j in range(i)]
    for _ in range(ANGLES.most_passes):
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
    groups: Sequence[Turning],
    angles: list[float],
) -> list[float]:
    """Return the angles after steps of all at once, as many as let the cost fall.

    Groups that act nearly alike lie in a narrow valley: steps of one alone end on its wall. At
    most ``most_passes`` steps.
    """
    best, cost = angles, math.inf
    shares = np.array([group.step_share for group in groups])
    steps_rad = ANGLES.slope_rad * shares
    for _ in range(ANGLES.most_passes):
        moved = [list(np.array(angles) + row) for row in np.diag(steps_rad)]
        tries = [_turned(case, groups, each) for each in (angles, *moved)]
        base, *runs = (run[0] for run in pool.run(tries, keep=False))
        left = _white(pool, model, measured - base).ravel()
        now = float(left @ left)
        if not now < cost:
            return best
        best, cost = angles, now
        rows = np.stack([_white(pool, model, run - base).ravel() for run in runs])
        slopes = rows / steps_rad[:, None]
        if not np.isfinite(slopes).all():
            return angles
        step = np.linalg.lstsq(slopes.T, left, rcond=None)[0]
        steps = np.clip(step, -ANGLES.most_rad * shares, ANGLES.most_rad * shares)
        angles = [float(a) for a in np.array(angles) + steps]
    return best


def _vertex(grid: Array, values: Array) -> float:
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
