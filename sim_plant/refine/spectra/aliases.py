"""Hypotheses that a spectral line itself proposes.

Where it was before sampling, which order it is, how large the body is that turns so; and where
something may ring that an order comes by.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from sim_plant.base.signatures import Frequency, Orders
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.hypotheses import Hypothesis, with_number
from sim_plant.refine.spectra.coordinates import (
    TWO_PI,
    RecordAxes,
    line_at_body,
    orders_of,
    radius_at,
    rates_Hz,
)
from sim_plant.refine.spectra.spectral_lines import SpectralLines

SPECTRA = CRITERIA.spectra


def with_aliases(
    library: Sequence[Hypothesis],
    record_axes: Sequence[RecordAxes],
    spectra: Sequence[Sequence[SpectralLines]],
) -> list[Hypothesis]:
    """Return the library with mains effects at the frequencies that the strongest lines may be of.

    A spectral line at f in a record of sample rate f_s may come from k f_s +- f; kept is what is
    near one of the frequencies that the effect names.
    """
    rest = [h for h in library if not _named(h)]
    return [
        *rest,
        *(
            replace(h, start=with_number(h, h.start, shows.parameter, at))
            for h in library
            if (shows := _named(h))
            for at in origins_Hz(h, shows, record_axes, spectra)
        ),
    ]


def origins_Hz(
    h: Hypothesis,
    shows: Frequency,
    record_axes: Sequence[RecordAxes],
    spectra: Sequence[Sequence[SpectralLines]],
) -> list[float]:
    """Return the frequency from which the strongest line in time of each record may come, Hz.

    Of several the lowest: all fold to the same line with the same sizes, so no record tells them
    apart, and higher harmonics of mains are weaker. A line of fewer than ``alias_cycles`` per
    record is passed over: what goes with speed or tension has lines there too, and mains wander
    more. One that was not folded is told as mains within the ``width`` of the signature: nothing
    of a line swings at 50 Hz. A folded one may lie where dancers, loops and fans swing, so it has
    to be where a grid can be, as near as the record tells a frequency.
    Equation: |f / f_mains - 1| < w of f seen as it is, else <= s + 1 / (f_mains T), s the share of
    ``mains_share``, T the length of the record  [ENTSO-E; own].
    """
    highest = h.effect.accepts[shows.parameter].high
    origins: list[float] = []
    for axes, record in zip(record_axes, spectra, strict=True):
        rate = 1.0 / axes.sample_time_s
        length_s = float(axes.time_s[-1] - axes.time_s[0])
        slowest = SPECTRA.alias_cycles / length_s
        seen = next(s.peak_from(slowest)[0] for s in record if s.axis == "time")
        folded = [
            k * rate + sign * seen for k in range(int(highest / rate) + 2) for sign in (1, -1)
        ]
        near = [
            f for f in folded if 0.0 < f <= highest and _may_be_mains(f, seen, shows, length_s)
        ]
        origins += sorted(near)[:1]
    return sorted(dict.fromkeys(round(f, 4) for f in origins))


def with_orders(
    library: Sequence[Hypothesis],
    record_axes: Sequence[RecordAxes],
    spectra: Sequence[Sequence[SpectralLines]],
) -> list[Hypothesis]:
    """Return the library with each effect of a free order also at that of the strongest line.

    Slots, teeth and pole pairs per turn are any whole number; no list holds them all.
    """
    more: dict[tuple[object, ...], Hypothesis] = {}
    for h in library:
        shows = h.effect.shows
        if not isinstance(shows, Orders) or not shows.parameter or shows.resonant:
            continue
        for order in whole_orders(h, record_axes, spectra):
            picked = dict(h.fixed) | {shows.parameter: float(order)}
            proposed = replace(h, fixed=tuple(picked.items()))
            more.setdefault((h.key, order), proposed)
    there = {(h.key, h.fixed) for h in library}
    return [*library, *(h for h in more.values() if (h.key, h.fixed) not in there)]


def whole_orders(
    h: Hypothesis, record_axes: Sequence[RecordAxes], spectra: Sequence[Sequence[SpectralLines]]
) -> list[int]:
    """Return the orders of the hypothesis' body that the strongest line of a record may be."""
    orders = []
    for axes, record in zip(record_axes, spectra, strict=True):
        known = line_at_body(h, axes, record)
        if known is None:
            continue
        order, bin_width = known
        reach = max(2.0 * bin_width, SPECTRA.same_coordinate_share * order)
        whole = round(order)
        if whole >= 1 and abs(order - whole) <= min(reach, SPECTRA.whole_order_reach):
            orders.append(whole)
    return list(dict.fromkeys(orders))


