"""When will orders of two rolls meet? Foretold from how a roll's radius shrinks with the web."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.report.status_answer import ComingMeeting
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.config.meetings import Meeting, meetings_of
from aff_runtime.config.models import Site

EVERY_S = 1.0  # between two readings, at least
KEPT = 120  # readings: two minutes
LEAST = 10  # readings before a slope counts
GAP_S = 5.0  # between two readings: after a longer one the track begins anew
JUMP_SHARE = 0.01  # of the radius, between two readings: another roll
SIGMAS = 4.0  # slope over its standard error: below, it may be noise
STANDSTILL_M_S = 0.01
FORESEEN_S = 86_400.0  # no roll lasts longer: a slope that says so is rounding


class RadiusTrack:
    """The radius over the web that has passed; R^2 falls by h/pi per metre of a web h thick."""

    def __init__(self) -> None:
        self._web_m = 0.0
        self._seen: deque[tuple[float, float]] = deque(maxlen=KEPT)

    def step(self, radius_m: float, speed_m_s: float, elapsed_s: float) -> None:
        """Take one reading; a jump (another roll), a gap or a reading that is none begins anew."""
        known = radius_m > 0.0 and math.isfinite(speed_m_s) and 0.0 < elapsed_s <= GAP_S
        last = math.sqrt(self._seen[-1][1]) if self._seen else radius_m
        if not known or abs(radius_m - last) > JUMP_SHARE * last:
            self._seen.clear()
        if radius_m > 0.0:
            self._web_m += speed_m_s * elapsed_s if known else 0.0
            self._seen.append((self._web_m, radius_m * radius_m))

    def slope_m(self) -> float:
        """Return d(R^2)/d(web), m; NaN until it is SIGMAS standard errors off zero."""
        if len(self._seen) < LEAST:
            return math.nan
        web, square = np.array(self._seen).T
        web = web - web.mean()
        spread = float(web @ web)
        if not spread > 0.0:
            return math.nan
        slope = float(web @ square) / spread
        residual = square - square.mean() - slope * web
        error = math.sqrt(float(residual @ residual) / (len(web) - 2) / spread)
        return slope if abs(slope) > SIGMAS * error else math.nan


class MeetingForecast:
    """Follows the radii of the rolls and says which orders meet next, and when."""

    def __init__(self) -> None:
        self._config_hash = ""
        self._site: Site | None = None
        self._meetings: dict[str, tuple[Meeting, ...]] = {}
        self._tracks: dict[str, RadiusTrack] = {}
        self._latest = TickRow({})

    def step(self, parameters: ParameterRecord, latest: TickRow | None) -> None:
        """Look at the newest record of the ring, once a second.

        ``parameters`` is the parameter record in force.
        """
        if latest is None or not latest.is_fresh:
            return
        elapsed_s = latest.time_s - self._latest.time_s  # NaN at first
        if 0.0 <= elapsed_s < EVERY_S:
            return
        self._latest = latest
        self._follow(parameters)
        if self._site is None:
            return
        speed_m_s = latest.number(self._site.line.speed)
        for name, track in self._tracks.items():
            radius_m = latest.number(self._site.rolls[name].radius)
            track.step(radius_m, speed_m_s, elapsed_s)

    def _follow(self, parameters: ParameterRecord) -> None:
        if self._config_hash == parameters.config_hash:
            return
        self._config_hash = parameters.config_hash
        site = self._site = parameters.site
        self._meetings = {
            name: tuple(one for one in meetings_of(site, actuator) if not one.always)
            for name, actuator in site.actuators.items()
        }
        moving = {one.roll for found in self._meetings.values() for one in found}
        self._tracks = {name: self._tracks.get(name, RadiusTrack()) for name in moving}

    def meetings(self) -> tuple[ComingMeeting, ...]:
        """Return the next meeting of every actuator; empty while no slope stands out."""
        return tuple(_coming(name, time_s, one) for name, time_s, one in self._next())

    def sentences(self) -> list[str]:
        """Return the same in words."""
        return [f"{name}: in about {_duration(t)} {one}" for name, t, one in self._next()]

    def _next(self) -> list[tuple[str, float, Meeting]]:
        """Return the next meeting of every actuator with the time to it, s."""
        if self._site is None:
            return []
        speed_m_s = self._latest.number(self._site.line.speed)
        found = []
        for name, meetings in self._meetings.items():
            timed = [(self._time_s(one, speed_m_s), one) for one in meetings]
            ahead = [(time_s, one) for time_s, one in timed if 0.0 < time_s < FORESEEN_S]
            if ahead:
                found.append((name, *min(ahead, key=lambda pair: pair[0])))
        return found

    def _time_s(self, meeting: Meeting, speed_m_s: float) -> float:
        """Return the time to a meeting at this speed, s; negative: behind, NaN: not known."""
        assert self._site is not None
        radius_m = self._latest.number(self._site.rolls[meeting.roll].radius)
        slope_m = self._tracks[meeting.roll].slope_m()
        if not abs(speed_m_s) > STANDSTILL_M_S:
            return math.nan
        return (meeting.radius_m**2 - radius_m**2) / (slope_m * speed_m_s)


def _coming(actuator: str, time_s: float, meeting: Meeting) -> ComingMeeting:
    return ComingMeeting(
        actuator=actuator,
        time_s=time_s,
        roll=meeting.roll,
        order=meeting.order,
        other_roll=meeting.other_roll,
        other_order=meeting.other_order,
        radius_m=meeting.radius_m,
    )


def _duration(time_s: float) -> str:
    """Return a time as an operator says it."""
    if time_s < 90.0:
        return f"{max(1.0, round(time_s / 10.0)) * 10:.0f} s"
    return f"{time_s / 60.0:.0f} min"
