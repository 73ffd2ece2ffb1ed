"""What the pages of card and commissioning ask for by GET: looking, for who has logged in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict

from starlette.requests import HTTPConnection, Request
from starlette.responses import JSONResponse, Response
from starlette.routing import BaseRoute, Route

from aff_hmi.commission.in_language import card_in, line_in, refusal_in, state_in
from aff_hmi.commission.link import Commission
from aff_hmi.sessions import Session
from aff_hmi.words import Say
from aff_runtime.app.commission.answers import CardShown, LineShown, Printed, State
from aff_runtime.app.commission.messages import Refusal
from aff_runtime.app.commission.messages import Request as Asked
from aff_runtime.app.hand.may import WORDS, Code, Role

FILE = "aff-card.html"


class CommissionData:
    """Answers what is looked at.

    Parameters
    ----------
    session_of : the session of a request, None without one. ``say_of`` : its language.
    """

    def __init__(
        self,
        commission: Commission,
        session_of: Callable[[HTTPConnection], Session | None],
        say_of: Callable[[HTTPConnection], Say],
    ) -> None:
        self._commission = commission
        self._session_of = session_of
        self._say_of = say_of

    def routes(self) -> list[BaseRoute]:
        """Return the routes."""
        return [
            Route("/data/card", self.card),
            Route("/data/card.html", self.page),
            Route("/data/commissioning", self.state),
            Route("/data/line", self.line),
        ]

    async def card(self, request: Request) -> Response:
        """Return the card as it stands."""
        say = self._say_of(request)
        if self._session_of(request) is None:
            return stranger(say)
        shown = await self._commission.look(Asked(do="card"), CardShown)
        if isinstance(shown, Refusal):
            return JSONResponse({"ok": False, "text": refusal_in(shown, say)})
        return JSONResponse({"ok": True, "card": asdict(card_in(shown.card, say))})

    async def line(self, request: Request) -> Response:
        """Return the site file as it was checked, the probe's bounds, and what was found."""
        say = self._say_of(request)
        if self._session_of(request) is None:
            return stranger(say)
        shown = await self._commission.look(Asked(do="line"), LineShown)
        if isinstance(shown, Refusal):
            return JSONResponse({"ok": False, "text": refusal_in(shown, say)})
        return JSONResponse({"ok": True, "line": asdict(line_in(shown.line, say))})

    async def page(self, request: Request) -> Response:
        """Return the card as one page that prints, as a file: it has a style of its own."""
        say = self._say_of(request)
        if self._session_of(request) is None:
            return stranger(say)
        paper = "letter" if request.query_params.get("paper") == "letter" else "a4"
        printed = await self._commission.look(Asked(do="page", paper=paper), Printed)
        if isinstance(printed, Refusal):
            return JSONResponse({"ok": False, "text": refusal_in(printed, say)}, 404)
        head = {"content-disposition": f'attachment; filename="{FILE}"'}
        return Response(printed.html, media_type="text/html; charset=utf-8", headers=head)

    async def state(self, request: Request) -> Response:
        """Return how commissioning stands."""
        say, session = self._say_of(request), self._session_of(request)
        if session is None:
            return stranger(say)
        stands = await self._commission.look(Asked(do="state"), State)
        if isinstance(stands, Refusal):
            return JSONResponse({"ok": False, "text": refusal_in(stands, say)})
        sees_all = session.account.role >= Role.COMMISSION
        is_open = self._commission.is_open(session, stands.by)
        return JSONResponse(asdict(state_in(stands, say, sees_all=sees_all, is_open=is_open)))


def stranger(say: Say) -> Response:
    """Return the answer to who has not logged in."""
    return JSONResponse({"ok": False, "text": say(WORDS[Code.LOGGED_OUT])}, 401)
