"""Blocks that meet in frequency share their adaptation gain."""

from __future__ import annotations

from collections.abc import Sequence

BAND_PER_RATE = 2.0  # rad/s per 1/s of both rates: blocks further apart do not share


def gain_share(index: int, omegas_rad_s: Sequence[float], rates_1_s: Sequence[float]) -> float:
    """Return the share (0..1] of its gain that block ``index`` may use.

    Two blocks whose frequencies lie within their adaptation bandwidths act as one block of twice
    the gain. The share is 1 / (1 + sum c_ij); c_ij falls smoothly from 1 at equal frequencies to
    exactly 0 at ``2 (rate_i + rate_j)``, so distant blocks keep the settling time they were given.
    """
    own_omega = omegas_rad_s[index]
    own_rate = rates_1_s[index]
    crowd = 1.0
    for j, (omega, rate) in enumerate(zip(omegas_rad_s, rates_1_s, strict=True)):
        band = BAND_PER_RATE * (own_rate + rate)
        distance = omega - own_omega
        if -band < distance < band and j != index:
            x = abs(distance) / band
            crowd += (1.0 - x) ** 2 * (1.0 + 2.0 * x)
    return 1.0 / crowd
