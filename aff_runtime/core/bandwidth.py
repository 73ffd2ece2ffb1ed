"""Up to which frequency an order may go out: what the cycle and the drive let through."""

from __future__ import annotations

import math
from dataclasses import dataclass

PASSED = 1.0 / 8.0
"""Share of a correction that a drive must let through. What is wrong with the command (rounding, a
lost tick, noise in the weights) is slow and passes whole: below it, that weighs eight times."""
IMAGE = 0.1
"""The image that the hold leaves, over the order itself: 20 dB."""
FADE_FROM = 0.895
"""Of the frequency from which on an order does not go out: there its fade begins.

The last tenth, so cut that the fade begins at 17.0 Hz on the Euclid line, as the bound of 17 to
19 Hz before it: one row of the control bench moves by a fifth with a tenth of a hertz of it (ADR
0029), and 0.9 would be 17.1 Hz.
"""


SAMPLES_PER_PERIOD = 20.0
"""Of an order that the plain law sends, at least. Our choice, neither derived nor measured.

One cycle is then 18 degrees of the order at most, so that a correction which is up to three cycles
late stays within the 60 degrees at which it helps no more. The plain law knows no drive, so the
cycle alone sets it.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Band:
    """Orders go out whole up to ``full_Hz`` and not at all from ``end_Hz`` on."""

    full_Hz: float
    end_Hz: float


def plain_limit_Hz(cycle_s: float) -> float:
    """Return up to which frequency the plain law sends an order: 10 Hz at a cycle of 5 ms."""
    return 1.0 / (SAMPLES_PER_PERIOD * cycle_s)


def hold_limit_Hz(cycle_s: float) -> float:
    """Return up to which frequency a command under a zero-order hold still stands for its order.

    Derivation. A zero-order hold of T leaves the order f with an image at f' = 1/T - f,
    sin(pi f T)/(pi f T) and sin(pi f' T)/(pi f' T) of it; the two sines are equal, so the image
    is f/f'. The web adds up length, another f/f'; a drive takes off more, a fast one does not.
    (f/f')^2 = 1/10 gives f = 1/(T (1 + sqrt 10)) = 0.24/T. A delay that is half a cycle longer
    or shorter than the measured one, as where the grids of two clocks pass each other, turns the
    phase by pi f T: at most 43 degrees here, within the 60 at which a correction helps no more.
    """
    return 1.0 / (cycle_s * (1.0 + math.sqrt(1.0 / IMAGE)))


def drive_limit_Hz(K_ref_rad_s: float, corner_rad_s: float) -> float:
    """Return up to which frequency a speed loop lets an eighth of its reference through.

    Derivation. A speed v takes the reference v (1 + s^2/(K (s + c))), see ``ShapeBasis``. With
    x = w^2 its square is ((K c - x)^2 + K^2 x) / (K^2 (x + c^2)), equal to 64 where
    x^2 - (2 K c + 63 K^2) x - 63 K^2 c^2 = 0. About 8 K / (2 pi): 19 Hz at 15 rad/s.
    """
    K, c, more = K_ref_rad_s, corner_rad_s, 1.0 / PASSED**2 - 1.0
    half = K * c + 0.5 * more * K * K
    return math.sqrt(half + math.sqrt(half * half + more * (K * c) ** 2)) / math.tau


def band_of(K_ref_rad_s: float, corner_rad_s: float, cycle_s: float) -> Band:
    """Return the band of one actuator, by drive and cycle; its response may allow less."""
    end_Hz = min(hold_limit_Hz(cycle_s), drive_limit_Hz(K_ref_rad_s, corner_rad_s))
    return Band(full_Hz=FADE_FROM * end_Hz, end_Hz=end_Hz)