def with_radii(
    library: Sequence[Hypothesis],
    record_axes: Sequence[RecordAxes],
    spectra: Sequence[Sequence[SpectralLines]],
) -> list[Hypothesis]:
    """Return the library with what rolls on a body also at the radius that the strongest line has.

    A fit finds a radius only from within a third of a turn over the whole record, and no list of
    radii is that dense. A line at a whole order of the body proposes none: what the body does
    itself is there always, a ratio of two ground radii by chance.
    """
    more = [
        replace(h, start=with_number(h, h.start, shows.rolls_on, at))
        for h in {h.key: h for h in library}.values()
        if isinstance(shows := h.effect.shows, Orders) and shows.rolls_on
        for at in radii_m(h, record_axes, spectra)
    ]
    return [*library, *more]


def radii_m(
    h: Hypothesis, record_axes: Sequence[RecordAxes], spectra: Sequence[Sequence[SpectralLines]]
) -> list[float]:
    """Return the radii of what rolls on the hypothesis' body and turns with a record's line, m."""
    assert isinstance(h.effect.shows, Orders)
    bounds = h.effect.accepts[h.effect.shows.rolls_on]
    found = []
    for axes, record in zip(record_axes, spectra, strict=True):
        order, bin_width = line_at_body(h, axes, record) or (0.0, 0.0)
        if abs(order - round(order)) > bin_width:
            radius_m = radius_at(h, axes) / order
            if bounds.low <= radius_m <= bounds.high:
                found.append(radius_m)
    return found


def with_resonances(
    library: Sequence[Hypothesis], record_axes: Sequence[RecordAxes]
) -> list[Hypothesis]:
    """Return the library with what rings at an order at the frequencies that its order passes.

    A resonance shows where its order comes by. From far off no slope leads there.
    """
    found: list[Hypothesis] = []
    for h in library:
        shows = h.effect.shows
        if not isinstance(shows, Orders) or not shows.resonant:
            found.append(h)
            continue
        starts = resonances_Hz(h, shows, record_axes)
        found += [
            replace(h, start=with_number(h, h.start, shows.rings_at, at)) for at in starts
        ] or [h]
    return found


def resonances_Hz(h: Hypothesis, shows: Orders, record_axes: Sequence[RecordAxes]) -> list[float]:
    """Return frequencies, rising, one of them near every frequency that the orders pass, Hz.

    Near: within ``half_widths``, of the damping that the hypothesis starts with.
    Equation: f_k = q^k, q = 1 + 2 w, w = ``half_widths`` times the damping, within f_low / (1 + w)
    and f_high (1 + w) of the orders in a record  [own].
    """
    reach = 1.0 + SPECTRA.half_widths * float(h.at_start[shows.damped_by])
    step = math.log(2.0 * reach - 1.0)
    bounds = h.effect.accepts[shows.rings_at]
    steps: set[int] = set()
    for axes in record_axes:
        body = axes.declaration.body(h.location)
        rates = rates_Hz(axes.angles_rad[body] / TWO_PI, axes)
        for order in orders_of(h, radius_at(h, axes)):
            low = max(order * float(rates.min()) / reach, bounds.low)
            high = min(order * float(rates.max()) * reach, bounds.high)
            if high > low:
                steps |= set(
                    range(math.ceil(math.log(low) / step), math.floor(math.log(high) / step) + 1)
                )
    return [math.exp(step * k) for k in sorted(steps)]


def _may_be_mains(frequency_Hz: float, seen_Hz: float, shows: Frequency, length_s: float) -> bool:
    """Return whether a line seen at ``seen_Hz`` may be of this frequency, see ``origins_Hz``."""
    if frequency_Hz == seen_Hz:
        return any(abs(frequency_Hz / at - 1.0) < shows.width for at in shows.near_Hz)
    spread, resolved_Hz = CRITERIA.judge.mains_share, 1.0 / length_s
    return any(abs(frequency_Hz - at) <= spread * at + resolved_Hz for at in shows.near_Hz)


def _named(h: Hypothesis) -> Frequency | None:
    """Return where an effect shows that names the frequencies it is near, else None."""
    shows = h.effect.shows
    return shows if isinstance(shows, Frequency) and shows.near_Hz else None
