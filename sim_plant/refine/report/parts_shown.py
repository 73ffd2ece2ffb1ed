"""Which parts of a record the page shows, and where most is left of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sim_plant.refine.report.plots import (
    SHOWN_S,
    channels_by_error,
    overlay,
    part_around,
    worst_of,
    worst_part,
)
from sim_plant.refine.report.tables import above_noise

if TYPE_CHECKING:
    from sim_plant.refine.judge.holdout import Evaluation
    from sim_plant.refine.report.outcome import Outcome


@dataclass(frozen=True, slots=True, kw_only=True)
class Shown:
    """Two plots of a part of a record, and what is said above them."""

    caption: str
    plots: tuple[str, ...]


def overlays(outcome: Outcome) -> list[Shown]:
    """Return what begins where it does, and the record judged where it is worst."""
    judged, step_s = outcome.evaluation, outcome.selection.record_axes[0].sample_time_s
    shown = []
    if outcome.record_of_onset is not None:
        at, found = outcome.record_of_onset.moment, outcome.record_of_onset.evaluation
        part = part_around(found, step_s, at.time_s)
        said = f"{_span(at.record, part, step_s)}; dotted: {at.time_s:.2f} s, where it begins"
        plots = overlay(found, step_s, part, draw_amended=outcome.is_amended, mark_s=at.time_s)
        shown.append(Shown(caption=said, plots=plots))
    part = worst_of(judged, step_s)
    said = f"{_span(outcome.judged.path.name, part, step_s)}, where the declared line is worst"
    plots = overlay(judged, step_s, part, draw_amended=outcome.is_amended)
    shown.append(Shown(caption=said, plots=plots))
    above = above_noise(judged, channels_by_error(judged))
    if outcome.is_amended and above:
        part = _loudest_part(judged, above, step_s)
        plots = overlay(judged, step_s, part, draw_amended=True)
        said = f"{_span(outcome.judged.path.name, part, step_s)}, where the amended line is worst"
        shown.append(Shown(caption=said, plots=plots))
    return shown


def _loudest_part(judged: Evaluation, above: Mapping[str, float], step_s: float) -> slice:
    """Return the samples in which most is left of the channel that is furthest above noise."""
    at = judged.channels.index(max(above, key=lambda channel: above[channel]))
    return worst_part(judged, at, max(1, round(SHOWN_S / step_s)), judged.amended)


def _span(record: str, part: slice, step_s: float) -> str:
    return f"{record}, {part.start * step_s:.1f} to {part.stop * step_s:.1f} s"


def loudest(outcome: Outcome) -> str:
    """Return where and when most is left on the record judged, as text."""
    judged, step_s = outcome.evaluation, outcome.selection.record_axes[0].sample_time_s
    above = above_noise(judged, channels_by_error(judged))
    if not above:
        return ""
    name, part = max(above, key=lambda k: above[k]), _loudest_part(judged, above, step_s)
    return (
        f"{name} ({above[name]:.2f} of its noise), {_span(outcome.judged.path.name, part, step_s)}"
    )
