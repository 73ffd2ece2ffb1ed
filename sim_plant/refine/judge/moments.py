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
from sim_plant.refine.spectra.onset_filter import best_moments, moment_axis, parts_of, resampled

EVENTS = CRITERIA.search.events
FINEST = (-0.02, -0.01, 0.0, 0.01, 0.02)
"""Steps, s or m, of the last grid of moments around the best one."""


def with_moments(
    pool: SimulationPool, measured: Array, case: Case, model: NoiseModel
) -> tuple[tuple[Added, ...], dict[str, float]]:
    """Return the effects with events at this record's moments, and the moments.

    Moments are by "effect at location". An event that this record does not have is left out. One
    that began before the judged part is constant there, and channels' free zeros explain it as
    well: so it also stays where it takes power from the plain residual (``_takes_power``).
    """
    moments: dict[str, float] = {}
    for event in case.effects:
        onset = BY_NAME[event.effect].onset
        if onset is None or not _begins_later(event, onset):
            continue
        others = tuple(e for e in case.effects if e is not event)
        rest = replace(case, effects=others)
        tries = [
            event,
            *_before(pool, event, onset, model),
            *_tries(pool, measured, rest, event, onset, model),
        ]
        best, cost = _best(pool, measured, rest, tries, model)
        for grid in (EVENTS.coarse_grid, EVENTS.fine_grid, FINEST):
            near = [_at(best, onset, _moment(best, onset) + d) for d in grid]
            best, cost = _best(pool, measured, rest, near, model)
        with_event = replace(case, effects=tuple(best if e is event else e for e in case.effects))
        without = float(costs_of(pool, measured, model, [rest])[0])
        if cost < without or _takes_power(pool, measured, model, with_event, rest):
            moments[f"{event.effect} at {event.location}"] = _moment(best, onset)
            case = with_event
        else:
            case = rest
    return case.effects, moments


def has_moments(case: Case) -> bool:
    """Return whether an effect of the case begins at a moment."""
    onsets = ((event, BY_NAME[event.effect].onset) for event in case.effects)
    return any(onset is not None and _begins_later(event, onset) for event, onset in onsets)


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
    return powers[0] < powers[1] - CRITERIA.judge.standing_power


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
    return replace(event, parameters=tuple(values.items()), record=None)


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
) -> tuple[Added, float]:
    """Return which of ``tries``, beside the ``rest``, costs least, and that cost."""
    cases = [replace(rest, effects=(*rest.effects, event)) for event in tries]
    costs = costs_of(pool, measured, model, cases)
    best = int(np.argmin(costs))
    return tries[best], float(costs[best])
