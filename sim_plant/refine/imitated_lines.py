"""Two effects at one spectral line of travel, on the record held out.

Their four numbers answer most of any line in the record that they were fitted to. At other speeds
and radii only true ones do.
"""

from __future__ import annotations

from itertools import combinations

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.judge.refutation import in_floors
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.model.twin import Case, Twin
from sim_plant.refine.search.degenerate_pair import same_wavenumbers
from sim_plant.refine.search.selection import Selection
from sim_plant.refine.spectra.coordinates import (
    RecordAxes,
    axes_of,
    periodic_chi2_reduction,
    spectra,
)

TWINS_LEFT_SHARE = CRITERIA.search.completeness.twins_left_share
NOISE_PEAK = CRITERIA.search.unexplained.periodic
"""A free spectral line of less chi-square may be noise."""


def imitated_line(
    twin: Twin, selection: Selection, evaluation: Evaluation
) -> tuple[int, int] | None:
    """Return the indices of two effects that only imitate their spectral line, or None."""
    if not selection.record_axes:
        return None
    axes = selection.record_axes[0]
    found = [accepted.hypothesis for accepted in selection.accepted]
    for pair in combinations(range(len(found)), 2):
        one, other = (found[at] for at in pair)
        if same_wavenumbers(axes, one, other) and imitates_its_line(twin, evaluation, one):
            return pair
    return None


def imitates_its_line(twin: Twin, evaluation: Evaluation, h: Hypothesis) -> bool:
    """Return whether what is left at the line of ``h`` is more than two true effects leave there.

    Of the record held out, angles and radii apart, which begin anew.
    """
    axes = axes_of(twin, evaluation.measured, Case(effects=evaluation.effects), evaluation.first)
    shown = _at_line(axes, evaluation, evaluation.corrected, h)
    left = _at_line(axes, evaluation, evaluation.amended, h)
    return left > max(NOISE_PEAK, TWINS_LEFT_SHARE * shown)


def _at_line(axes: RecordAxes, evaluation: Evaluation, without: Array, h: Hypothesis) -> float:
    """Return the chi-square of a free spectral line there, in what ``without`` leaves."""
    rest = in_floors(evaluation, evaluation.measured - without)
    rest = rest - rest.mean(axis=1, keepdims=True)
    return periodic_chi2_reduction(h, axes, spectra(axes, rest)) or 0.0
