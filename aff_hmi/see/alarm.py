"""One alarm as the book keeps it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from aff_hmi.condition import Condition


class Life(StrEnum):
    """Where an alarm stands; ``GONE`` is over and was not seen by anybody yet."""

    ACTIVE = "active"
    SEEN = "seen"
    GONE = "gone"
    SHELVED = "shelved"


@dataclass(frozen=True, slots=True, kw_only=True)
class Follower:
    """An event of the same two seconds as a first-out, ``after_s`` behind it."""

    name: str
    after_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Leader:
    """An event that began to take the correction out ``before_s`` ahead of an alarm."""

    name: str
    before_s: float
    tick: int


@dataclass(slots=True, kw_only=True)
class Alarm:
    """One line of the book.

    Attributes
    ----------
    since_s : wall time of its coming. ``tick`` : of its event; None for what is no event.
    gone_s : wall time of its end; None while it stands.
    times : how often it came in a row, each within a minute of the one before.
    seen_by : who acknowledged it. ``shelved_until_ns`` : 0 when it is not.
    is_first : it is what took the correction out; ``followers`` came with it.
    led_by : what had begun to take it out before, which is no alarm; None: nothing had.
    is_settled : the two seconds are over in which others are told as come with it.
    """

    condition: Condition
    since_s: float
    came_ns: int
    tick: int | None = None
    gone_s: float | None = None
    times: int = 1
    seen_by: str = ""
    shelved_until_ns: int = 0
    shelved_by: str = ""
    reason: str = ""
    is_first: bool = False
    led_by: Leader | None = None
    followers: tuple[Follower, ...] = ()
    is_settled: bool = False

    @property
    def life(self) -> Life:
        """Where it stands."""
        if self.shelved_until_ns:
            return Life.SHELVED
        if self.gone_s is not None:
            return Life.GONE
        return Life.SEEN if self.seen_by else Life.ACTIVE
