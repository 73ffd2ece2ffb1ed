"""Fades a law in and out with the line's speed, and a roll with what is known of its angle."""

from __future__ import annotations

RAMP_S = 0.5  # from closed to open
ANGLE_FADE_S = 0.3
"""From 1 to 0 without an angle: soon, for then every correction is wrong at once."""
HYSTERESIS = 1.2  # speed at which it opens over that at which it closes


class SpeedGate:
    """``share`` goes to 1 above 1.2 times the threshold and to 0 below it, within half a second.

    Near standstill an adaptive block becomes a DC integrator against the tension loop, hence the
    gate; a speed that is not a number closes it. ``opened``: where the share goes; ``moving``: it
    changed in this tick.
    """

    __slots__ = ("_threshold_m_s", "moving", "opened", "share")

    def __init__(self, active_above_m_s: float) -> None:
        self._threshold_m_s = active_above_m_s
        self.opened = False
        self.share = 0.0
        self.moving = False

    def step(self, speed_m_s: float, dt_s: float) -> float:
        """Return the share of the output that may go out, 0..1."""
        speed = abs(speed_m_s)
        if speed > HYSTERESIS * self._threshold_m_s:
            self.opened = True
        elif not speed >= self._threshold_m_s:
            self.opened = False
        before = self.share
        change = dt_s / RAMP_S
        self.share = min(1.0, before + change) if self.opened else max(0.0, before - change)
        self.moving = self.share != before
        return self.share


class AngleGate:
    """``share`` of what one roll sends: to 0 while its angle is lost, and back once it is known.

    A predicted angle still counts: a few missing readings change nothing. ``moving``: it changed
    in this tick.
    """

    __slots__ = ("moving", "share")

    def __init__(self) -> None:
        self.share = 0.0
        self.moving = False

    def step(self, known: bool, sends: bool, dt_s: float) -> None:
        """Advance; a roll with nothing learned ``sends`` nothing, and has nothing to fade."""
        wanted = 1.0 if known else 0.0
        self.moving = sends and self.share != wanted
        if self.moving:
            change = dt_s / ANGLE_FADE_S
            change = change if known else -change
            self.share = min(1.0, max(0.0, self.share + change))
        else:
            self.share = wanted
