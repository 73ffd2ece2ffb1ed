"""Stops a line before its unwind roll runs out, as controls do that watch the roll's diameter.

Without it the model would unwind its core, and then less than nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import StrEnum

from sim_plant.base.ports import SteppedLine, WebSupply

SPEED = "line_speed_ref_m_s"
STOP_S = 5.0  # ramp from any speed to rest, and back
RESERVE_m = 3.0  # stays on the core: web that ran off would have to be threaded anew
_LEAST_SPEED_m_s = 0.2  # whose ramp is the slowest there is


class WebState(StrEnum):
    """What the roll's end makes of the line's speed."""

    RUNS = "runs"  # the references are the operator's
    STOPS = "stops"  # on the ramp to rest
    STANDS = "stands"
    STARTS = "starts"  # on the ramp back, with full rolls


class WebEnd:
    """Watches what is left on the unwind roll and takes the speed reference away at its end.

    Attributes
    ----------
    state : see ``WebState``; a line that does not tell what is left always runs.
    observers : called with every new state.
    """

    def __init__(self, line: SteppedLine) -> None:
        self._supply = line if isinstance(line, WebSupply) else None
        self.state = WebState.RUNS
        self.observers: list[Callable[[WebState], None]] = []
        self._speed_m_s = 0.0
        self._rate_m_s2 = 0.0

    @property
    def left_m(self) -> float | None:
        """Return the web left on the unwind roll, m; None when the line does not tell."""
        return None if self._supply is None else self._supply.web_left_m

    @property
    def at_end(self) -> bool:
        """Return whether the line stops or stands because its web is at its end."""
        return self.state in {WebState.STOPS, WebState.STANDS}

    def look(self, speed_ref_m_s: float) -> bool:
        """Begin to stop when no more is left than the ramp and the reserve need; say whether."""
        if self._supply is None or self.state is not WebState.RUNS or not speed_ref_m_s > 0.0:
            return False
        if self._supply.web_left_m > 0.5 * STOP_S * speed_ref_m_s + RESERVE_m:
            return False
        self._speed_m_s = speed_ref_m_s
        self._rate_m_s2 = max(speed_ref_m_s, _LEAST_SPEED_m_s) / STOP_S
        self._enter(WebState.STOPS)
        return True

    def refill(self) -> None:
        """Start the line again if it stops or stands: full rolls are on."""
        if self.at_end:
            self._enter(WebState.STARTS)

    def references(self, wanted: Mapping[str, float], dt_s: float) -> Mapping[str, float]:
        """Return the inputs of the coming sample: ``wanted``, with the ramp's speed on a ramp."""
        if self.state is WebState.RUNS:
            return wanted
        aim_m_s = wanted[SPEED] if self.state is WebState.STARTS else 0.0
        most_m_s, gap_m_s = self._rate_m_s2 * dt_s, aim_m_s - self._speed_m_s
        self._speed_m_s += min(max(gap_m_s, -most_m_s), most_m_s)
        if abs(gap_m_s) <= most_m_s:
            self._speed_m_s = aim_m_s
            if self.state is not WebState.STANDS:
                self._enter(WebState.STANDS if self.at_end else WebState.RUNS)
        return {**wanted, SPEED: self._speed_m_s}

    def _enter(self, state: WebState) -> None:
        self.state = state
        for observer in self.observers:
            observer(state)
