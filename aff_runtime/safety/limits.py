"""Bounds of one output: scale the whole correction so that a sine stays a sine."""

from __future__ import annotations

from math import isfinite

from aff_runtime.base.signals import ActuatorStep
from aff_runtime.safety.params import ActuatorLimits

SLEW_SHARE = 0.95  # of the slew limit to the sines; the rest is for envelope and scale in motion
SCALE_DOWN_PER_S = 10.0  # fastest fall of the scale, which is 0 to 1
SCALE_UP_PER_S = 0.5  # its fastest rise
_SATURATED_BELOW = 1.0 - 1e-6  # a scale below is that of a limit, not of rounding


class Limiter:
    """Scales, then bounds, one output.

    The scale follows min(1, limit / peak_bound, 0.95 slew_limit / slew_bound) at a bounded rate,
    so it never steps. Behind it stand two last resorts that never act in normal operation: the
    change per tick stays within slew_limit dt, and |u| within limit times envelope. The second
    one wins, hence zero after the fade whatever the slew limit; it moves at most
    (pi / 2) limit / fade_s.

    Attributes
    ----------
    output : the correction that went out last, in the actuator's SI unit.
    scale : smoothed scale in force; ``wanted_scale`` without smoothing, for the law's projection.
    limit : bound in force; moves to a new setting within one fade time.
    saturated : True while the scale is below one.
    """

    def __init__(self, bounds: ActuatorLimits, fade_s: float) -> None:
        self.bounds = bounds
        self.limit = bounds.limit
        self.output = 0.0
        self.scale = 1.0
        self.wanted_scale = 1.0
        self._limit_rate = bounds.limit / fade_s
        self._fade_s = fade_s

    def adopt(self, bounds: ActuatorLimits, fade_s: float) -> None:
        """Take new bounds; the limit in force moves there within ``fade_s``."""
        self._limit_rate = max(bounds.limit, self.limit) / fade_s
        self._fade_s = fade_s
        self.bounds = bounds

    @property
    def saturated(self) -> bool:
        """Whether the law wants more than the limits give."""
        return self.scale < _SATURATED_BELOW or self.wanted_scale < _SATURATED_BELOW

    @property
    def headroom(self) -> tuple[float, float]:
        """Largest ``peak_bound`` and ``slew_bound`` of a wish that goes out unscaled."""
        return self.limit, SLEW_SHARE * self.bounds.slew_limit

    def step(self, wanted: ActuatorStep | None, envelope: float, dt_s: float) -> None:
        """Advance ``output`` by ``dt_s`` towards a wish that makes sense; None asks for zero."""
        self.limit = _towards(self.limit, self.bounds.limit, self._limit_rate * dt_s)
        target = 0.0
        if wanted is not None:
            self._follow_scale(wanted, dt_s)
            target = wanted.value * self.scale * envelope
        self.output = _bounded(
            target,
            previous=self.output,
            reach=self.bounds.slew_limit * dt_s,
            ceiling=self.limit * envelope,
        )

    def _follow_scale(self, wanted: ActuatorStep, dt_s: float) -> None:
        peak = max(wanted.peak_bound, abs(wanted.value))
        scale = 1.0
        if peak > self.limit:
            scale = self.limit / peak
        slew_room = SLEW_SHARE * self.bounds.slew_limit
        if wanted.slew_bound * scale > slew_room:
            scale = slew_room / wanted.slew_bound
        self.wanted_scale = scale
        rate = SCALE_UP_PER_S if scale > self.scale else SCALE_DOWN_PER_S
        self.scale = _towards(self.scale, scale, rate * dt_s)


def makes_sense(step: ActuatorStep) -> bool:
    """Return whether value and bounds of ``step`` are finite and the bounds not negative."""
    return (
        isfinite(step.value)
        and isfinite(step.peak_bound)
        and isfinite(step.slew_bound)
        and step.peak_bound >= 0.0
        and step.slew_bound >= 0.0
    )


def _within(low: float, value: float, high: float) -> float:
    """Return max(low, min(high, value)) without their calls, which cost more than all the rest."""
    value = value if value < high else high
    return value if value > low else low


def _towards(value: float, target: float, reach: float) -> float:
    return _within(value - reach, target, value + reach)


def _bounded(target: float, *, previous: float, reach: float, ceiling: float) -> float:
    return _within(-ceiling, _towards(previous, target, reach), ceiling)
