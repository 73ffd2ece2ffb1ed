"""What the pages of card and commissioning ask for by GET: looking, for who has logged in."""

from __future__ import annotations

from dataclasses import asdict

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import BaseRoute, Route

from aff_hmi.commission.in_language import card_in, line_in, state_in
from aff_hmi.commission.looks import Looks, saved, stranger
from aff_runtime.app.commission.link.answers import CardShown, LineShown, Printed, State
from aff_runtime.app.commission.link.messages import Request as Asked
from aff_runtime.app.hand.may import Role

FILE = "aff-card.html"


class CommissionData:
    """Answers what is looked at."""

    def __init__(self, looks: Looks) -> None:
        self._looks = looks

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
        shown = await self._looks.looked(request, Asked(do="card"), CardShown)
        if isinstance(shown, Response):
            return shown
        said = asdict(card_in(shown.card, self._looks.say_of(request)))
        return JSONResponse({"ok": True, "card": said})

    async def line(self, request: Request) -> Response:
        """Return the site file as it was checked, the probe's bounds, and what was found."""
        shown = await self._looks.looked(request, Asked(do="line"), LineShown)
        if isinstance(shown, Response):
            return shown
        said = asdict(line_in(shown.line, self._looks.say_of(request)))
        return JSONResponse({"ok": True, "line": said})

    async def page(self, request: Request) -> Response:
        """Return the card as one page that prints, as a file."""
        paper = "letter" if request.query_params.get("paper") == "letter" else "a4"
        asked = Asked(do="page", paper=paper)
        printed = await self._looks.looked(request, asked, Printed, status=404)
        return printed if isinstance(printed, Response) else saved(printed.html, FILE)

    async def state(self, request: Request) -> Response:
        """Return how commissioning stands."""
        say, session = self._looks.say_of(request), self._looks.session_of(request)
        if session is None:
            return stranger(say)
        stands = await self._looks.looked(request, Asked(do="state"), State)
        if isinstance(stands, Response):
            return stands
        sees_all = session.account.role >= Role.COMMISSION
        is_open = self._looks.commission.is_open(session, stands.by)
        return JSONResponse(asdict(state_in(stands, say, sees_all=sees_all, is_open=is_open)))
