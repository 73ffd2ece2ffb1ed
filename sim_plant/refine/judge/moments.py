"""The moments at which the events that were fitted begin in the record that is judged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.base.signatures import Onset
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.start_angles import costs_of
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Added, Case
from sim_plant.refine.noise.innovations import NoiseModel
from sim_plant.refine.spectra.moment_axis import moment_axis, parts_of, resampled
from sim_plant.refine.spectra.onset_filter import best_moments

EVENTS, JUDGE = CRITERIA.search.events, CRITERIA.judge


def with_moments(
    pool: SimulationPool, measured: Array, case: Case, model: NoiseModel
) -> tuple[tuple[Added, ...], dict[str, float]]:
    """Return the effects with events at this record's moments, and the moments.

    Moments are by "effect at location". An event that this record does not have is left out. One
    that began before the judged part is constant there, and channels' free zeros explain it as
    well: so it also stays where it takes power from the plain residual (``_takes_power``).

    Several events are gone through again until none moves: the first one was sought beside the
    others at the moments of another record.
    """
    at = [k for k, effect in enumerate(case.effects) if _is_event(effect)]
    found = case.effects
    for _ in range(JUDGE.moment_passes if len(at) > 1 else 1):
        before = found
        for k in at:
            found = _replaced(found, k, _at_best(pool, measured, case, found, k, model))
        if found == before:
            break
    moments: dict[str, float] = {}
    absent: list[int] = []
    for k in at:
        with_event = replace(case, effects=_without(found, absent))
        rest = replace(case, effects=_without(found, [*absent, k]))
        cost, without = costs_of(pool, measured, model, [with_event, rest])
        if cost < without or _takes_power(pool, measured, model, with_event, rest):
            event = found[k]
            onset = BY_NAME[event.effect].onset
            assert onset is not None  # _is_event
            moments[f"{event.effect} at {event.location}"] = _moment(event, onset)
        else:
            absent.append(k)
    return _without(found, absent), moments


def _at_best(
    pool: SimulationPool,
    measured: Array,
    case: Case,
    effects: tuple[Added, ...],
    k: int,
    model: NoiseModel,
) -> Added:
    """Return event ``k`` of ``effects`` at the moment of least cost beside the others."""
    event, rest = effects[k], replace(case, effects=_without(effects, [k]))
    onset = BY_NAME[event.effect].onset
    assert onset is not None  # _is_event
    tries = [
        event,
        *_before(pool, event, onset, model),
        *_tries(pool, measured, rest, event, onset, model),
    ]
    best = _best(pool, measured, rest, tries, model)
    for grid in (EVENTS.coarse_grid, EVENTS.fine_grid, JUDGE.finest_grid):
        near = [_at(best, onset, _moment(best, onset) + d) for d in grid]
        best = _best(pool, measured, rest, near, model)
    return best


def _replaced(effects: tuple[Added, ...], k: int, effect: Added) -> tuple[Added, ...]:
    return (*effects[:k], effect, *effects[k + 1 :])


def _without(effects: tuple[Added, ...], absent: Sequence[int]) -> tuple[Added, ...]:
    return tuple(effect for k, effect in enumerate(effects) if k not in absent)


def _is_event(effect: Added) -> bool:
    """Return whether an effect begins at a moment."""
    onset = BY_NAME[effect.effect].onset
    return onset is not None and _begins_later(effect, onset)


def has_moments(case: Case) -> bool:
    """Return whether an effect of the case begins at a moment."""
    return any(_is_event(effect) for effect in case.effects)


def _takes_power(
    pool: SimulationPool, measured: Array, model: NoiseModel, with_event: Case, rest: Case
) -> bool:
    """Return whether the residual's power, over that of noise, is surely less with an event.

    Mean over all channels but angles, steady parts included; ``rest`` is without the event.
    """
    judged = np.array([not name.endswith("_angle_rad") for name in pool.twins[0].channels])
    powers = []
    for run in pool.run([with_event, rest]):
        left = (measured - run[0])[judged, model.first :]
        powers.append(float(np.mean(np.square(left / model.floor[judged, np.newaxis]))))
    return powers[0] < powers[1] - JUDGE.standing_power


def _begins_later(event: Added, onset: Onset) -> bool:
    """Return whether an effect has a moment: at its default it is there from the start."""
    return (
        dict(event.parameters).get(onset.moment, -1.0)
        != BY_NAME[event.effect].accepts[onset.moment].default
    )


def _moment(event: Added, onset: Onset) -> float:
    return float(dict(event.parameters)[onset.moment])


def _at(event: Added, onset: Onset, moment: float) -> Added:
    values = {**dict(event.parameters), onset.moment: max(0.0, moment)}
    return replace(event, parameters=tuple(values.items()), record_index=None)


def _before(pool: SimulationPool, event: Added, onset: Onset, model: NoiseModel) -> list[Added]:
    """Return the event at moments before the judged part of the record."""
    start = float(moment_axis(pool.twins[0], model.first, onset.unit).grid[0])
    step = EVENTS.before_step[onset.unit]
    return [_at(event, onset, float(m)) for m in np.arange(0.0, start, step)]


def _tries(
    pool: SimulationPool,
    measured: Array,
    rest: Case,
    event: Added,
    onset: Onset,
    model: NoiseModel,
) -> list[Added]:
    """Return the event at moments around the peaks of a matched filter."""
    twin = pool.twins[0]
    axis = moment_axis(twin, model.first, onset.unit)
    parts = parts_of(axis)
    cases = [replace(rest, effects=(*rest.effects, _at(event, onset, p.middle))) for p in parts]
    base, *runs = (run[0] for run in pool.run([rest, *cases], keep=False))
    white = resampled(model.whiten(measured - base), axis.moments, axis.grid)
    peaks = [
        peak
        for part, run in zip(parts, runs, strict=True)
        for peak in best_moments(axis, white, model.whiten(run - base), part, onset.unit)
    ]
    peaks.sort(reverse=True)
    near = [m + d for _, m in peaks[: EVENTS.judged_peaks] for d in EVENTS.coarse_grid[::2]]
    return [_at(event, onset, moment) for moment in near]


def _best(
    pool: SimulationPool, measured: Array, rest: Case, tries: Sequence[Added], model: NoiseModel
) -> Added:
    """Return which of ``tries``, beside the ``rest``, costs least."""
    cases = [replace(rest, effects=(*rest.effects, event)) for event in tries]
    return tries[int(np.argmin(costs_of(pool, measured, model, cases)))]
