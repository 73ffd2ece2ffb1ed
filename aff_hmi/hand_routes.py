"""What a browser may ask for beside looking: one table, and one gate before every entry of it.

Nothing here is reached by GET but the page for the login. What is not in the table is 404.
"""

from __future__ import annotations

import asyncio
import hmac
from collections.abc import Awaitable, Callable
from dataclasses import replace

from starlette.requests import HTTPConnection, Request
from starlette.responses import Response
from starlette.routing import Route
from starlette.types import Scope

from aff_hmi.commission.link import Commission
from aff_hmi.commission.presses import CommissionPresses
from aff_hmi.counts import Counts
from aff_hmi.doorkeeper import Doorkeeper
from aff_hmi.gate import MAX_BODY_BYTES, is_by_tls
from aff_hmi.hand import Hand
from aff_hmi.lesser_presses import LesserPresses
from aff_hmi.listening import HTTP_PORT, HTTPS_PORT, LOOPBACK, host_and_port
from aff_hmi.press_request import (
    BODY_PATIENCE_S,
    DONE,
    SECURE_COOKIE,
    TABLE,
    Answering,
    PressRequest,
    PressRule,
    Said,
    because,
    body,
    done,
    refusal,
)
from aff_hmi.see.alarm_desk import AlarmDesk
from aff_hmi.session_presses import SessionPresses
from aff_hmi.sessions import Session
from aff_hmi.windows.desk import WindowDesk
from aff_hmi.words import N_, Say
from aff_runtime.app.hand.may import BY_HAND, Action, Code, Place, Reason, Role
from aff_runtime.app.hand.messages import (
    LOGIN_REFUSED,
    NOBODY,
    Command,
    Notice,
    is_account_name,
    is_command_id,
)
from aff_runtime.base.errors import WireError
from aff_runtime.base.ports import Clock
from aff_runtime.base.signals import State

LOOPBACK_ADDRESSES = ("127.0.0.1", "::1")
PASSED_ON = ("forwarded", "via", "x-real-ip", "x-client-ip")
WRONG = N_("name or password is wrong")
WAIT = N_("too many tries: wait a minute")
NO_SENSE = N_("that is no request of this screen")
NOT_HEARD = N_("the service does not hear this screen: use the switch at the line")
TOO_MUCH = N_("that is too much")
TAKEN = N_("{name} has the hand; take it over?")
ROLE_WORDS = (N_("view"), N_("operate"), N_("commission"))


