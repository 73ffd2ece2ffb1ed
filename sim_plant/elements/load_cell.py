"""A load-cell roller: mean of its two tensions, filter, resonance, noise, resolution."""

from __future__ import annotations

import math

from sim_plant.base.jit import compiled


@compiled
def filter_rate(corner_Hz: float, input_N: float, output_N: float) -> float:
    """Return d output/dt of the first-order amplifier filter, N/s. Never raises."""
    return 2.0 * math.pi * corner_Hz * (input_N - output_N)


@compiled
def resonance_rates(
    frequency_Hz: float, damping: float, input_N: float, output_N: float, rate_N_s: float
) -> tuple[float, float]:
    """Return the two state rates of a second-order load-cell resonance. Never raises."""
    w = 2.0 * math.pi * frequency_Hz
    return rate_N_s, w * w * (input_N - output_N) - 2.0 * damping * w * rate_N_s


@compiled
def quantise(value: float, lsb: float) -> float:
    """Return ``value`` rounded to a multiple of ``lsb``; unchanged when ``lsb`` is 0."""
    if lsb == 0.0:
        return value
    return lsb * math.floor(value / lsb + 0.5)


@compiled
def expected_quantise(value: float, lsb: float, noise_sd: float) -> float:
    """Return the mean reading of a noisy, quantised signal: what a noise-free run must feed back.

    Equation: E[Q(x + n)] = x + (lsb/pi) sum_k (-1)^k/k exp(-2 (pi k sd/lsb)^2) sin(2 pi k x/lsb),
    two terms (own derivation: Fourier series of the rounding error, each order damped by the
    noise). A speed loop rests where this mean meets its reference, so the bias of a coarse
    encoder shifts the true speed; leaving it out makes angles drift by millirads per second.
    """
    if lsb == 0.0:
        return value
    turn = 2.0 * math.pi * value / lsb
    smooth = 2.0 * (math.pi * noise_sd / lsb) ** 2
    first = -math.exp(-smooth) * math.sin(turn)
    second = 0.5 * math.exp(-4.0 * smooth) * math.sin(2.0 * turn)
    return value + lsb / math.pi * (first + second)
