"""Fades a law in and out with the speed of the line."""

from __future__ import annotations

RAMP_S = 0.5  # from closed to open
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
