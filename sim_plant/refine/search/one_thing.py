"""One name for what shows in several ways: a reading that sticks, or something at a rhythm.

A load cell that sticks lets its loop hunt, which looks like lines in time. What comes again and
again looks like an event, like many lines, or like a declared number that would have to move.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.search.reading_direction import Sticking, sticking_cells
from sim_plant.refine.search.recurring import Recurrence, recurrences, strongest_channel
from sim_plant.refine.search.selection import Selection
from sim_plant.refine.search.strongest_zone import channels_of_zones
from sim_plant.refine.search.unexplained import Place, Unknown, where_on
from sim_plant.refine.search.unknown_event import zone_of

PERIOD = "period_s"
"""Key of a rhythm in time, for which no single spectral line stands."""


def whole_of(objective: Objective, found: Selection) -> Unknown | None:
    """Return the one thing that the unknowns of a selection are parts of, or None.

    Of one that was made before free terms took up a part of it.
    """
    if not found.unknown:
        return None
    cells = sticking_cells(objective, found.fit)
    return sticking_reading(cells) if cells else rhythm_of(objective, found)


def told_as(selection: Selection, whole: Unknown, first: Selection) -> Selection:
    """Return the selection with ``whole`` in the place of its parts."""
    rest = [u for u in selection.unknown if not is_part_of(u, whole, first)]
    return replace(selection, unknown=(whole, *rest))


def sticking_reading(cells: Sequence[Sticking]) -> Unknown:
    """Return readings with a gap as something unknown that depends on the state of the line."""
    best, *others = cells
    where: dict[str, float | str] = {"channel": best.channel, "gap_N": best.band_N}
    if others:
        where["also_in"] = ", ".join(cell.channel for cell in others)
    return Unknown(unknown_class="state", coordinate=where, chi2_reduction=best.chi2_reduction)


def rhythm_of(objective: Objective, found: Selection) -> Unknown | None:
    """Return the rhythm in time of what a selection leaves, or None.

    Of the first record that has one. What recurs along the web or with a roll has lines there.
    """
    rows = zip(
        objective.pool.twins,
        found.record_axes,
        objective.split(found.fit.residual),
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
        place = {"zone": zone_of(twin.declaration, channel), "channel": channel}
        (kind, where), *also = map(_place_of, seen)
        return Unknown(
            unknown_class=kind,
            coordinate={**where, **place},
            chi2_reduction=sum(u.chi2_reduction for u in found.unknown),
            also=tuple(also),
        )
    return None


def _place_of(seen: Recurrence) -> Place:
    if seen.axis == "time":
        return "time", {PERIOD: 1.0 / seen.frequency}
    return seen.axis, where_on(seen.axis, seen.roll, seen.frequency)


def is_part_of(unknown: Unknown, whole: Unknown, found: Selection) -> bool:
    """Return whether an unknown is but a way in which ``whole`` shows.

    A loop that reads a cell which sticks hunts: lines in time. A rhythm has lines at its
    harmonics, to what a record resolves. Either begins somewhere, and moves declared numbers.
    """
    if unknown.unknown_class in ("travel", "angle"):
        return False
    if unknown.unknown_class != "time" or whole.unknown_class != "time":
        return True
    period_s = float(whole.coordinate[PERIOD])
    off_Hz = abs(_off_whole(float(unknown.coordinate["frequency_Hz"]) * period_s)) / period_s
    times = [axes.time_s for axes in found.record_axes]
    return any(off_Hz * float(t[-1] - t[0]) < 1.0 for t in times)


def _off_whole(value: float) -> float:
    return value - round(value)
