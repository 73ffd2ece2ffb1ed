"""A zero of the output that differs from record to record and wanders through it."""

from __future__ import annotations

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.without_line.general.effect import (
    GeneralEffect,
    Number,
    OutputRecord,
    PlacedEffect,
)


def regressors(record: OutputRecord, _placed: PlacedEffect) -> Array:
    """Return 1 and time from the middle of the record, s (samples, 2)."""
    samples = record.output.size
    time_s = (np.arange(samples) - 0.5 * (samples - 1)) * record.step_s
    return np.stack([np.ones(samples), time_s], axis=1)


EFFECT = GeneralEffect(
    name="offset_drift",
    stage="own",
    text="the output's zero is another in each record, and drifts",
    sizes=(
        Number(name="offset", text="zero of the record"),
        Number(name="drift_per_s", text="its drift"),
    ),
    regressors=regressors,
)
