"""The life of every alarm (ISA-18.2): when it came, who has seen it, whether it is over.

Acknowledging and shelving are of this screen: they move nothing and arm nothing. What cannot be
known, because the service is not heard, is neither begun nor ended.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from aff_hmi.condition import Condition
from aff_hmi.see.alarm import Alarm, Follower, Leader, Life
from aff_runtime.app.report.alarm_table import EVENTS, PRIORITIES
from aff_runtime.base.events import BY_CODE, Reaction
from aff_runtime.base.ports import Clock

CHATTER_NS = 60_000_000_000
TOGETHER_NS = 2_000_000_000
LATE_NS = 1_000_000_000  # of a look that still shows a correction which has begun to fade
TEN_MIN_NS = 600_000_000_000
DAY_NS = 86_400_000_000_000
FLOOD = 10  # in ten minutes: more than a person can follow (EEMUA 191)
MOST = 64
MOST_EVENTS = 200
MOST_MINUTES = 480
HIGH = 1
_S = 1e-9


class Refusal(StrEnum):
    """Why an alarm is not acknowledged or shelved."""

    UNKNOWN = "unknown"
    HIGH = "high"


@dataclass(frozen=True, slots=True, kw_only=True)
class Load:
    """How many alarms came: in ten minutes, and in a day (or since the start) by rank."""

    ten_minutes: int
    day: tuple[int, int, int]

    @property
    def is_flood(self) -> bool:
        """Whether it is more than a person can follow."""
        return self.ten_minutes > FLOOD


class AlarmBook:
    """Keeps the alarms of one line.

    Parameters
    ----------
    wall : returns wall time, s since 1970.
    can_be_seen : whether somebody can acknowledge here; else what is over leaves by itself.
    """

    def __init__(self, clock: Clock, wall: Callable[[], float], *, can_be_seen: bool) -> None:
        self._clock = clock
        self._wall = wall
        self._can_be_seen = can_be_seen
        self._alarms: dict[str, Alarm] = {}
        self._pending: dict[str, int] = {}
        self._left: dict[str, tuple[int, int]] = {}
        self._events: deque[tuple[int, int, int]] = deque(maxlen=MOST_EVENTS)
        self._came: deque[tuple[int, int]] = deque(maxlen=10_000)
        self._active_ns: int | None = None

    def hear(self, events: Sequence[tuple[float, ...]]) -> None:
        """Take events of the ring, (tick, monotonic ns, code, argument) in order."""
        self._events.extend((int(t_ns), int(code), int(tick)) for tick, t_ns, code, _ in events)

    def look(
        self, conditions: Sequence[Condition], *, is_known: bool, is_active: bool = False
    ) -> None:
        """Compare with what stands now.

        Parameters
        ----------
        is_known : whether ``conditions`` are all that there is; while the service is not heard
            they are not, and nothing ends.
        is_active : whether a correction goes out.
        """
        now_ns = self._clock.now_ns()
        if is_active:
            self._active_ns = now_ns
        standing = {one.key: one for one in conditions}
        for key, one in standing.items():
            self._stand(key, one, now_ns)
        for key in [key for key in self._pending if key not in standing]:
            del self._pending[key]
        for key, alarm in list(self._alarms.items()):
            if key not in standing and is_known and alarm.gone_s is None:
                alarm.gone_s = self._wall()
            if alarm.shelved_until_ns and now_ns >= alarm.shelved_until_ns:
                self._unshelve(alarm)
            if alarm.gone_s is not None and not alarm.shelved_until_ns:
                self._let_go(key, alarm, now_ns)
        self._left = {k: v for k, v in self._left.items() if now_ns - v[0] < CHATTER_NS}

    def shown(self) -> list[Alarm]:
        """Return all lines: the most urgent first, what is over behind, shelved ones last."""
        behind = {Life.SHELVED: 2, Life.GONE: 1}
        return sorted(
            self._alarms.values(),
            key=lambda a: (behind.get(a.life, 0), a.condition.rank, not a.is_first, -a.came_ns),
        )

    @property
    def is_loud(self) -> bool:
        """Whether an alarm of high priority stands that nobody has seen."""
        alarms = self._alarms.values()
        return any(a.condition.rank == HIGH and a.life is Life.ACTIVE for a in alarms)

    @property
    def standing(self) -> dict[str, str]:
        """Names of the alarms that are not over, by their keys."""
        there = ((key, one) for key, one in self._alarms.items() if one.gone_s is None)
        return {key: one.condition.name for key, one in there}

    def settled(self) -> list[Alarm]:
        """Return what took the correction out and has told since the last call all that came."""
        now_ns = self._clock.now_ns()
        found = [
            alarm
            for alarm in self._alarms.values()
            if alarm.is_first and not alarm.is_settled and now_ns - alarm.came_ns > TOGETHER_NS
        ]
        for alarm in found:
            self._mark_first(alarm)
            alarm.is_settled = True
        return found

    def load(self) -> Load:
        """Return how many came."""
        now_ns = self._clock.now_ns()
        recent = [rank for came_ns, rank in self._came if now_ns - came_ns < TEN_MIN_NS]
        day = Counter(rank for came_ns, rank in self._came if now_ns - came_ns < DAY_NS)
        return Load(ten_minutes=len(recent), day=(day[1], day[2], day[3]))

    # --- what a person does -----------------------------------------------------------------

    def acknowledge(self, key: str, who: str) -> Refusal | None:
        """Note that somebody has seen an alarm; what is over leaves the book."""
        alarm = self._alarms.get(key)
        if alarm is None:
            return Refusal.UNKNOWN
        alarm.seen_by = who
        if alarm.gone_s is not None and not alarm.shelved_until_ns:
            self._let_go(key, alarm, self._clock.now_ns())
        return None

    def shelve(self, key: str, who: str, minutes: int, reason: str) -> Refusal | None:
        """Put an alarm aside for a while, ``MOST_MINUTES`` at most; 0 takes it back."""
        alarm = self._alarms.get(key)
        if alarm is None:
            return Refusal.UNKNOWN
        if minutes <= 0:
            self._unshelve(alarm)
            return None
        if alarm.condition.rank == HIGH:
            return Refusal.HIGH
        minutes = min(minutes, MOST_MINUTES)
        alarm.shelved_until_ns = self._clock.now_ns() + minutes * 60_000_000_000
        alarm.shelved_by, alarm.reason = who, reason
        return None

    # --- one alarm --------------------------------------------------------------------------

    def _stand(self, key: str, one: Condition, now_ns: int) -> None:
        alarm = self._alarms.get(key)
        if alarm is not None and alarm.gone_s is None:
            alarm.condition = _as_named(one, alarm.condition)
            self._mark_first(alarm)
            return
        since_ns = self._pending.setdefault(key, now_ns)
        if (now_ns - since_ns) * _S < one.delay_s:
            return
        del self._pending[key]
        times = 1
        if alarm is not None:  # over, not seen yet, and here again
            times = alarm.times + 1
        elif key in self._left:
            times = self._left.pop(key)[1] + 1
        at = self._event_of(one)
        came_ns = at[0] if at is not None else since_ns
        fresh = Alarm(
            condition=one,
            since_s=self._wall() - (now_ns - came_ns) * _S,
            came_ns=came_ns,
            tick=at[2] if at is not None else None,
            times=times,
        )
        if alarm is not None and alarm.shelved_until_ns:
            fresh.shelved_until_ns = alarm.shelved_until_ns
            fresh.shelved_by, fresh.reason = alarm.shelved_by, alarm.reason
        self._alarms[key] = fresh
        self._mark_first(fresh)
        if not fresh.shelved_until_ns:
            self._came.append((now_ns, one.rank))
        self._bound()

    def _event_of(self, one: Condition) -> tuple[int, int, int] | None:
        """Return the newest event that a condition is; None for what is none."""
        return next((e for e in reversed(self._events) if one.code and e[1] == one.code), None)

    def _mark_first(self, alarm: Alarm) -> None:
        """Note what came within two seconds of the event that took the correction out.

        Once they are over it stays: a flood of events afterwards takes nothing away.
        """
        if alarm.is_settled:
            return
        event = BY_CODE.get(alarm.condition.code) if alarm.condition.code else None
        alarm.is_first = event is not None and event.reaction is Reaction.FADE_AND_LATCH
        if not alarm.is_first or alarm.tick is None:
            return
        alarm.led_by = self._leader_of(alarm)
        followers: dict[str, float] = {}
        for t_ns, code, _ in self._events:
            name = BY_CODE[code].name if code in BY_CODE else ""
            is_other = code != alarm.condition.code and name in PRIORITIES
            if is_other and 0 <= t_ns - alarm.came_ns <= TOGETHER_NS:
                followers.setdefault(name, (t_ns - alarm.came_ns) * _S)
        alarm.followers = tuple(Follower(name=n, after_s=s) for n, s in followers.items())

    def _leader_of(self, alarm: Alarm) -> Leader | None:
        """Return what took the correction out before, unless it went out again meanwhile."""
        for t_ns, code, tick in reversed(self._events):
            event = BY_CODE.get(code)
            if event is None or event.name not in EVENTS or t_ns >= alarm.came_ns:
                continue
            if event.reaction not in (Reaction.FADE, Reaction.FADE_AND_LATCH):
                continue
            if self._active_ns is not None and self._active_ns - t_ns > LATE_NS:
                return None
            return Leader(name=event.name, before_s=(alarm.came_ns - t_ns) * _S, tick=tick)
        return None

    def _let_go(self, key: str, alarm: Alarm, now_ns: int) -> None:
        if alarm.seen_by or not self._can_be_seen:
            del self._alarms[key]
            self._left[key] = (now_ns, alarm.times)

    @staticmethod
    def _unshelve(alarm: Alarm) -> None:
        alarm.shelved_until_ns, alarm.shelved_by, alarm.reason = 0, "", ""

    def _bound(self) -> None:
        """Keep ``MOST`` lines: the oldest of those that are over go first."""
        while len(self._alarms) > MOST:
            over = [k for k, a in self._alarms.items() if a.gone_s is not None]
            del self._alarms[(over or list(self._alarms))[0]]


def _as_named(now: Condition, before: Condition) -> Condition:
    """Return a condition with the signal that was named of it, also when that is over."""
    is_known = before.name.startswith(f"{now.name} (")
    return replace(now, name=before.name) if is_known else now
