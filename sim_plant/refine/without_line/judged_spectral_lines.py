"""What spectral lines are worth: their sizes from the records fitted, put on the record judged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sim_plant.base.arrays import Array
from sim_plant.refine.noise.innovations import whitening_filter
from sim_plant.refine.without_line.free_spectral_lines import SpectralLine, basis, sharpest
from sim_plant.refine.without_line.record_filter import Remainder


def without_spectral_lines(
    items: Sequence[Remainder],
    spectral_lines: Sequence[SpectralLine],
    judged: Remainder,
    *,
    own: bool,
) -> Array:
    """Return what is left of the record judged without the spectral lines (outputs, samples).

    Sizes come from the fitted records, by their speed. A record's own start phase and travel
    scale are found on the record judged, two numbers per spectral line: by chance that saves
    2 / samples of its power for each.

    Parameters
    ----------
    own : the record judged is one of those fitted.
    """
    left = judged.residual.copy()
    white = judged.whitened
    for spectral in spectral_lines:
        here = spectral
        if not own:
            at = sharpest(judged, white, spectral.axis, spectral.frequency)
            here = replace(spectral, frequency=at)
        fitted = _fit(judged, left, here)
        if not own:
            fitted = _known_size(items, spectral, fitted, judged)
        left = left - (basis(judged, here.axis, here.frequency) @ fitted).T
    return left


def _fit(item: Remainder, rows: Array, spectral: SpectralLine) -> Array:
    """Return a spectral line's weights (2 or 4, outputs), by least squares on whitened rows.

    The basis goes through the same whitening filter as the row.
    """
    b = basis(item, spectral.axis, spectral.frequency)
    columns = []
    for row in rows:
        ar_weights, _ = whitening_filter(row[None, :])
        white = np.column_stack(
            [np.convolve(ar_weights, column)[ar_weights.size : row.size] for column in (*b.T, row)]
        )
        columns.append(np.linalg.lstsq(white[:, :-1], white[:, -1], rcond=None)[0])
    return np.stack(columns, axis=1)


def _known_size(
    items: Sequence[Remainder], spectral: SpectralLine, fitted: Array, judged: Remainder
) -> Array:
    """Return this record's phase with the size that the fitted records have at its speed."""
    sizes = []
    for item, frequency in zip(items, spectral.per_record, strict=True):
        alone = _fit(item, item.residual, replace(spectral, frequency=frequency))
        sizes.append(np.abs(_complex(alone)[0]))
    here = _complex(fitted)[0]
    size = _at_speed(items, np.stack(sizes), judged)
    turned = here / np.maximum(np.abs(here), 1e-300) * size
    found = np.zeros_like(fitted)
    found[0], found[1] = turned.real, turned.imag
    return found


def _at_speed(items: Sequence[Remainder], sizes: Array, judged: Remainder) -> Array:
    """Return the size (outputs,) at the judged record's mean speed, between those fitted.

    ``sizes`` is (records, outputs). Outside their speeds the nearest counts; without a speed the
    mean.
    """
    if judged.speed_m_s is None:
        mean: Array = sizes.mean(axis=0)
        return mean
    speeds = np.array([float(np.mean(x.speed_m_s)) for x in items if x.speed_m_s is not None])
    order = np.argsort(speeds)
    at = float(np.mean(judged.speed_m_s))
    return np.array([np.interp(at, speeds[order], column[order]) for column in sizes.T])


def _complex(fitted: Array) -> NDArray[np.complex128]:
    """Return each pair of cosine and sine weights as one complex number (1 or 2, outputs)."""
    return np.stack([fitted[k] + 1j * fitted[k + 1] for k in range(0, fitted.shape[0], 2)])
