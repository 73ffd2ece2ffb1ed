"""Presses that move nothing at the line: alarms that were seen, windows that are kept."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from functools import partial

from starlette.responses import Response

from aff_hmi.press_request import DONE, Answering, PressRequest, because, done, refusal
from aff_hmi.see.alarm_desk import GONE_ALARM, AlarmDesk
from aff_hmi.sessions import Sessions
from aff_hmi.windows.desk import NOT_KEPT, WindowDesk
from aff_runtime.app.hand.may import Code, Place, Reason

Noting = Callable[[str, str, Place], None]
Press = Callable[[PressRequest, str], Awaitable[tuple[str, str]]]
"""What was pressed and the account -> what it is called in the audit, and why not."""


class LesserPresses:
    """Answers what needs a login of role operate, and no hand.

    Parameters
    ----------
    note : writes what was done into the audit: what, account, place.
    alarms, windows : None on a screen that keeps none.
    """

    def __init__(
        self,
        sessions: Sessions,
        note: Noting,
        alarms: AlarmDesk | None,
        windows: WindowDesk | None,
    ) -> None:
        self._sessions = sessions
        self._note = note
        self._alarms = alarms
        self._windows = windows

    def answers(self) -> dict[str, Answering]:
        """Return what answers each entry of the table."""
        return {
            "/acknowledge": partial(self._answer, self._acknowledge),
            "/shelve": partial(self._answer, self._shelve),
            "/keep": partial(self._answer, self._keep),
            "/let-go": partial(self._answer, self._delete_window),
        }

    async def _answer(self, press: Press, asked: PressRequest) -> Response:
        """Answer a press of a session that may; what was done goes into the audit."""
        who = self._who(asked)
        if isinstance(who, Response):
            return who
        what, against = await press(asked, who)
        if against:
            return refusal(409, asked.say(against))
        self._note(what, who, asked.place)
        return done(asked.say(DONE))

    async def _acknowledge(self, asked: PressRequest, who: str) -> tuple[str, str]:
        return "alarm seen", self._alarms.seen(asked.said, who) if self._alarms else GONE_ALARM

    async def _shelve(self, asked: PressRequest, who: str) -> tuple[str, str]:
        against = self._alarms.shelve(asked.said, who) if self._alarms else GONE_ALARM
        what = "alarm put aside" if int(asked.said["minutes"]) > 0 else "alarm taken back"
        return what, against

    async def _keep(self, asked: PressRequest, who: str) -> tuple[str, str]:
        against = await self._windows.keep(asked.said, who) if self._windows else NOT_KEPT
        return "window kept", against

    async def _delete_window(self, asked: PressRequest, who: str) -> tuple[str, str]:
        against = await self._windows.delete(asked.said, who) if self._windows else NOT_KEPT
        return "window let go", against

    def _who(self, asked: PressRequest) -> str | Response:
        """Return the account, or why its session may not; a press keeps the session awake."""
        session = asked.session
        assert session is not None
        if self._sessions.is_idle(session):
            return because(403, Reason(code=Code.IDLE), asked.say)
        self._sessions.press(session)
        return session.account.name
