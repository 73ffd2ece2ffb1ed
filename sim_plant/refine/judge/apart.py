"""The error on a record held out, apart from changes of any size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.judge.refutation import in_floors, judged_channels


def apart_from(evaluation: Evaluation, changes: Sequence[Array]) -> Evaluation:
    """Return the evaluation with ``after`` as the best sizes of ``changes`` leave it.

    Each of them (channels, samples) has one size in all channels; angles and radii stay as they
    are. Equation: least squares of the rest in noise floors of each channel  [own].
    """
    if not changes:
        return evaluation
    rest = in_floors(evaluation, evaluation.measured - evaluation.amended)
    terms = np.column_stack([in_floors(evaluation, change).ravel() for change in changes])
    sizes = np.linalg.lstsq(terms, rest.ravel(), rcond=None)[0]
    left = rest - (terms @ sizes).reshape(rest.shape)
    after, judged = evaluation.rms_amended.copy(), judged_channels(evaluation)
    after[judged] = evaluation.floor[judged] * np.sqrt(np.mean(left**2, axis=1))
    return replace(evaluation, rms_amended=after)
