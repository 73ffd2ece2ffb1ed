"""What a record held out shows beyond the effects that are claimed."""

from __future__ import annotations

from sim_plant.base.arrays import Array
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.judge.refutation import in_floors, judged_channels, left
from sim_plant.refine.model.twin import Case, Twin
from sim_plant.refine.spectra.coordinates import RecordAxes, axes_of, spectra
from sim_plant.refine.spectra.spectral_lines import SpectralLines


def rest_shown(twin: Twin, evaluation: Evaluation) -> tuple[tuple[SpectralLines, ...], float]:
    """Return the spectra of what is left there, and its power beyond noise as a chi-square.

    Channels count by their noise floor and without their mean; angles and radii, whose start
    differs from record to record, do not.
    """
    _, rest = rest_in_floors(evaluation)
    axes = axes_there(twin, evaluation)
    found = spectra_beside(axes, evaluation, evaluation.amended)
    return found, left(evaluation) * rest.size


def axes_there(twin: Twin, evaluation: Evaluation) -> RecordAxes:
    """Return the axes of the record held out, with the effects as they are in it."""
    there = Case(effects=evaluation.effects)
    return axes_of(twin, evaluation.measured, there, evaluation.first)


def spectra_beside(
    axes: RecordAxes, evaluation: Evaluation, simulated: Array
) -> tuple[SpectralLines, ...]:
    """Return the spectra of what a simulation (channels, samples) leaves, as `rest_shown`."""
    white = in_floors(evaluation, evaluation.measured - simulated)
    return tuple(spectra(axes, white - white.mean(axis=1, keepdims=True)))


def rest_in_floors(evaluation: Evaluation) -> tuple[list[str], Array]:
    """Return names and rest (channels, judged samples) of all channels but angles and radii.

    In units of the noise floor of each.
    """
    rows = zip(evaluation.channels, judged_channels(evaluation), strict=True)
    names = [name for name, is_judged in rows if is_judged]
    return names, in_floors(evaluation, evaluation.measured - evaluation.amended)
