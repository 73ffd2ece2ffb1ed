"""What a record held out shows beyond the effects that are claimed."""

from __future__ import annotations

from sim_plant.base.arrays import Array
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.judge.refutation import in_floors, judged_channels, left
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
    rows = zip(evaluation.channels, judged_channels(evaluation), strict=True)
    names = [name for name, is_judged in rows if is_judged]
    return names, in_floors(evaluation, evaluation.measured - evaluation.amended)
