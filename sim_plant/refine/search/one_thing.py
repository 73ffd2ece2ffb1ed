"""One name for what shows in several ways: a reading that sticks, or something at a rhythm.

A load cell that sticks lets its loop hunt, which looks like spectral lines in time. What comes
again and again looks like an event, like many spectral lines, or like a declared number that would
have to move.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.search.reading_direction import Sticking, sticking_cells
from sim_plant.refine.search.recurring import Recurrence, recurrences, strongest_channel
from sim_plant.refine.search.selection import Selection
from sim_plant.refine.search.strongest_zone import channels_of_zones
from sim_plant.refine.search.unexplained import ClassAndCoordinate, Unknown, where_on
from sim_plant.refine.search.unknown_event import zone_of

PERIOD = "period_s"
"""Key of a rhythm in time, for which no single spectral line stands."""
OWN_CLASSES = ("travel", "angle")
"""Of what turns or travels: a part of no reading that sticks, and of no rhythm in time."""


def whole_of(objective: Objective, selection: Selection) -> Unknown | None:
    """Return the one thing that the unknowns of a selection are parts of, or None.

    ``selection`` is the one before any free term: these would take up a part of the whole.
    """
    if not selection.unknown:
        return None
    cells = sticking_cells(objective, selection.fit)
    return sticking_reading(cells) if cells else rhythm_of(objective, selection)


def told_as(whole: Unknown, selection: Selection) -> Selection:
    """Return the selection with ``whole`` in the place of its parts."""
    times = [axes.time_s for axes in selection.record_axes]
    durations_s = [float(time_s[-1] - time_s[0]) for time_s in times]
    rest = [u for u in selection.unknown if not is_part_of(u, whole, durations_s)]
    return replace(selection, unknown=(whole, *rest))


def sticking_reading(cells: Sequence[Sticking]) -> Unknown:
    """Return readings with a gap as something unknown that depends on the state of the line."""
    best, *others = cells
    where: dict[str, float | str] = {"channel": best.channel, "gap_N": best.band_N}
    if others:
        where["also_in"] = ", ".join(cell.channel for cell in others)
    return Unknown(unknown_class="state", coordinate=where, chi2_reduction=best.chi2_reduction)


def rhythm_of(objective: Objective, selection: Selection) -> Unknown | None:
    """Return the rhythm in time of what a selection leaves, or None.

    Of the first record that has one. What recurs along the web or with a roll is no rhythm in
    time: its spectral lines on those axes tell it.
    """
    rows = zip(
        objective.pool.twins,
        selection.record_axes,
        objective.split(selection.fit.residual),
        objective.whitening.noise,
        strict=True,
    )
    for twin, axes, left, noise in rows:
        white = left[noise.analogue]
        seen = recurrences(axes, white)
        if not seen or seen[0].axis != "time":
            continue
        names = [n for n, use in zip(twin.channels, noise.analogue, strict=True) if use]
        own = channels_of_zones(twin.declaration, names)
        at = strongest_channel(white[own], axes.time_s, 1.0 / seen[0].frequency)
        channel = names[own[at]]
        zone_and_channel = {"zone": zone_of(twin.declaration, channel), "channel": channel}
        (kind, where), *also = map(_class_and_coordinate, seen)
        return Unknown(
            unknown_class=kind,
            coordinate={**where, **zone_and_channel},
            chi2_reduction=sum(u.chi2_reduction for u in selection.unknown),
            also=tuple(also),
        )
    return None


def _class_and_coordinate(seen: Recurrence) -> ClassAndCoordinate:
    if seen.axis == "time":
        return "time", {PERIOD: 1.0 / seen.frequency}
    return seen.axis, where_on(seen.axis, seen.roll, seen.frequency)


def is_part_of(unknown: Unknown, whole: Unknown, durations_s: Sequence[float]) -> bool:
    """Return whether an unknown is but a way in which ``whole`` shows.

    A loop that reads a cell which sticks hunts: spectral lines in time. A rhythm has spectral
    lines at its harmonics, to what a record resolves. Either begins somewhere, and moves declared
    numbers: what has no spectral line is a part of any whole. Of what turns or travels none is.

    Parameters
    ----------
    durations_s : of the records, each as long as it is judged.
    """
    if unknown.unknown_class in OWN_CLASSES:
        return False
    if unknown.unknown_class != "time" or whole.unknown_class != "time":
        return True
    period_s = float(whole.coordinate[PERIOD])
    off = _from_nearest_integer(float(unknown.coordinate["frequency_Hz"]) * period_s)
    off_Hz = abs(off) / period_s
    resolved = CRITERIA.search.recurring.resolved_cycles
    return any(off_Hz * duration_s < resolved for duration_s in durations_s)


def _from_nearest_integer(value: float) -> float:
    return value - round(value)
