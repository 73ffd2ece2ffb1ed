"""What stays of a record held out when an effect is left out and nothing stands in its place."""

from __future__ import annotations

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.judge.refutation import STATES, left
from sim_plant.refine.model.twin import Case, Twin
from sim_plant.refine.search.unexplained import Unknown, periodic_left
from sim_plant.refine.spectra.coordinates import spectra, travel_of


def what_stays(twin: Twin, evaluation: Evaluation) -> Unknown:
    """Return the strongest spectral line of what is left there, or ``broadband`` without one.

    Channels count by their noise floor and without their mean; angles and radii, whose start
    differs from record to record, do not.
    """
    first = evaluation.first
    judged = np.array([not name.endswith(STATES) for name in evaluation.channels])
    residual = (evaluation.measured - evaluation.amended)[judged, first:]
    white: Array = residual / evaluation.floor[judged, np.newaxis]
    white = white - white.mean(axis=1, keepdims=True)
    strength = left(evaluation) * white.size
    travel = travel_of(twin, evaluation.measured, Case(effects=evaluation.effects), first)
    found = periodic_left([spectra(travel, white)], excess=strength)
    return found or Unknown(kind="broadband", strength=strength, coordinate={})
