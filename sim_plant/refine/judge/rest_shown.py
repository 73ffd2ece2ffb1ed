"""What a record held out shows beyond the effects that are claimed."""

from __future__ import annotations

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.judge.refutation import STATES, left
from sim_plant.refine.model.twin import Case, Twin
from sim_plant.refine.spectra.coordinates import axes_of, spectra
from sim_plant.refine.spectra.spectral_lines import SpectralLines


def rest_shown(twin: Twin, evaluation: Evaluation) -> tuple[tuple[SpectralLines, ...], float]:
    """Return the spectra of what is left there, and its power beyond noise as a chi-square.

    Channels count by their noise floor and without their mean; angles and radii, whose start
    differs from record to record, do not.
    """
    _, white = rest_in_floors(evaluation)
    white = white - white.mean(axis=1, keepdims=True)
    axes = axes_of(twin, evaluation.measured, Case(effects=evaluation.effects), evaluation.first)
    return tuple(spectra(axes, white)), left(evaluation) * white.size


def rest_in_floors(evaluation: Evaluation) -> tuple[list[str], Array]:
    """Return names and rest (channels, judged samples) of all channels but angles and radii.

    In units of the noise floor of each.
    """
    names = [name for name in evaluation.channels if not name.endswith(STATES)]
    judged = np.array([name in names for name in evaluation.channels])
    rest = (evaluation.measured - evaluation.amended)[judged, evaluation.first :]
    white: Array = rest / evaluation.floor[judged, np.newaxis]
    return names, white