class HandRoutes:
    """Answers the table.

    Parameters
    ----------
    say_of : the language of a request. ``alarms``, ``windows`` : None where none are kept.
    commission : None on a screen that commissions nothing.
    """

    def __init__(
        self,
        hand: Hand,
        clock: Clock,
        counts: Counts,
        *,
        say_of: Callable[[HTTPConnection], Say],
        alarms: AlarmDesk | None = None,
        windows: WindowDesk | None = None,
        commission: Commission | None = None,
    ) -> None:
        self._hand = hand
        self._counts = counts
        self._clock = clock
        self._say_of = say_of
        self._long = asyncio.Lock()
        self._doorkeeper = Doorkeeper(hand.accounts, clock)
        self._answers: dict[str, Answering] = {
            "/login": self._login,
            "/logout": self._logout,
            "/hand": self._take,
            "/act": self._act,
            **SessionPresses(hand.sessions, clock, self._note).answers(),
            **LesserPresses(hand.sessions, self._note, alarms, windows).answers(),
            **CommissionPresses(hand, commission).answers(),
        }

    def routes(self) -> list[Route]:
        """Return the routes of the table."""
        return [Route(path, self._behind(path), methods=["POST"]) for path in TABLE]

    def cookie_name(self, asked: HTTPConnection) -> str:
        """Return the name of the session's cookie: screens of one machine have each their own.

        A cookie holds for all ports of a name, so the port is in its name.
        """
        port, is_tls = host_and_port(asked.headers.get("host", ""))[1], is_by_tls(asked.scope)
        port = port or (HTTPS_PORT if is_tls else HTTP_PORT)
        return f"{SECURE_COOKIE}aff-{port}" if is_tls else f"aff-{port}"

    def token_of(self, asked: HTTPConnection) -> str:
        """Return what a browser shows of its session, empty for nothing."""
        return asked.cookies.get(self.cookie_name(asked), "")

    def session_of(self, asked: HTTPConnection) -> Session | None:
        """Return the session of a request."""
        return self._hand.sessions.find(self.token_of(asked), place_of(asked))

    def is_logged_in(self, scope: Scope) -> bool:
        """Return whether a request comes from a session, for the gate."""
        return self.session_of(HTTPConnection(scope)) is not None

    def can_bypass(self, asked: HTTPConnection) -> bool:
        """Return whether who asks may bypass, with a login or without one."""
        session, place = self.session_of(asked), place_of(asked)
        return not self._hand.reasons(Action.BYPASS, session, place)

    # --- the gate ---------------------------------------------------------------------------

    def _behind(self, path: str) -> Callable[[Request], Awaitable[Response]]:
        """Return an endpoint that a request reaches only as its row of the table says."""
        entry, answer = TABLE[path], self._answers[path]

        async def endpoint(request: Request) -> Response:
            length = int(request.headers.get("content-length", 0))
            asked = self._unread(request)
            if length > entry.most_bytes:
                return refusal(413, asked.say(TOO_MUCH))
            if length <= MAX_BODY_BYTES:
                said = await body(request, entry)
                if said is None:
                    return refusal(400, asked.say(NO_SENSE))
                asked = replace(asked, said=said)
                return self._against(path, request, asked) or await answer(asked)
            against = self._against(path, request, asked)
            return against or await self._answer_long(request, entry, asked, answer)

        return endpoint

    def _unread(self, request: Request) -> PressRequest:
        """Return what is known of a request before its body is read."""
        token, place = self.token_of(request), place_of(request)
        return PressRequest(
            said={},
            session=self._hand.sessions.find(token, place),
            token=token,
            cookie=self.cookie_name(request),
            place=place,
            address=request.client.host if request.client else "",
            say=self._say_of(request),
        )

    async def _answer_long(
        self, request: Request, entry: PressRule, asked: PressRequest, answer: Answering
    ) -> Response:
        """Read and answer what holds texts, of who may press it: one at a time is in memory."""
        try:
            await asyncio.wait_for(self._long.acquire(), BODY_PATIENCE_S)
        except TimeoutError:
            return self._refuse(429, Reason(code=Code.FAST), asked)
        try:
            said = await body(request, entry)
            if said is None:
                return refusal(400, asked.say(NO_SENSE))
            if self._hand.sessions.find(asked.token, asked.place) is not asked.session:
                return self._refuse(401, Reason(code=Code.LOGGED_OUT), asked)  # ended meanwhile
            return await answer(replace(asked, said=said))
        finally:
            self._long.release()

    def _against(self, path: str, request: Request, asked: PressRequest) -> Response | None:
        """Return why who asks may not press this now; None when they may, and it was counted."""
        entry, said, session = TABLE[path], asked.said, asked.session
        needs_login = entry.role is not None and not self._is_free(path, said, asked.place)
        if session is None and needs_login:
            return self._refuse(401, Reason(code=Code.LOGGED_OUT), asked)
        if session is not None and not self._has_token(request, session, entry, said):
            return self._refuse(403, Reason(code=Code.TOKEN), asked)
        if session is not None and entry.role is not None:
            if session.account.role < entry.role:
                return self._refuse(403, Reason(code=Code.ROLE), asked)
            if said.get("action") != Action.BYPASS and not session.presses.take():
                return self._refuse(429, Reason(code=Code.FAST), asked)
        return None

    def _refuse(self, status: int, reason: Reason, asked: PressRequest) -> Response:
        """Refuse a request; where it is a press of the hand, that is put on record."""
        account = asked.session.account.name if asked.session is not None else NOBODY
        action = str(asked.said.get("action", ""))
        self._hand.refused.note(action, reason.code, account, asked.place)
        return because(status, reason, asked.say)

    def _is_free(self, path: str, said: Said, place: Place) -> bool:
        """Return whether this is a bypass that needs no login at this place."""
        is_bypass = path == "/act" and said.get("action") == Action.BYPASS
        return is_bypass and not self._hand.reasons(Action.BYPASS, None, place)

    @staticmethod
    def _has_token(request: Request, session: Session, entry: PressRule, said: Said) -> bool:
        """Return whether the page says the session's own token.

        A bypass does without: the origin was checked, and a page that is older than the login must
        still take the correction back.
        """
        needs = entry.needs_token
        if needs is None:
            needs = said.get("action") != Action.BYPASS
        given = request.headers.get("x-aff-token", "").encode()
        return not needs or hmac.compare_digest(given, session.csrf.encode())

    # --- logins -----------------------------------------------------------------------------

    async def _login(self, asked: PressRequest) -> Response:
        name, password = str(asked.said["name"]), str(asked.said["password"])
        shown = name if is_account_name(name) else NOBODY
        try:
            if self._doorkeeper.is_too_often(shown, asked.address):
                raise BlockingIOError
            if self._doorkeeper.is_guessed(shown, password, asked.place):
                raise BlockingIOError
            account = await self._doorkeeper.check(name, password, asked.place)
        except BlockingIOError:
            self._counts.logins["waits"] += 1
            return refusal(429, asked.say(WAIT))
        self._counts.logins["refused" if account is None else "done"] += 1
        if account is None:
            self._note(LOGIN_REFUSED, shown, asked.place)
            return refusal(401, asked.say(WRONG))
        self._doorkeeper.was_right(shown, asked.address, password, asked.place)
        self._hand.sessions.end(asked.token)
        token = self._hand.sessions.begin(account, asked.place)
        self._note("login", account.name, asked.place)
        answer = done(asked.say(DONE))
        answer.set_cookie(
            asked.cookie, token, path="/", secure=asked.is_secure, httponly=True, samesite="strict"
        )
        return answer

    async def _logout(self, asked: PressRequest) -> Response:
        assert asked.session is not None
        self._hand.sessions.end(asked.token)
        self._note("logout", asked.session.account.name, asked.place)
        answer = done(asked.say(DONE))
        answer.delete_cookie(
            asked.cookie, path="/", secure=asked.is_secure, httponly=True, samesite="strict"
        )
        return answer

    # --- the hand ---------------------------------------------------------------------------

    async def _take(self, asked: PressRequest) -> Response:
        """Take the hand, take it over from somebody, or release it."""
        session, sessions = asked.session, self._hand.sessions
        assert session is not None
        name = session.account.name
        if sessions.is_idle(session):
            return because(403, Reason(code=Code.IDLE), asked.say)
        sessions.press(session)
        match asked.said["do"]:
            case "release":
                if sessions.release(session):
                    self._note("hand released", name, asked.place)
            case "take" | "take over" as do:
                held = sessions.holder()
                is_own = held is not None and held.session is session
                other = held.session.account.name if held is not None and not is_own else ""
                if other and (do, asked.said["of"]) != ("take over", other):
                    # whoever has it by now is named, and is who is asked about
                    words = asked.say(TAKEN).replace("{name}", other)
                    return refusal(409, words, Code.OTHER_HAND, other)
                sessions.take(session)
                what = "hand taken over" if other else "hand taken"
                if not is_own:
                    self._note(what, name, asked.place, other)
            case _:
                return refusal(400, asked.say(NO_SENSE))
        return done(asked.say(DONE))

    async def _act(self, asked: PressRequest) -> Response:
        """Do a press, and count it."""
        answer = await self._press(asked)
        if asked.said["action"] in BY_HAND:
            result = {200: "done", 503: "failed"}.get(answer.status_code, "refused")
            self._counts.presses[str(asked.said["action"]), result] += 1
        return answer

    async def _press(self, asked: PressRequest) -> Response:
        """Judge a press and pass it on."""
        session, said = asked.session, asked.said
        action, ident, seen = str(said["action"]), str(said["id"]), str(said["seen"])
        is_known = action in BY_HAND and is_command_id(ident)
        if not is_known or seen not in ("", *State.__members__):
            return refusal(400, asked.say(NO_SENSE))
        if session is not None:
            self._hand.sessions.press(session)
        until_ns = 0
        if action != Action.BYPASS:
            reasons = self._hand.reasons(Action(action), session, asked.place)
            if reasons:
                return self._refuse(409, reasons[0], asked)
            until_ns = self._hand.valid_until_ns(int(said["frame"]), seen)
            if self._clock.now_ns() > until_ns:
                return self._refuse(409, Reason(code=Code.LATE), asked)
        command = Command(
            id=ident,
            action=Action(action),
            account=session.account.name if session is not None else NOBODY,
            role=session.account.role if session is not None else Role.VIEW,
            place=asked.place,
            seen=seen,
            valid_until_ns=until_ns,
        )
        try:
            answer = await self._hand.desk.press(command)
        except WireError:
            self._refuse(503, Reason(code=Code.SILENT), asked)
            return refusal(503, asked.say(NOT_HEARD))
        if answer.reason is not None:
            return because(409, answer.reason, asked.say)
        return done(asked.say(DONE))

    def _note(self, what: str, account: str, place: Place, other: str = "") -> None:
        self._hand.desk.notice(Notice(what=what, account=account, place=place, other=other))


def place_of(asked: HTTPConnection) -> Place:
    """Return where a browser is: loopback is the panel, unless somebody passes it on.

    Not everybody who passes on says so, but a browser elsewhere calls us by a name of the network.
    """
    heads = asked.headers
    is_passed_on = any(name in PASSED_ON or name.startswith("x-forwarded") for name in heads)
    is_loopback = asked.client is not None and asked.client.host in LOOPBACK_ADDRESSES
    is_called_so = host_and_port(heads.get("host", "").lower())[0] in LOOPBACK
    return Place.PANEL if is_loopback and is_called_so and not is_passed_on else Place.NETWORK
