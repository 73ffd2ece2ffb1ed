"""How far a roll turned while nothing was read, by its counter before and after."""

from __future__ import annotations

import math

JUMP_RAD = 0.2  # an encoder reading may be off the expected angle by this,
JITTER_S = 0.05  # and by so much motion at the present speed
ORIGIN_SLACK_RAD = 1e-3  # a modulus this close to whole turns is whole turns
GAP_SPEED = 1.2  # speed in a gap, at most, over that before it and that after it
STEADY_SPEED = 1.02  # as that, of a line that went from the one speed to the other
CHANCE = 0.05  # at most, that a counter which began anew is taken for one that went on
NOISE_RAD = 0.02  # a range narrower than twice this, the count of a coarse encoder,
NOISE_S = 0.01  # and so much motion, the age of a reading, holds no reading for sure


def has_whole_turns(modulus_rad: float) -> bool:
    """Return whether an encoder says the same again after whole turns, or never."""
    return abs(math.remainder(modulus_rad, math.tau)) < ORIGIN_SLACK_RAD


def turned_in_gap(
    turned_rad: float,
    modulus_rad: float,
    gap_s: float,
    *,
    speeds_rad_s: tuple[float, float],
    stands_below_rad_s: float,
) -> float:
    """Return how far a roll turned in a gap, rad; NaN where the readings do not tell.

    It may have stood, or gone as before or as now. A counter that began anew (a PLC that was
    restarted) says something else, but for a chance of that range over the modulus: where it is
    too large, a short word, the roll must have stood, or have gone on from the speed before to
    that now. A counter that can have wrapped says nothing, unless it wraps after whole turns: one
    that did not begin anew then says the angle, however often it wrapped.

    Parameters
    ----------
    turned_rad : from the reading before the gap to that after it, but for wraps.
    modulus_rad : after so much the counter starts over; 0 never.
    speeds_rad_s : before the gap, and now. ``stands_below_rad_s`` : a slower roll stands, whatever
        a speed channel reads; NaN when not known.
    """
    before, now = speeds_rad_s
    slow, fast = min(0.0, before, now), max(0.0, before, now)
    speed = max(-slow, fast)
    low, high = _reach(slow, fast, GAP_SPEED * gap_s, gap_s / GAP_SPEED)
    slack = JUMP_RAD + JITTER_S * speed
    if not (has_whole_turns(modulus_rad) or modulus_rad > 2.0 * (max(-low, high) + slack)):
        return math.nan
    widest = CHANCE * (modulus_rad or math.inf)
    if high - low + 2.0 * slack > widest:
        if speed < stands_below_rad_s:
            before = now = 0.0  # the offset of a speed channel is no motion
        slow, fast = min(before, now), max(before, now)
        low, high = _reach(slow, fast, STEADY_SPEED * gap_s, gap_s / STEADY_SPEED)
        slack = min(slack, 0.5 * (widest - (high - low)))
        if slack < NOISE_RAD + NOISE_S * speed:
            return math.nan
    low, high = low - slack, high + slack
    if modulus_rad > 0.0:
        turned_rad += modulus_rad * math.ceil((low - turned_rad) / modulus_rad)
    return turned_rad if low <= turned_rad <= high else math.nan


def _reach(slow: float, fast: float, most_s: float, least_s: float) -> tuple[float, float]:
    """Return how far a roll goes at two speeds, at least and at most, rad."""
    return (slow * (most_s if slow < 0.0 else least_s), fast * (most_s if fast > 0.0 else least_s))
