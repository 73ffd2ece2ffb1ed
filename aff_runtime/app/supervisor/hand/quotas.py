"""How much of one user is heard, and how much of that is put on record line by line."""

from __future__ import annotations

from collections.abc import Iterator

from aff_runtime.app.hand.bucket import Bucket
from aff_runtime.base.ports import Clock

MOST_ACCOUNTS = 64
OTHERS = "other accounts"


class Quota:
    """How many lines are written; what is left out is counted, and told in a line.

    Parameters
    ----------
    per_s, burst : as of the `Bucket`. ``whose`` : what is counted, and of whom, in that line.
    in_all : of this quota and others together.
    """

    def __init__(
        self,
        clock: Clock,
        *,
        per_s: float,
        burst: float,
        whose: str = "",
        in_all: Bucket | None = None,
    ) -> None:
        self._bucket = Bucket(clock, per_s=per_s, burst=burst)
        self._in_all = in_all
        self._left_out = 0
        self._whose = whose

    def take(self) -> bool:
        """Return whether one more line may be written; it is counted when not."""
        if self._has_room():
            return True
        self.leave_out()
        return False

    def leave_out(self) -> None:
        """Count what is not written."""
        self._left_out += 1

    def told(self, uid: int, *, at_end: bool = False) -> str:
        """Return the sentence of what was left out, once there is room for it; else nothing.

        At the end it is said without room, or it never would be.
        """
        if not self._left_out or not (at_end or self._has_room()):
            return ""
        count, self._left_out = self._left_out, 0
        return f"{count} more{self._whose} of uid {uid}, not written one by one"

    @property
    def is_untouched(self) -> bool:
        """Whether it is as if it were new."""
        return not self._left_out and self._bucket.is_full

    def _has_room(self) -> bool:
        return self._bucket.take() and (self._in_all is None or self._in_all.take())


class Shares:
    """Lines of one kind, a share for each account: a flood of one takes no line of another's.

    The account is what the screen claims. Of more than ``MOST_ACCOUNTS`` names those that are new
    have one share.

    Parameters
    ----------
    per_s, burst : of one account. ``in_all`` : of all. ``kind`` : what is counted.
    """

    def __init__(
        self, clock: Clock, *, per_s: float, burst: float, in_all: Bucket, kind: str = ""
    ) -> None:
        self._clock = clock
        self._per_s, self._burst = per_s, burst
        self._in_all = in_all
        self._kind = kind
        self._of: dict[str, Quota] = {}

    def of(self, account: str) -> Quota:
        """Return the share of an account; empty is of packets that name none."""
        if account not in self._of and len(self._of) >= MOST_ACCOUNTS:
            self._of = {name: one for name, one in self._of.items() if not one.is_untouched}
            account = account if len(self._of) < MOST_ACCOUNTS else OTHERS
        if account not in self._of:
            self._of[account] = Quota(
                self._clock,
                per_s=self._per_s,
                burst=self._burst,
                whose=f"{self._kind} of {account}," if account else self._kind,
                in_all=self._in_all,
            )
        return self._of[account]

    def told(self, uid: int, *, at_end: bool = False) -> Iterator[str]:
        """Return the sentences of what was left out, of those for which there is room."""
        for quota in self._of.values():
            if why := quota.told(uid, at_end=at_end):
                yield why


class Limits:
    """How much of one user is heard, and how much of that is written line by line.

    What is written for long, 0.16 lines/s and three for each of 0.2 arms/s, is 30 MB a day: the
    audit reaches back for two days at the worst. Refused logins are of strangers, whoever's screen
    they come through: they take no place of those who have one.
    """

    def __init__(self, clock: Clock) -> None:
        self.packets = Bucket(clock, per_s=50.0, burst=100.0)
        self.commands = Bucket(clock, per_s=0.2, burst=10.0)
        self.bypasses = Bucket(clock, per_s=10.0, burst=10.0)
        in_all = Bucket(clock, per_s=0.08, burst=300.0)
        self.lines = Shares(clock, per_s=0.03, burst=60.0, in_all=in_all)
        in_all = Bucket(clock, per_s=0.03, burst=100.0)
        self.logins = Shares(clock, per_s=0.01, burst=20.0, in_all=in_all, kind=" logins")
        in_all = Bucket(clock, per_s=0.03, burst=100.0)
        self.presses = Shares(
            clock, per_s=0.01, burst=20.0, in_all=in_all, kind=" refused presses"
        )
        self.strangers = Quota(clock, per_s=0.02, burst=20.0, whose=" refused logins")

    def told(self, uid: int, *, at_end: bool = False) -> Iterator[str]:
        """Return the sentences of what was left out."""
        for shares in (self.lines, self.logins, self.presses):
            yield from shares.told(uid, at_end=at_end)
        if why := self.strangers.told(uid, at_end=at_end):
            yield why
