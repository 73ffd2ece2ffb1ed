"""Two effects at one spectral line of travel, on the record held out.

Their four numbers answer most of any line in the record that they were fitted to. At other speeds
and radii only true ones do.
"""

from __future__ import annotations

from itertools import combinations

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.judge.rest_shown import axes_there, spectra_beside
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.model.twin import Twin
from sim_plant.refine.search.degenerate_pair import same_wavenumbers
from sim_plant.refine.search.selection import Selection
from sim_plant.refine.spectra.coordinates import periodic_chi2_reduction

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
    axes = axes_there(twin, evaluation)
    shown, left = (
        periodic_chi2_reduction(h, axes, spectra_beside(axes, evaluation, simulated)) or 0.0
        for simulated in (evaluation.corrected, evaluation.amended)
    )
    return left > max(NOISE_PEAK, TWINS_LEFT_SHARE * shown)
