"""Who has logged in, for how long, and which one session has the hand. Time is an argument."""

from __future__ import annotations

import hashlib
import secrets
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

from aff_runtime.app.hand.accounts import Account, Accounts
from aff_runtime.app.hand.bucket import Bucket
from aff_runtime.app.hand.may import Person, Place, Role
from aff_runtime.base.clock import wall_time_s
from aff_runtime.base.ports import Clock

MINUTE_NS = 60_000_000_000
LASTS_NS = 12 * 60 * MINUTE_NS
"""A session ends so long after its login, whatever is pressed."""
IDLE_NS = {Role.VIEW: LASTS_NS, Role.OPERATE: 60 * MINUTE_NS, Role.COMMISSION: 15 * MINUTE_NS}
"""Without a press a session may only look and bypass, by the role of its account."""
HAND_NS = 15 * MINUTE_NS
"""Without a press the hand is let go."""
MAX_SESSIONS = 32


@dataclass(slots=True, kw_only=True, eq=False, weakref_slot=True)
class Session:
    """One login.

    Attributes
    ----------
    csrf : what a page of this session says with every press but bypass.
    pressed_ns : when something was last pressed. ``lost_to`` : who took its hand over.
    number : by which people tell it from others; it opens nothing.
    presses : how many more it may press now; a bypass does not count.
    """

    account: Account
    place: Place
    begun_ns: int
    pressed_ns: int
    presses: Bucket
    lost_to: str = ""
    number: int = 0
    csrf: str = field(default_factory=lambda: secrets.token_urlsafe(32))


@dataclass(frozen=True, slots=True, kw_only=True)
class Holder:
    """The session that has the hand, since when: monotonic, and wall time in s since 1970."""

    session: Session
    since_ns: int
    since_s: float


class Sessions:
    """All sessions of this screen; they end with it, with time, and with their account.

    Parameters
    ----------
    wall : returns wall time, s since 1970.
    told : called with a notice and a session when one ends, or its hand, without a press.
    """

    def __init__(
        self,
        accounts: Accounts,
        clock: Clock,
        told: Callable[[str, Session], None] = lambda what, session: None,
        wall: Callable[[], float] = wall_time_s,
    ) -> None:
        self._wall = wall
        self._accounts = accounts
        self._clock = clock
        self._told = told
        self._sessions: dict[str, Session] = {}
        self._holder: Holder | None = None
        self._begun = 0

    def begin(self, account: Account, place: Place) -> str:
        """Return the token of a new session; nothing but its hash is kept."""
        now_ns = self._clock.now_ns()
        self.sweep()
        while len(self._sessions) >= MAX_SESSIONS:
            self._drop(self._oldest_of_most(), "session ended")
        token = secrets.token_urlsafe(32)
        self._begun += 1
        session = Session(
            number=self._begun,
            account=account,
            place=place,
            begun_ns=now_ns,
            pressed_ns=now_ns,
            presses=Bucket(self._clock, per_s=5.0, burst=10.0),
        )
        self._sessions[_key(token)] = session
        return token

    def find(self, token: str, place: Place) -> Session | None:
        """Return the session of a token; None when there is none any more, or not from there."""
        found = self._live(_key(token)) if token else None
        return found if found is not None and found.place is place else None

    def end(self, token: str) -> None:
        """End a session, its hand too."""
        self._drop(_key(token))

    def all(self) -> tuple[Session, ...]:
        """Return every session, the oldest first."""
        live = [self._live(key) for key in list(self._sessions)]
        return tuple(one for one in live if one is not None)

    def end_session(self, session: Session) -> None:
        """End a session that somebody else looks at, its hand too."""
        for key, one in list(self._sessions.items()):
            if one is session:
                self._drop(key)

    def sweep(self) -> None:
        """End what time or a changed account has ended."""
        self.holder()
        for key in list(self._sessions):
            self._live(key)

    def by_role(self) -> Counter[str]:
        """Return how many sessions there are of every role."""
        found = Counter({role.word: 0 for role in Role})
        live = [self._live(key) for key in list(self._sessions)]
        found.update(one.account.role.word for one in live if one is not None)
        return found

    def press(self, session: Session) -> None:
        """Note that somebody is there, unless the session waits for another login."""
        if not self.is_idle(session):
            session.pressed_ns = self._clock.now_ns()
            session.lost_to = ""

    def is_idle(self, session: Session) -> bool:
        """Return whether nothing was pressed for too long: then it may look and bypass."""
        return self._clock.now_ns() - session.pressed_ns > IDLE_NS[session.account.role]

    # --- the hand ---------------------------------------------------------------------------

    def holder(self) -> Holder | None:
        """Return who has the hand; it ends with its session, and when nothing is pressed."""
        held = self._holder
        if held is not None:
            idle_ns = self._clock.now_ns() - held.session.pressed_ns
            is_there = held.session in self._sessions.values() and not self.is_idle(held.session)
            if not is_there or idle_ns > HAND_NS or not self._is_live(held.session):
                self._lose(held)
        return self._holder

    def take(self, session: Session) -> str:
        """Give the hand to a session; return who had it before, empty for nobody else."""
        held = self.holder()
        if held is not None and held.session is session:
            return ""
        self._holder = Holder(
            session=session, since_ns=self._clock.now_ns(), since_s=round(self._wall(), 1)
        )
        if held is None:
            return ""
        held.session.lost_to = session.account.name
        return held.session.account.name

    def release(self, session: Session) -> bool:
        """Let go of the hand; False when it was not this session's."""
        held = self.holder()
        if held is None or held.session is not session:
            return False
        self._holder = None
        return True

    def person(self, session: Session | None, place: Place) -> Person:
        """Return who asks, for ``may``."""
        if session is None:
            return Person(role=None, place=place)
        held = self.holder()
        return Person(
            role=session.account.role,
            place=place,
            has_hand=held is not None and held.session is session,
            is_idle=self.is_idle(session),
        )

    # --- inside -----------------------------------------------------------------------------

    def _live(self, key: str) -> Session | None:
        session = self._sessions.get(key)
        if session is not None and not self._is_live(session):
            self._drop(key, "session ended")
            return None
        return session

    def _is_live(self, session: Session) -> bool:
        """Return whether its time is not over and its account is what it was at the login."""
        is_young = self._clock.now_ns() - session.begun_ns <= LASTS_NS
        return is_young and self._accounts.find(session.account.name) == session.account

    def _oldest_of_most(self) -> str:
        """Return the oldest session of the account with most, so that none drives out others."""
        count = Counter(one.account.name for one in self._sessions.values())
        name, _ = count.most_common(1)[0]
        return next(key for key, one in self._sessions.items() if one.account.name == name)

    def _drop(self, key: str, notice: str = "") -> None:
        session = self._sessions.pop(key, None)
        if session is None:
            return
        if self._holder is not None and self._holder.session is session:
            self._lose(self._holder)
        if notice:
            self._told(notice, session)

    def _lose(self, held: Holder) -> None:
        self._holder = None
        self._told("hand ended", held.session)


def _key(token: str) -> str:
    return hashlib.sha256(token.encode("utf-8", "replace")).hexdigest()
