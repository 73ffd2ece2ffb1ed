"""What is pressed on the pages of card and commissioning: passed on to the commissioner.

A press that has settings tried, kept or taken back is judged by ``may`` first, for the correction
that goes out changes with them; the service judges it again.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import replace
from functools import partial

from starlette.responses import Response

from aff_hmi.commission.in_language import refusal_in
from aff_hmi.commission.link import Commission
from aff_hmi.commission.sentences import sentence
from aff_hmi.commission.settings_routes import difference, edit_in, text, text_against
from aff_hmi.hand import Hand
from aff_hmi.press_request import DONE, Answering, PressRequest, Said, because, done, refusal
from aff_hmi.sessions import Session
from aff_runtime.app.commission.link.answers import Answer, Done
from aff_runtime.app.commission.link.messages import WORDS, Refusal, Request, Why
from aff_runtime.app.hand.may import Action, Code, Reason

SEARCH = 9  # the step that tries settings while the correction goes out
PLAIN = ("begin", "verify", "stop", "close")  # requests with no more than who asks
OF_A_TRY = (Action.TRY, Action.KEEP, Action.UNDO)
NO_SENSE = Refusal(why=Why.NO_SENSE)
Press = Callable[[Commission, Session, PressRequest], Awaitable[Answer | Reason]]
"""Takes the way to the commissioner, who pressed, and what; returns its answer, or why not."""
Look = Callable[[Commission, PressRequest], Awaitable[Response]]


class CommissionPresses:
    """Answers the rows of the table that need the role commission.

    Parameters
    ----------
    commission : None on a screen without one.
    """

    def __init__(self, hand: Hand, commission: Commission | None) -> None:
        self._hand = hand
        self._sessions = hand.sessions
        self._commission = commission

    def answers(self) -> dict[str, Answering]:
        """Return what answers each of those rows, by its path."""
        return {
            "/commission/open": partial(self._answer, _open),
            "/commission/do": partial(self._answer, _do),
            "/commission/answer": partial(self._answer, _reply),
            "/card/settings": partial(self._answer, self._settings),
            "/card/step": partial(self._answer, self._step),
            "/card/sign": partial(self._answer, _sign),
            "/settings/diff": partial(self._looked, difference),
            "/settings/text": partial(self._looked, text),
            "/settings/try": self._changing(Action.TRY, _try_of_edits),
            "/settings/save": self._changing(Action.SAVE, _saved_edits),
            "/settings/back": self._changing(Action.UNDO, _way_back),
            "/refine/lacks": partial(self._answer, partial(_of_windows, "lacks")),
            "/refine/start": partial(self._answer, partial(_of_windows, "refine")),
            "/refine/try": self._changing(Action.TRY, _try_of_refinement),
            "/refine/stop": partial(self._answer, partial(_plain, "stop_long")),
            "/maintenance/read": partial(self._answer, partial(_plain, "add_runs")),
            "/maintenance/exchange": partial(self._answer, _exchange),
        }

    def _changing(self, action: Action, request: Callable[[Said], Request]) -> Answering:
        return partial(self._answer, partial(self._changes_settings, action, request))

    async def _answer(self, press: Press, asked: PressRequest) -> Response:
        session, commission = asked.session, self._commission
        assert session is not None
        against = self._pressed(asked) or text_against(asked)
        if against is not None or commission is None:
            return against or refusal(409, asked.say(WORDS[Why.SILENT]), Why.SILENT)
        told = await press(commission, session, asked)
        if isinstance(told, Reason):
            return because(409, told, asked.say)
        if isinstance(told, Refusal):
            return refusal(409, refusal_in(told, asked.say), str(told.why))
        said = told.text if isinstance(told, Done) else ""
        return done(sentence(said, asked.say) if said else asked.say(DONE))

    async def _looked(self, look: Look, asked: PressRequest) -> Response:
        """Answer what an edit is, or would do."""
        against = self._pressed(asked)
        if against is not None or self._commission is None:
            return against or refusal(409, asked.say(WORDS[Why.SILENT]), Why.SILENT)
        return await look(self._commission, asked)

    def _pressed(self, asked: PressRequest) -> Response | None:
        """Take note of a press; return why it is none of somebody who is still there."""
        assert asked.session is not None
        if self._sessions.is_idle(asked.session):
            return because(403, Reason(code=Code.IDLE), asked.say)
        self._sessions.press(asked.session)
        return None

    async def _step(
        self, commission: Commission, session: Session, asked: PressRequest
    ) -> Answer | Reason:
        said = asked.said
        if said["step"] == SEARCH and (reasons := self._against(Action.TRY, asked)):
            return reasons[0]
        step = Request(
            do="step",
            step=int(said["step"]),
            typed=str(said["typed"]),
            plc=str(said["plc"]),
            leave_out=str(said["leave_out"]),
        )
        return await commission.press(session, step)

    async def _settings(
        self, commission: Commission, session: Session, asked: PressRequest
    ) -> Answer | Reason:
        """Try what a step proposes, keep it, or take it back: it changes what goes out."""
        do = str(asked.said["do"])
        if do not in OF_A_TRY:
            return NO_SENSE
        request = _try_of_step if do == Action.TRY else _end_of_try
        return await self._changes_settings(Action(do), request, commission, session, asked)

    async def _changes_settings(
        self,
        action: Action,
        request: Callable[[Said], Request],
        commission: Commission,
        session: Session,
        asked: PressRequest,
    ) -> Answer | Reason:
        """Pass on what changes what goes out, where ``action`` may be done now."""
        if reasons := self._against(action, asked):
            return reasons[0]
        return await commission.press(session, request(asked.said))

    def _against(self, action: Action, asked: PressRequest) -> tuple[Reason, ...]:
        return self._hand.reasons(action, asked.session, asked.place)


def _try_of_step(said: Said) -> Request:
    return Request(
        do="try",
        step=int(said["step"]),
        measured=str(said["measured"]),
        seconds=int(said["seconds"]),
        reason=str(said["reason"]),
    )


def _end_of_try(said: Said) -> Request:
    """Keep it, or take it back."""
    return Request(do=str(said["do"]), measured=str(said["measured"]), reason=str(said["reason"]))


def _try_of_refinement(said: Said) -> Request:
    return Request(
        do="try_refined",
        number=int(said["number"]),
        measured=str(said["measured"]),
        seconds=int(said["seconds"]),
        reason=str(said["reason"]),
    )


def _try_of_edits(said: Said) -> Request:
    return replace(
        edit_in("try_settings", said),
        measured=str(said["measured"]),
        seconds=int(said["seconds"]),
        reason=str(said["reason"]),
    )


def _saved_edits(said: Said) -> Request:
    return replace(
        edit_in("save_settings", said), measured=str(said["measured"]), reason=str(said["reason"])
    )


def _way_back(said: Said) -> Request:
    return Request(
        do="go_back",
        number=int(said["number"]),
        base=str(said["base"]),
        measured=str(said["measured"]),
        reason=str(said["reason"]),
    )


async def _open(commission: Commission, session: Session, asked: PressRequest) -> Answer:
    over = bool(asked.said["over"])
    return await commission.open(session, str(asked.said["password"]), over=over)


async def _do(commission: Commission, session: Session, asked: PressRequest) -> Answer:
    do = str(asked.said["do"])
    if do == "words":
        return await commission.press(session, Request(do=do, again=str(asked.said["again"])))
    if do in PLAIN:
        return await commission.press(session, Request(do=do))
    return NO_SENSE


async def _plain(do: str, commission: Commission, session: Session, asked: PressRequest) -> Answer:
    return await commission.press(session, Request(do=do))


async def _of_windows(
    do: str, commission: Commission, session: Session, asked: PressRequest
) -> Answer:
    """Pass on parts of runs: to look what they lack, or to refine with them."""
    said = asked.said
    named = Request(
        do=do,
        windows=str(said["windows"]),
        holdout=str(said["holdout"]),
        without=str(said["without"]),
    )
    return await commission.press(session, named)


async def _exchange(commission: Commission, session: Session, asked: PressRequest) -> Answer:
    said = asked.said
    told = Request(
        do="exchange", roll=str(said["roll"]), on=str(said["on"]), reason=str(said["reason"])
    )
    return await commission.press(session, told)


async def _reply(commission: Commission, session: Session, asked: PressRequest) -> Answer:
    said = asked.said
    reply = Request(do="answer", number=int(said["number"]), text=str(said["text"]))
    return await commission.press(session, reply)


async def _sign(commission: Commission, session: Session, asked: PressRequest) -> Answer:
    said = asked.said
    signature = Request(
        do="sign",
        step=int(said["step"]),
        measured=str(said["measured"]),
        reason=str(said["reason"]),
        password=str(said["password"]),
    )
    return await commission.press(session, signature)
