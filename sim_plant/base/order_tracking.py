"""Ripple by order: least squares on a body's angle, which no speed or radius change smears."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sim_plant.base.arrays import Array


def order_amplitudes(
    signal: Array,
    angle_rad: Array,
    orders: Sequence[int],
    others: Mapping[str, Array] | None = None,
) -> Array:
    """Return the complex amplitude of each order of one body in a signal.

    Parameters
    ----------
    signal : (samples,), any unit; a constant and a linear drift are removed with it.
    angle_rad : (samples,), unwrapped angle of the body.
    orders : the orders wanted, 1 for once per turn.
    others : angles of other bodies whose orders 1-4 are fitted beside these, so that a close
        order of another roll is not counted here.

    Returns
    -------
    complex (orders,): signal = Re sum_n c_n exp(j n angle); |c_n| is the peak amplitude.
    """
    time = np.linspace(-1.0, 1.0, signal.size)
    columns = [np.ones_like(time), time]
    for order in orders:
        columns += [np.cos(order * angle_rad), np.sin(order * angle_rad)]
    for other in (others or {}).values():
        for order in (1, 2, 3, 4):
            columns += [np.cos(order * other), np.sin(order * other)]
    solution = np.linalg.lstsq(np.column_stack(columns), signal, rcond=None)[0]
    pairs = solution[2 : 2 + 2 * len(orders)].reshape(-1, 2)
    return np.asarray(pairs[:, 0] - 1j * pairs[:, 1])


def order_spectrum(
    signal: Array, angle_rad: Array, highest_order: float = 12.0, points_per_turn: int = 64
) -> tuple[Array, Array]:
    """Return orders and amplitudes of a signal resampled to equal angle steps (Hann window)."""
    turns = angle_rad / (2.0 * np.pi)
    count = int((turns[-1] - turns[0]) * points_per_turn)
    grid = turns[0] + np.arange(count) / points_per_turn
    even = np.interp(grid, turns, signal)
    window = np.hanning(count)
    spectrum = np.abs(np.fft.rfft((even - even.mean()) * window)) * 2.0 / window.sum()
    orders = np.fft.rfftfreq(count, 1.0 / points_per_turn)
    keep = orders <= highest_order
    return np.asarray(orders[keep], dtype=np.float64), np.asarray(spectrum[keep])


def reduction_dB(before: float, after: float) -> float:
    """Return 20 log10(before / after); infinite when nothing is left."""
    return float(20.0 * np.log10(before / after)) if after > 0.0 else float("inf")
