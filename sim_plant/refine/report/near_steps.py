"""Moments that fall on a step of a reference: the line answers there by itself."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.report.verdict import Moment, Verdict

REFERENCES = (("line speed", "line_speed_ref_m_s"), ("tension", "tension_ref_N"))


def near_steps(verdict: Verdict, fitted: Sequence[Recording]) -> tuple[str, ...]:
    """Return a sentence on every moment of a verdict that falls on a step of a reference."""
    begins = [*(e.begins for e in verdict.effects), *(u.begins for u in verdict.unknown)]
    moments = dict.fromkeys(moment for moment in begins if moment is not None)
    return tuple(
        f"What begins at {at.time_s:.1f} s of {at.record} begins with a step of the {name} "
        "reference: the line's own answer to that may be what was found; record the step again."
        for at in moments
        if at.record_index < len(fitted)
        for name, column in REFERENCES
        if _steps_near(fitted[at.record_index], column, at)
    )


def _steps_near(record: Recording, column: str, at: Moment) -> bool:
    """Return whether a reference steps from one row that has it to the next, near a moment."""
    given = record.columns.get(column)
    known = np.flatnonzero(np.isfinite(given)) if given is not None else np.empty(0, dtype=int)
    if given is None or not known.size:
        return False
    values = given[known]
    least = CRITERIA.model.tension_step_share * float(np.mean(np.abs(values)))
    jumps = known[1:][np.abs(np.diff(values)) > least]
    near = np.abs(jumps * record.sample_time_s - at.time_s) <= CRITERIA.report.near_step_s
    return bool(near.any())
