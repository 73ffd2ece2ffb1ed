"""The frequencies of the mains in the record judged: never exactly at their nominal one.

49.98 Hz in one record and 50.02 Hz in another are three cycles apart after 80 s.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.base.signatures import Frequency
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.turning import turned_effect
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Added, Case
from sim_plant.refine.noise.innovations import NoiseModel

QUARTER_RAD = 0.5 * np.pi
"""A quarter turn of a phase."""


def differs_by_record(effect: Added) -> bool:
    """Return whether the frequency of an effect differs from record to record, constant in each.

    That of the mains does.
    """
    shows = BY_NAME[effect.effect].shows
    return isinstance(shows, Frequency) and bool(shows.near_Hz)


def with_frequencies(
    pool: SimulationPool, measured: Array, case: Case, model: NoiseModel
) -> tuple[Added, ...]:
    """Return the effects with this record's mains frequencies; phases are left to be turned.

    One effect after the other, beside all others as they are.

    Equation: z = y(phase) + j y(phase + quarter turn), y the effect's simulated response, which
    lags as its phase grows; w() the whitening filter; r = measured less the other effects; d, the
    shift of frequency, up to ``mains_share`` of it, maximises |sum w(r) conj(w(z))
    exp(-2 pi j d t)| over channels and samples  [own]. A shift so small changes no answer of the
    line but its frequency.

    Parameters
    ----------
    measured : (channels, samples) of the pool's first record, in channel units.
    """
    effects = case.effects
    for k, effect in enumerate(effects):
        if differs_by_record(effect):
            there = replace(case, effects=effects)
            shift_Hz = _shift_Hz(pool, measured, there, k, model)
            effects = (*effects[:k], _moved(effect, shift_Hz), *effects[k + 1 :])
    return effects


def frequency_Hz(effect: Added) -> float:
    """Return the frequency of an effect that ``differs_by_record``."""
    record = BY_NAME[effect.effect]
    assert isinstance(record.shows, Frequency)
    values = {**record.parameters, **dict(effect.parameters)}
    return float(values[record.shows.parameter])


def _moved(effect: Added, shift_Hz: float) -> Added:
    shows = BY_NAME[effect.effect].shows
    assert isinstance(shows, Frequency)
    values = {**dict(effect.parameters), shows.parameter: frequency_Hz(effect) + shift_Hz}
    return replace(effect, parameters=tuple(values.items()))


def _shift_Hz(
    pool: SimulationPool, measured: Array, case: Case, k: int, model: NoiseModel
) -> float:
    """Return by how much effect ``k`` is at another frequency in this record, within the bound."""
    effect = case.effects[k]
    others = (*case.effects[:k], *case.effects[k + 1 :])
    tries = [others, case.effects, (*others, turned_effect(effect, QUARTER_RAD))]
    runs = pool.run([replace(case, effects=tried) for tried in tries], keep=False)
    base, here, quarter = (run[0] for run in runs)
    if not all(np.isfinite(run).all() for run in (base, here, quarter)):
        return 0.0
    left = _centred(model.whiten(measured - base))
    # +1 where the phase delays the response, cos(2 pi f t - phase): turned further it lags
    sense = -1.0 if BY_NAME[effect.effect].quadratures[0].against else 1.0
    turning = model.whiten(here - base) + 1j * sense * model.whiten(quarter - base)
    step_s = pool.twins[0].declaration.sample_time_s
    most_Hz = CRITERIA.judge.mains_share * frequency_Hz(effect)
    return best_shift_Hz(np.sum(left * np.conj(turning), axis=0), step_s, most_Hz)


def best_shift_Hz(product: Sequence[complex] | Array, step_s: float, most_Hz: float) -> float:
    """Return the frequency within ``most_Hz`` of 0 at which a line of ``product`` is strongest.

    ``product`` (samples,) is every ``step_s``. 0 of a record without any.
    """
    size = CRITERIA.judge.mains_tries * len(product)
    power = np.abs(np.fft.fft(product, size))
    shifts_Hz = np.fft.fftfreq(size, step_s)
    within = np.flatnonzero(np.abs(shifts_Hz) <= most_Hz)
    return float(shifts_Hz[within[int(np.argmax(power[within]))]])


def _centred(white: Array) -> Array:
    found: Array = white - white.mean(axis=1, keepdims=True)
    return found
