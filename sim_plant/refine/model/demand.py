"""What records ask of the line: speeds and ramps of its reference, and up to where they show."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.base.effects import Demand
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.twin import Twin

MODEL = CRITERIA.model


def demand_of(twins: Sequence[Twin]) -> Demand:
    """Return what the references of these records ask."""
    steps_s = [t.declaration.sample_time_s for t in twins]
    ramps = [fastest_ramp(t.speed_m_s, step_s) for t, step_s in zip(twins, steps_s, strict=True)]
    return Demand(
        fastest_ramp_m_s2=max(ramps),
        slowest_m_s=min(float(np.min(t.speed_m_s)) for t in twins),
        fastest_m_s=max(float(np.max(t.speed_m_s)) for t in twins),
        highest_Hz=0.5 / max(steps_s),
    )


def fastest_ramp(speed_m_s: Array, step_s: float) -> float:
    """Return the highest rate, m/s2, at which a reference (samples,) ramps; 0 where it does not.

    A ramp changes as fast before a sample as after it; one with rounded ends does at its steepest.
    """
    reach = max(1, round(MODEL.ramp_look_s / step_s))
    slowest = MODEL.ramp_slowest_share * float(np.max(np.abs(speed_m_s), initial=0.0))
    rate = np.abs(speed_m_s[reach:] - speed_m_s[:-reach]) / (reach * step_s)
    before, after = rate[:-reach], rate[reach:]
    steady = np.abs(after - before) < MODEL.ramp_steady_share * np.maximum(after, before)
    rates = 0.5 * (before + after)[steady]
    rates = rates[rates > slowest]
    if not rates.size:
        return 0.0
    return float(np.median(rates[rates > (1.0 - MODEL.ramp_steady_share) * rates.max()]))
