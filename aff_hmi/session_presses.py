"""Who has logged in at this screen, and the end of a session by who may."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass

from starlette.responses import JSONResponse, Response

from aff_hmi.press_request import DONE, Answering, PressRequest, because, done, refusal
from aff_hmi.sessions import Session, Sessions
from aff_hmi.timing.who import PLACE_WORDS
from aff_hmi.words import N_
from aff_runtime.app.hand.may import Code, Place, Reason, Role
from aff_runtime.base.ports import Clock

Noting = Callable[[str, str, Place], None]
NO_SESSION = N_("this session is not there any more")
_S = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionLine:
    """One session as it is shown; words are translated.

    Attributes
    ----------
    since_s, still_s : how long ago it began, and something was last pressed, s.
    is_own : it is that of who asks. ``can_end`` : who asks may end it.
    """

    number: int
    account: str
    role: str
    place: str
    since_s: int
    still_s: int
    has_hand: bool
    is_own: bool
    can_end: bool


class SessionPresses:
    """Answers what is asked of sessions: everybody who has logged in sees them all.

    One's own account ends its own, at another browser too; role commission ends any. The hand of
    a session that ends is free.

    Parameters
    ----------
    note : writes what was done into the audit: what, account, place.
    """

    def __init__(self, sessions: Sessions, clock: Clock, note: Noting) -> None:
        self._sessions = sessions
        self._clock = clock
        self._note = note

    def answers(self) -> dict[str, Answering]:
        """Return what answers each entry of the table."""
        return {"/sessions": self._list, "/sessions/end": self._end}

    async def _list(self, asked: PressRequest) -> Response:
        lines = [asdict(self._line(one, asked)) for one in self._sessions.all()]
        return JSONResponse({"ok": True, "sessions": lines})

    async def _end(self, asked: PressRequest) -> Response:
        """End a session; who does it presses, and is not idle."""
        own = asked.session
        assert own is not None
        if self._sessions.is_idle(own):
            return because(403, Reason(code=Code.IDLE), asked.say)
        number = int(asked.said["number"])
        wanted = next((one for one in self._sessions.all() if one.number == number), None)
        if wanted is None:
            return refusal(409, asked.say(NO_SESSION))
        if not _may_end(own, wanted):
            return because(403, Reason(code=Code.ROLE), asked.say)
        self._sessions.press(own)
        self._sessions.end_session(wanted)
        self._note("session ended by", own.account.name, asked.place)
        self._note("session ended", wanted.account.name, wanted.place)
        return done(asked.say(DONE))

    def _line(self, one: Session, asked: PressRequest) -> SessionLine:
        now_ns, held, own = self._clock.now_ns(), self._sessions.holder(), asked.session
        assert own is not None
        return SessionLine(
            number=one.number,
            account=one.account.name,
            role=asked.say(one.account.role.word),
            place=asked.say(PLACE_WORDS[one.place]),
            since_s=round((now_ns - one.begun_ns) * _S),
            still_s=round((now_ns - one.pressed_ns) * _S),
            has_hand=held is not None and held.session is one,
            is_own=one is own,
            can_end=_may_end(own, one),
        )


def _may_end(own: Session, other: Session) -> bool:
    return own.account.role is Role.COMMISSION or own.account.name == other.account.name
