"""Where a spectral line was seen: at every speed, at one speed only, or as an order of a turn."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtri

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.spectra.spectral_lines import speed_weights
from sim_plant.refine.without_line.record_filter import Remainder

WITHOUT_LINE = CRITERIA.without_line
EVERY_SPEED = "every speed"
ONE_SPEED = "one speed"
SOME_SPEEDS = "some speeds"
EVERY_RECORD = "every record"
ONE_RECORD = "one record"
SOME_RECORDS = "some records"


@dataclass(frozen=True, slots=True, kw_only=True)
class SpectralLinePresence:
    """In which records and at which speeds a spectral line is.

    Attributes
    ----------
    scope : ``EVERY_SPEED`` or another of the six texts above.
    present : per record, whether it is there on its own.
    speeds_m_s : mean speed of the records in which it is there; empty without a speed.
    axis_proven : it is in time or in travel, by several speeds or by one that varies.
    other_frequency : on the other axis (1/m for one in time, Hz for one in travel) at the
        one speed at which it was seen; 0 where its axis is proven.
    order, fundamental : it is this whole multiple of a fundamental that others share, 1/m;
        0 where none is known.
    """

    scope: str
    present: tuple[bool, ...]
    speeds_m_s: tuple[float, ...] = ()
    axis_proven: bool = True
    other_frequency: float = 0.0
    order: int = 0
    fundamental: float = 0.0


def position_of(item: Remainder, axis: str) -> Array:
    """Return time, s, or travel, m, from the first judged sample."""
    if axis == "travel" and item.travel_m is not None:
        travel_m: Array = item.travel_m - item.travel_m[0]
        return travel_m
    time_s: Array = np.arange(item.residual.shape[1], dtype=np.float64) * item.record.sample_time_s
    return time_s


def chi2_reduction(
    item: Remainder, white: Array, axis: str, frequency: float
) -> tuple[float, int]:
    """Return a spectral line's chi-square reduction in one record, and its degrees of freedom.

    Parameters
    ----------
    white : the whitened residual (outputs, judged).
    frequency : in cycles per unit of ``axis``. The largest reduction counts that is found within
        1 / extent of the record on either side.
    """
    moving = item.speed_m_s if item.speed_m_s is not None else np.ones(white.shape[1])
    weights = speed_weights(moving, 2)
    position = position_of(item, axis)
    width = 1.0 / float(position[-1])
    best = 0.0
    for at in np.linspace(frequency - width, frequency + width, WITHOUT_LINE.presence_points):
        wave = np.exp(-2j * np.pi * at * position)
        here = np.abs((white * wave) @ weights.T) ** 2
        best = max(best, 2.0 / white.shape[1] * float(here.sum()))
    return best, 2 * white.shape[0] * weights.shape[0]


def own_threshold(degrees: int) -> float:
    """Return the chi-square reduction near a frequency that noise exceeds by ``false_alarm``.

    That is chi-square theory; ``safety`` makes it larger, for residuals are not quite white.
    """
    per_bin = WITHOUT_LINE.false_alarm / WITHOUT_LINE.bins
    return WITHOUT_LINE.safety * float(chdtri(degrees, per_bin))


def presence_of(
    items: Sequence[Remainder], whites: Sequence[Array], axis: str, frequencies: Sequence[float]
) -> SpectralLinePresence:
    """Return in which records a spectral line is there on its own, and if its axis is proven.

    Parameters
    ----------
    frequencies : of the spectral line in every record.
    """
    own = [
        chi2_reduction(item, white, axis, at)
        for item, white, at in zip(items, whites, frequencies, strict=True)
    ]
    present = [value > own_threshold(degrees) for value, degrees in own]
    if not any(present):  # together they are there: the strongest record stands for it
        present[int(np.argmax([value for value, _ in own]))] = True
    if items[0].speed_m_s is None:
        scope = _scope(present, several=False, axis_proven=True)
        return SpectralLinePresence(scope=scope, present=tuple(present))
    speeds = [float(np.mean(x.speed_m_s)) for x in items if x.speed_m_s is not None]
    there = [v for v, yes in zip(speeds, present, strict=True) if yes]
    several = max(there) > (1.0 + CRITERIA.match.one_speed_share) * min(there)
    axis_proven = several or any(
        _axis_proven(item, white, axis, at, value)
        for item, white, at, (value, _), yes in zip(
            items, whites, frequencies, own, present, strict=True
        )
        if yes
    )
    at = float(np.median([c for c, yes in zip(frequencies, present, strict=True) if yes]))
    mean = float(np.mean(there))
    return SpectralLinePresence(
        scope=_scope(present, several=several, axis_proven=axis_proven),
        present=tuple(present),
        speeds_m_s=tuple(there),
        axis_proven=axis_proven,
        other_frequency=0.0 if axis_proven else (at / mean if axis == "time" else at * mean),
    )


def _scope(present: Sequence[bool], *, several: bool, axis_proven: bool) -> str:
    """Return in what scope a spectral line was seen.

    ``several``: at more than one mean speed; ``axis_proven``: in time or in travel.
    """
    if several:
        return EVERY_SPEED if all(present) else SOME_SPEEDS
    if not axis_proven:
        return ONE_SPEED
    if sum(present) == 1:
        return ONE_RECORD
    return EVERY_RECORD if all(present) else SOME_RECORDS


def _axis_proven(
    item: Remainder, white: Array, axis: str, frequency: float, reduction: float
) -> bool:
    """Return whether the speed of one record varies enough to part time from travel.

    ``reduction`` : of chi-square, by the spectral line of ``frequency`` on ``axis``.
    """
    if item.speed_m_s is None or item.travel_m is None:
        return False
    mean = float(np.mean(item.speed_m_s))
    is_in_time = axis == "time"
    other, of_other = ("travel", frequency / mean) if is_in_time else ("time", frequency * mean)
    rival, degrees = chi2_reduction(item, white, other, of_other)
    return reduction - rival > max(own_threshold(degrees), WITHOUT_LINE.axis_share * reduction)


def harmonic_series(
    wavenumbers: Sequence[float], widths: Sequence[float]
) -> tuple[float, list[int]]:
    """Return the fundamental that most spectral lines are whole multiples of, and their orders.

    The largest fundamental counts of those with as many lines; at least three lines have to share
    it, so closely that chance does it less often than ``chance``. Nothing (0, no orders)
    otherwise.

    Parameters
    ----------
    wavenumbers : of the spectral lines, 1/m.
    widths : how far each may be off, 1/m.
    """
    best: tuple[float, list[int]] = (0.0, [])
    most = WITHOUT_LINE.fewest_orders - 1
    for first in wavenumbers:
        for divisor in range(1, WITHOUT_LINE.highest_order + 1):
            base = first / divisor
            orders = _orders_of(base, wavenumbers, widths)
            count = len({n for n in orders if n})
            larger = count == most and bool(best[1]) and base > WITHOUT_LINE.lower_share * best[0]
            if (count > most or larger) and _chance(base, orders, widths) < WITHOUT_LINE.chance:
                best, most = (base, orders), count
    return best


def _reach(base: float, order: int, width: float) -> float:
    """Return how far from a whole number an order may be."""
    return min(WITHOUT_LINE.order_share, 2.0 * width / base + WITHOUT_LINE.speed_share * order)


def _orders_of(base: float, wavenumbers: Sequence[float], widths: Sequence[float]) -> list[int]:
    """Return the order of every spectral line, 0 where it is none."""
    orders = []
    for k, width in zip(wavenumbers, widths, strict=True):
        order = round(k / base)
        good = 1 <= order <= WITHOUT_LINE.highest_order
        orders.append(order if good and abs(k / base - order) < _reach(base, order, width) else 0)
    return orders


def _chance(base: float, orders: Sequence[int], widths: Sequence[float]) -> float:
    """Return how often, expected, spectral lines at random share a fundamental so closely."""
    reaches = sorted(2.0 * _reach(base, n, w) for n, w in zip(orders, widths, strict=True) if n)
    tried = len(orders) * max(orders) * math.comb(len(orders), len(reaches))
    return tried * math.prod(reaches[1:])


def as_orders(
    lines: Sequence[tuple[str, float, SpectralLinePresence]], extents_m: Sequence[float]
) -> list[tuple[str, float, SpectralLinePresence]]:
    """Return spectral lines (axis, frequency, presence), those that are orders of a turn named so.

    One seen at one speed may be one in time or in travel. It is an order when its wavenumber
    is a whole multiple of a fundamental that others, proven ones among them, share.

    Parameters
    ----------
    extents_m : travel of every record.
    """
    waves, widths, which = [], [], []
    for k, (axis, frequency, presence) in enumerate(lines):
        may_be_in_travel = presence.other_frequency > 0.0 and not presence.axis_proven
        if axis == "travel" or may_be_in_travel:
            waves.append(frequency if axis == "travel" else presence.other_frequency)
            extents = zip(extents_m, presence.present, strict=True)
            widths.append(1.0 / min(extent_m for extent_m, is_there in extents if is_there))
            which.append(k)
    named = list(lines)
    while which:
        base, orders = harmonic_series(waves, widths)
        if not any(orders):
            break
        for k, wave, order in zip(which, waves, orders, strict=True):
            if order:
                named[k] = _named(named[k], wave, order, base)
        left = [j for j, order in enumerate(orders) if not order]
        waves, widths, which = (
            [waves[j] for j in left],
            [widths[j] for j in left],
            [which[j] for j in left],
        )
    return named


def _named(
    line: tuple[str, float, SpectralLinePresence], wave: float, order: int, base: float
) -> tuple[str, float, SpectralLinePresence]:
    """Return a spectral line as an order: in travel, whatever it was taken for before."""
    axis, frequency, presence = line
    presence = replace(presence, order=order, fundamental=base)
    if axis == "travel":
        return axis, frequency, presence
    return "travel", wave, replace(presence, other_frequency=frequency)
