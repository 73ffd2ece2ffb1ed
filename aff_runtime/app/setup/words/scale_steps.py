"""Scales that PLC programmers choose: 1, 2, 2.5, 5 by a power of ten, or 1/16, 1/32 and so on."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from aff_runtime.base.units import plain, to_si

# units in which a PLC may count, beside SI and the display's own
_USUAL = {
    "N": ("lbf", "kgf"),
    "m/s": ("m/min", "FPM"),
    "m": ("mm", "in"),
    "rad/s": ("rpm",),
    "N m": ("lbf in", "lbf ft"),
}
_DECADES = 12.0  # over which a scale may lie


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundScale:
    """One scale: ``si`` units per count, ``text`` as a site file writes it, and how usual it is.

    ``log_prior`` : natural logarithm of the share of all scales that are this one.
    """

    si: float
    text: str
    log_prior: float


def round_scales(low: float, high: float, si_unit: str, display: str) -> Iterator[RoundScale]:
    """Yield the round scales from ``low`` to ``high`` SI units per count, 0 < low <= high.

    Parameters
    ----------
    si_unit : of the quantity.
    display : unit in which it is displayed.
    """
    shares = {si_unit: 0.5}  # of PLCs that count in this unit
    for unit in _USUAL.get(si_unit, ()):
        shares.setdefault(unit, 0.08)
    shares[display] = max(shares.get(display, 0.0), 0.35)
    seen: set[int] = set()
    for unit, share in sorted(shares.items(), key=lambda row: -row[1]):
        si_per_unit = to_si(unit)[1]
        for number, prior in _numbers(low / si_per_unit, high / si_per_unit):
            si = number * si_per_unit
            same = round(math.log(si) * 1e9)
            if same in seen:
                continue
            seen.add(same)
            text = plain(number) if unit == si_unit else f"{plain(number)} {unit}"
            exact = si if unit != si_unit else number
            yield RoundScale(si=exact, text=text, log_prior=math.log(share * prior / _DECADES))


def _numbers(low: float, high: float) -> Iterator[tuple[float, float]]:
    """Yield round numbers of a range, each with its share."""
    for exponent in range(math.floor(math.log10(low)) - 1, math.ceil(math.log10(high)) + 1):
        for digit, share in ((1, 0.6), (2, 0.15), (5, 0.15), (25, 0.02)):
            number = float(f"{digit}e{exponent if digit < 10 else exponent - 1}")
            if low <= number <= high:
                yield number, share
    for exponent in range(math.ceil(math.log2(low)), math.floor(math.log2(high)) + 1):
        if exponent < -3:  # 2, 1, 1/2 and 1/4 are among those above; 1/8 and 4 are not tried
            yield 2.0**exponent, 0.02
