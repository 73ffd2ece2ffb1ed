"""The hand of this screen: what one session may do now, and what its page shows of that."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from aff_hmi.objections import LONGEST as LONGEST_REASON
from aff_hmi.press_desk import PressDesk
from aff_hmi.reason import explained
from aff_hmi.refused import RefusedPresses
from aff_hmi.sessions import Session, Sessions
from aff_hmi.watch import Observed
from aff_hmi.words import N_, Say
from aff_runtime.app.hand.accounts import Accounts
from aff_runtime.app.hand.may import (
    WORDS,
    Action,
    Circumstances,
    Code,
    Person,
    Place,
    Reason,
    Role,
    may,
)
from aff_runtime.app.hand.messages import VALID_NS, Notice, Welcome
from aff_runtime.base.clock import wall_time_s
from aff_runtime.base.ports import Clock
from aff_runtime.base.printable import printable
from aff_runtime.base.signals import State

FRESH_S = 0.7
KEPT_MOMENTS = 64
KEPT_TEXTS = 64  # of what sessions are told, while nothing of it changes
SAID_AT_BUTTON = 3  # two of the person, one of the line: what a phone shows in three lines


@dataclass(frozen=True, slots=True, kw_only=True)
class Moment:
    """What a frame showed: its number, when it was made, and the guard's state in it."""

    number: int
    made_ns: int
    state: str


class Hand:
    """Everything beside looking.

    Parameters
    ----------
    bypass_from : the farthest place from which who has not logged in may bypass; None: nowhere.
    wall : returns wall time, s since 1970.

    Attributes
    ----------
    accounts, sessions : who may log in, who has. ``desk`` : the way to the service.
    refused : says to it what this screen refuses itself.
    """

    def __init__(
        self,
        socket: Path,
        accounts: Path,
        clock: Clock,
        *,
        bypass_from: Place | None = Place.PANEL,
        wall: Callable[[], float] = wall_time_s,
    ) -> None:
        self._clock = clock
        self._bypass_from = bypass_from
        self._remote = False
        self.accounts = Accounts(accounts)
        self.sessions = Sessions(self.accounts, clock, self._note, wall)
        self.desk = PressDesk(socket, clock)
        self.refused = RefusedPresses(self._say, clock)
        self._of_nobody: dict[tuple[Place, Say], str] = {}
        self._texts: dict[tuple[object, ...], str] = {}
        self._moments: deque[Moment] = deque(maxlen=KEPT_MOMENTS)
        self._state: State | None = None
        self._blocked, self._also_blocking = "", tuple[str, ...]()
        self._probing = self._trying = False

    def look(self, seen: Observed, number: int) -> None:
        """Take note of what the frame of this number shows."""
        self._of_nobody.clear()
        self.sessions.sweep()
        self.refused.tend()
        age_s = seen.tick_age_s
        is_fresh = seen.writer_lives and age_s is not None and age_s < FRESH_S
        self._state = seen.row.state if seen.row is not None and is_fresh else None
        self._blocked = seen.facts.blocked if seen.facts is not None else ""
        self._also_blocking = seen.facts.also_blocking if seen.facts is not None else ()
        self._probing = seen.facts is not None and seen.facts.status.probing
        self._trying = seen.facts is not None and bool(seen.facts.status.trying)
        self._remote = seen.row is not None and seen.row.is_remote
        shown = self._state.name if self._state is not None else ""
        self._moments.append(Moment(number=number, made_ns=self._clock.now_ns(), state=shown))

    def close(self) -> None:
        """Say to the service what is left to say, and leave."""
        self.refused.close()
        self.desk.close()

    def valid_until_ns(self, number: int, state: str) -> int:
        """Return until when a press counts that saw this state in this frame; 0: not at all."""
        for moment in self._moments:
            if moment.number == number and moment.state == state:
                return moment.made_ns + VALID_NS
        return 0

    def reasons(self, action: Action, session: Session | None, place: Place) -> tuple[Reason, ...]:
        """Return why a session may not do something now; empty when it may."""
        return self.reasons_of(action, self.person(session, place))

    def reasons_of(self, action: Action, person: Person) -> tuple[Reason, ...]:
        """Return why somebody may not do something now; empty when he may."""
        return may(action, person, self._circumstances())

    def person(self, session: Session | None, place: Place) -> Person:
        """Return who asks."""
        return self.sessions.person(session, place)

    def own(self, token: str, place: Place, say: Say) -> str:
        """Return what a frame shows of one browser's session, as JSON.

        Of those without a session, who are many, it is worked out once for each frame.
        """
        session = self.sessions.find(token, place)
        if session is not None:
            return self._own_of(session, place, say)
        if (place, say) not in self._of_nobody:
            self._of_nobody[place, say] = self._own_of(None, place, say)
        return self._of_nobody[place, say]

    def _own_of(self, session: Session | None, place: Place, say: Say) -> str:
        """Return it, worked out anew where anything that it is of has changed."""
        held, person = self.sessions.holder(), self.person(session, place)
        around = self._circumstances()
        said = {
            "account": session.account.name if session is not None else "",
            "has_hand": person.has_hand,
            "hand_of": held.session.account.name if held is not None else "",
            "hand_from": held.session.place if held is not None else "",
            "hand_since_s": held.since_s if held is not None else 0.0,
            "lost_to": session.lost_to if session is not None else "",
            "hears": self.desk.rules is not None,
        }
        key = (*said.values(), person, around, say)
        if key not in self._texts:
            if len(self._texts) >= KEPT_TEXTS:
                self._texts.clear()
            why = {action.value: shortened(may(action, person, around), say) for action in Action}
            self._texts[key] = json.dumps(
                {**said, "why": why}, ensure_ascii=False, separators=(",", ":")
            )
        return self._texts[key]

    def _note(self, what: str, session: Session) -> None:
        """Have what nobody pressed put into the audit."""
        self._say(Notice(what=what, account=session.account.name, place=session.place))

    def _say(self, notice: Notice) -> None:
        """Have something that was done or refused here put into the audit."""
        self.desk.notice(notice)

    def _circumstances(self) -> Circumstances:
        rules, held = self.desk.rules, self.sessions.holder()
        hand_of = held.session.account.name if held is not None else ""
        if rules is None:  # what it would allow is not known; nothing is, while it is silent
            rules = Welcome(version="", ceiling=Role.COMMISSION, arms_from=Place.NETWORK)
        return Circumstances(
            state=self._state if self.desk.rules is not None else None,
            blocked=self._blocked,
            also_blocking=self._also_blocking,
            ceiling=rules.ceiling,
            commands_from=rules.arms_from,
            hand_of=hand_of,
            probing=self._probing,
            trying=self._trying,
            remote=self._remote,
            bypass_from=self._bypass_from,
        )


def shortened(reasons: tuple[Reason, ...], say: Say) -> list[str]:
    """Return what a button says; its place is small, and the whole list stands with the state."""
    texts = [said_in(one, say) for one in reasons]
    if len(texts) <= SAID_AT_BUTTON:
        return texts
    more = say(N_("{count} more reasons, see State")).format(count=len(texts) - SAID_AT_BUTTON)
    return [*texts[:SAID_AT_BUTTON], more]


def said_in(reason: Reason, say: Say) -> str:
    """Return a reason in the reader's language."""
    is_guards = reason.code is Code.GUARD
    name = explained(printable(reason.name, LONGEST_REASON), say)[0] if is_guards else reason.name
    if reason.code is Code.CHANGED:
        name = say(name)
    return say(WORDS[reason.code]).replace("{name}", printable(name, 300))
