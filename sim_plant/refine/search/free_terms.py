"""A free term for a spectral line that no effect explains, for a search beside it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.search.unexplained import Unknown
from sim_plant.refine.spectra.coordinates import (
    TWO_PI,
    RecordAxes,
    highest_order,
    is_periodic,
    orders_of,
    radius_at,
    rates_Hz,
    shown_Hz,
    wavenumbers_1_m,
)
from sim_plant.refine.spectra.spectral_lines import speed_weights

FREE_TERMS = CRITERIA.search.free_terms
PERIODIC_CLASSES = frozenset(FREE_TERMS.harmonics)
"""Coordinates of spectral lines."""


def free_term_basis(lines: Sequence[Unknown], axes: RecordAxes) -> Array:
    """Return orthonormal columns (judged samples, terms) of spectral lines and their harmonics.

    Each may grow with speed, and change slowly with time: that takes up a coordinate that is a
    fraction of a bin off, and a resonance that the line's speed crosses. One at a low whole order
    of a roll frees all low orders of that roll; whole is what the slow changes reach from there.
    Harmonics end where spectra do; a line itself always has its term.
    """
    half_turn = np.linspace(0.0, np.pi, axes.time_s.size)
    slow = np.cos(np.outer(np.arange(1, FREE_TERMS.half_waves + 1), half_turn))
    weights = np.vstack([speed_weights(axes.speed_m_s), slow])
    columns: list[Array] = []
    for item in lines:
        coordinate, first = _coordinate_of(item, axes)
        highest = _highest(item, coordinate, axes)
        for n in range(1, FREE_TERMS.harmonics[item.unknown_class] + 1):
            if n > 1 and n * first > highest:
                break
            phase = TWO_PI * n * first * coordinate
            columns += [w * wave for w in weights for wave in (np.cos(phase), np.sin(phase))]
    basis, sizes, _ = np.linalg.svd(np.stack(columns, axis=1), full_matrices=False)
    kept: Array = np.ascontiguousarray(basis[:, sizes > 1e-6 * sizes[0]])
    return kept


def goes_free(unknown: Unknown) -> bool:
    """Return whether a search can go on beside something unknown.

    Of a spectral line all sizes are a free term, and of a declared number all values. What is
    irregular has no such form; before an event a record is as quiet as noise.
    """
    return unknown.unknown_class in PERIODIC_CLASSES or bool(unknown.declared)


def explained_by_free_term(h: Hypothesis, lines: Sequence[Unknown], axes: RecordAxes) -> bool:
    """Return whether a hypothesis shows at the coordinate of a free term, or at its harmonics.

    A free term takes up almost all that is there: no effect is claimed for the rest of it.
    """
    return is_periodic(h) and any(_meets(h, item, axes) for item in lines)


def _meets(h: Hypothesis, item: Unknown, axes: RecordAxes) -> bool:
    where = item.coordinate
    in_time = shown_Hz(h, axes)
    if item.unknown_class == "angle":
        _, first = _coordinate_of(item, axes)
        shows = orders_of(h, radius_at(h, axes)) if h.location == where["roll"] else []
    elif item.unknown_class == "time":
        first, shows = float(where["frequency_Hz"]), [] if in_time is None else [in_time]
    else:
        first = float(where["wavenumber_1_m"])
        shows = [] if h.location == "all" else wavenumbers_1_m(h, axes)
    ratios = [at / first for at in shows]
    return any(
        1 <= round(r) <= FREE_TERMS.harmonics[item.unknown_class]
        and abs(r / round(r) - 1.0) < CRITERIA.spectra.same_coordinate_share
        for r in ratios
    )


def _highest(item: Unknown, coordinate: Array, axes: RecordAxes) -> float:
    """Return up to where a line's harmonics are taken up, cycles per unit of ``coordinate``."""
    if item.unknown_class == "angle":
        return highest_order(coordinate, axes)
    return 0.5 / axes.sample_time_s / float(np.max(rates_Hz(coordinate, axes)))


def _coordinate_of(item: Unknown, axes: RecordAxes) -> tuple[Array, float]:
    """Return a coordinate (samples,), in s, m or turns, and the fundamental in cycles per unit."""
    where = item.coordinate
    if item.unknown_class == "time":
        return axes.time_s, float(where["frequency_Hz"])
    if item.unknown_class == "travel":
        return axes.travel_m, float(where["wavenumber_1_m"])
    names = [r.name for r in axes.declaration.rollers]
    turns: Array = axes.angles_rad[names.index(str(where["roll"]))] / TWO_PI
    order = float(where["order"])
    off_cycles = abs(order - round(order)) * float(np.ptp(turns))
    among = round(order) <= FREE_TERMS.harmonics[item.unknown_class]
    return turns, 1.0 if among and off_cycles < 0.5 * FREE_TERMS.half_waves else order
