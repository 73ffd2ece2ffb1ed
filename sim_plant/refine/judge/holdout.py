"""Error before and after on a record that took no part in the fit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.optimize import minimize

from sim_plant.base.arrays import Array
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.roll_synchronisation import shifts_in_step
from sim_plant.refine.fit.start_angles import costs_of, find_start_angles
from sim_plant.refine.fit.start_states import changes_by_starts, with_start_state
from sim_plant.refine.fit.turning import has_start_angle, turns_with, with_turned
from sim_plant.refine.judge.frequencies import differs_by_record, frequency_Hz, with_frequencies
from sim_plant.refine.judge.moments import has_moments, with_moments
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Added, Case
from sim_plant.refine.noise.innovations import NoiseModel, declared_noise

JUDGE = CRITERIA.judge

Shifts = tuple[tuple[str, float], ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Evaluation:
    """Residual of one record without and with the effects found.

    Attributes
    ----------
    channels : names.
    rms_declared, rms_amended, floor : rms per channel; ``floor`` is what noise alone leaves.
    measured, declared, amended : (channels, samples): the record, and its simulation without and
        with the effects found.
    corrected : the simulation with declared numbers as re-estimated and no effects.
    effects : those found, with the start angles of this record.
    angles_rad, unwound_m : states of rolls estimated on this record: start angles, by what turns
        (``turns_with``), and per location the age of a profile, by how much the roll's radius has
        fallen since it was formed; all else is as fitted.
    moments : when events begin in this record, s or m of web, by "effect at location".
    frequencies_Hz : those of the mains in this record, by the same.
    first : index of the first judged sample.
    travel_m : length of web that has passed, from the speed reference (samples,).
    """

    channels: tuple[str, ...]
    rms_declared: Array
    rms_amended: Array
    floor: Array
    measured: Array
    declared: Array
    corrected: Array
    amended: Array
    effects: tuple[Added, ...]
    angles_rad: dict[str, float]
    unwound_m: dict[str, float]
    first: int
    travel_m: Array
    moments: Mapping[str, float] = field(default_factory=dict)
    frequencies_Hz: Mapping[str, float] = field(default_factory=dict)


def rms(channels: Sequence[str], residual: Array, first: int) -> Array:
    """Return the rms per channel from sample ``first`` on, of an angle without its mean."""
    part = residual[:, first:].copy()
    for c, name in enumerate(channels):
        if name.endswith("_angle_rad"):
            part[c] -= part[c].mean()
    found: Array = np.sqrt(np.mean(part**2, axis=1))
    return found


def evaluate(
    pool: SimulationPool,
    measured: Array,
    effects: Sequence[Added],
    shifts: Shifts = (),
    *,
    find_angles: bool,
) -> Evaluation:
    """Return before and after on the only record of the pool.

    ``shifts`` are changes of declared numbers as re-estimated with the effects. With
    ``find_angles`` what differs from record to record is found anew: start angles of rolls, ages
    of profiles, moments of events, the frequency of the mains. The start state of a run is found
    anew always.
    """
    twin = pool.twins[0]
    runs = pool.run([Case(quick=False), Case(quick=False, seed=0)])
    declared, noisy = runs[0][0], runs[1][0]
    model = declared_noise(twin, (noisy - declared)[None])
    first = model.first
    found = OwnState(case=Case(effects=tuple(effects), shifts=shifts))
    if find_angles:
        found = at_its_own_state(pool, measured, found.case, model)
    final, shifts = found.case.effects, found.case.shifts
    changed = Case(effects=final, shifts=shifts, quick=False)
    amended = pool.one(changed)[0] if final or shifts else declared
    corrected = pool.one(replace(changed, effects=()))[0] if shifts else declared
    point = replace(changed, quick=True)
    starts = changes_by_starts(pool, point, (pool.one(point)[0],)) if not twin.rested else ()
    declared = with_start_state(twin, declared, measured, starts, model)
    corrected = with_start_state(twin, corrected, measured, starts, model)
    amended = with_start_state(twin, amended, measured, starts, model)
    return Evaluation(
        channels=twin.channels,
        rms_declared=rms(twin.channels, measured - declared, first),
        rms_amended=rms(twin.channels, measured - amended, first),
        floor=model.floor,
        measured=measured,
        declared=declared,
        corrected=corrected,
        amended=amended,
        effects=final,
        angles_rad=found.angles_rad,
        unwound_m=found.unwound_m,
        moments=found.moments,
        frequencies_Hz=found.frequencies_Hz,
        first=first,
        travel_m=np.cumsum(np.abs(twin.speed_m_s)) * twin.declaration.sample_time_s,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnState:
    """The effects of a case as one record has them; the attributes as of ``Evaluation``."""

    case: Case
    angles_rad: dict[str, float] = field(default_factory=dict)
    unwound_m: dict[str, float] = field(default_factory=dict)
    moments: dict[str, float] = field(default_factory=dict)
    frequencies_Hz: dict[str, float] = field(default_factory=dict)


def at_its_own_state(
    pool: SimulationPool, measured: Array, case: Case, model: NoiseModel
) -> OwnState:
    """Return the effects with what differs from record to record found anew.

    A moment is sought beside rolls that stand as in this record: of a roll at another angle more
    is left than of the event. So where there is both, the rolls are turned before that, and once
    more beside the events at their moments. The frequency of the mains is sought beside rolls so
    turned too, and its phase is turned with them. Last, the rolls that are wound are brought into
    step, where that costs less: what another record asks of their radii held its own start radius
    too.
    """
    first = OwnState(case=case)
    sought = has_moments(case) or any(differs_by_record(effect) for effect in case.effects)
    if sought and any(has_start_angle(effect) for effect in case.effects):
        first = _with_rolls(pool, measured, first, model)
    first = _at_mains(pool, measured, first, model)
    effects, moments = with_moments(pool, measured, first.case, model)
    found = replace(first, case=replace(case, effects=effects), moments=moments)
    return _in_step(pool, measured, _with_rolls(pool, measured, found, model), model)


def _at_mains(
    pool: SimulationPool, measured: Array, found: OwnState, model: NoiseModel
) -> OwnState:
    """Return the state with the mains at their frequency in this record, if better."""
    if not any(differs_by_record(effect) for effect in found.case.effects):
        return found
    moved = replace(found.case, effects=with_frequencies(pool, measured, found.case, model))
    there = _with_rolls(pool, measured, replace(found, case=moved), model)
    as_it_was, anew = costs_of(pool, measured, model, [found.case, there.case])
    best = there if anew < as_it_was else found
    known = {
        f"{e.effect} at {e.location}": frequency_Hz(e)
        for e in best.case.effects
        if differs_by_record(e)
    }
    return replace(best, frequencies_Hz=known)


def _in_step(
    pool: SimulationPool, measured: Array, found: OwnState, model: NoiseModel
) -> OwnState:
    """Return the state with its wound rolls in step with recorded angles, if better."""
    shifts = shifts_in_step(pool, measured, found.case, model.first)
    if shifts == found.case.shifts:
        return found
    stepped = replace(found, case=replace(found.case, shifts=shifts))
    stepped = _with_rolls(pool, measured, stepped, model)
    as_it_was, in_step = costs_of(pool, measured, model, [found.case, stepped.case])
    return stepped if in_step < as_it_was else found


def _with_rolls(
    pool: SimulationPool, measured: Array, found: OwnState, model: NoiseModel
) -> OwnState:
    """Return the state with start angles and ages of rolls found anew; angles add up."""
    effects, more = find_start_angles(pool, measured, found.case, model)
    case = replace(found.case, effects=effects)
    effects, ages_m = with_profile_ages(pool, measured, case, model)
    angles = {
        place: math.remainder(angle + found.angles_rad.get(place, 0.0), 2.0 * math.pi)
        for place, angle in more.items()
    }
    return replace(found, case=replace(case, effects=effects), angles_rad=angles, unwound_m=ages_m)


def with_profile_ages(
    pool: SimulationPool, measured: Array, case: Case, model: NoiseModel
) -> tuple[tuple[Added, ...], dict[str, float]]:
    """Return the effects with the ages of their profiles in this record, and those ages, m.

    An age is by how much the radius has fallen since the profile was formed; only those that were
    fitted are found anew. It changes the length of a turn, so the angle is found together with it.
    """
    ages_m: dict[str, float] = {}
    for at, effect in enumerate(case.effects):
        profiles = BY_NAME[effect.effect].profiles
        if profiles is not None and profiles.age in dict(effect.parameters):
            case = _with_best_age(pool, measured, case, model, at, profiles.age)
            ages_m[effect.location] = float(dict(case.effects[at].parameters)[profiles.age])
    return case.effects, ages_m


def _with_best_age(
    pool: SimulationPool, measured: Array, case: Case, model: NoiseModel, at: int, age: str
) -> Case:
    """Return the case with the age of effect ``at`` and the angle of its body that cost least.

    ``age`` is the parameter's name. Other effects on that body turn with it.
    """
    effect = case.effects[at]
    values, row = dict(effect.parameters), BY_NAME[effect.effect].accepts[age]

    def moved(x: Array) -> Case:  # x: rad, cm
        known = {**values, age: min(max(0.01 * float(x[1]), row.low), row.high)}
        new = replace(effect, parameters=tuple(known.items()))
        effects = (*case.effects[:at], new, *case.effects[at + 1 :])
        return replace(case, effects=with_turned(effects, turns_with(effect), float(x[0])))

    def cost(x: Array) -> float:
        return float(costs_of(pool, measured, model, [moved(x)])[0])

    start = np.array([0.0, 100.0 * float(values[age])])
    options = {
        "initial_simplex": start + np.array(JUDGE.age_simplex),
        "xatol": JUDGE.age_corners,
        "fatol": JUDGE.age_chi2,
        "maxfev": JUDGE.age_runs,
    }
    return moved(minimize(cost, start, method="Nelder-Mead", options=options).x)
