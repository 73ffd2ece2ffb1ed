"""Past outputs beside the inputs (ARX): what is left then is the error one step ahead."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.without_line.general.effect import (
    GeneralEffect,
    Number,
    OutputRecord,
    PlacedEffect,
)

GENERAL = CRITERIA.without_line.general


def regressors(record: OutputRecord, placed: PlacedEffect) -> Array:
    """Return the output 1 to ``order`` samples before (samples, order)."""
    return np.stack(
        [np.roll(record.output, back) for back in range(1, int(placed.constants[0]) + 1)], axis=1
    )


def starts(records: Sequence[OutputRecord]) -> list[PlacedEffect]:
    """Return every order that is not above ``end_samples``."""
    most = min(record.end_samples for record in records)
    return [
        PlacedEffect(effect="past_outputs", place="output", constants=(float(order),))
        for order in GENERAL.past_orders
        if order <= most
    ]


EFFECT = GeneralEffect(
    name="past_outputs",
    stage="past",
    text="past outputs tell the next one: how coloured the rest is, not what causes it",
    numbers=(Number(name="order", text="samples of the past"),),
    starts=starts,
    regressors=regressors,
)
