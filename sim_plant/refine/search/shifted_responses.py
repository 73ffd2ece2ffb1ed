"""The response to an effect that begins at any moment: the nearest one simulated, shifted."""

from __future__ import annotations

from dataclasses import replace

from sim_plant.base.arrays import Array
from sim_plant.effects.onset import HOLD_S
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.hypotheses import Hypothesis, with_number
from sim_plant.refine.search.screening import responses_of
from sim_plant.refine.spectra.moment_axis import MomentAxis, parts_of, shifted


def response_begun_at(
    objective: Objective, axis: MomentAxis, h: Hypothesis, moment: float
) -> list[Array]:
    """Return the response to an effect that begins at ``moment``, s: the nearest one, shifted.

    (channels, samples) per record; other records than that of ``h`` as simulated.
    """
    record = h.record_index or 0
    nearest = min((part.middle for part in parts_of(axis)), key=lambda m: abs(m - moment))
    change = list(responses_of(objective, hypothesis_beginning_at(h, nearest))[0])
    sample_s = objective.pool.twins[record].declaration.sample_time_s
    change[record] = shifted(change[record], round((moment - nearest) / sample_s))
    return change


def lasting_response(
    objective: Objective, axis: MomentAxis, h: Hypothesis, moment: float
) -> list[Array]:
    """Return the response to an effect that begins at ``moment``, s, and does not end.

    It is the sum of the responses to episodes one after another, as long as ``h`` has them, until
    the record is over.
    """
    record = h.record_index or 0
    change = response_begun_at(objective, axis, h, moment)
    sample_s = objective.pool.twins[record].declaration.sample_time_s
    held = round(h.start[h.names.index(HOLD_S)] / sample_s)
    once = change[record]
    change[record] = sum((shifted(once, k) for k in range(0, once.shape[1], held)), 0.0 * once)
    return change


def hypothesis_beginning_at(h: Hypothesis, moment: float) -> Hypothesis:
    """Return the hypothesis with the moment to begin at."""
    return replace(h, start=with_number(h, h.start, h.moment_parameter, float(moment)))
