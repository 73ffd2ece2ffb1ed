"""What the pages of refining and maintenance ask for by GET, for who has logged in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import TypeVar

from starlette.requests import HTTPConnection, Request
from starlette.responses import JSONResponse, Response
from starlette.routing import BaseRoute, Route

from aff_hmi.commission.in_language import refusal_in
from aff_hmi.commission.link import Commission
from aff_hmi.commission.of_runs import maintenance_in, refined_in, refining_in
from aff_hmi.commission.routes import stranger
from aff_hmi.sessions import Session
from aff_hmi.words import Say
from aff_runtime.app.commission.answers import (
    Good,
    MaintenanceShown,
    Printed,
    RefinedShown,
    RefiningShown,
)
from aff_runtime.app.commission.messages import Refusal
from aff_runtime.app.commission.messages import Request as Asked

FILE = "aff-refine.html"
MOST_DIGITS = 9
Shown = TypeVar("Shown", bound=Good)


class RunData:
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
            Route("/data/refining", self.refining),
            Route("/data/refined", self.refined),
            Route("/data/refined.html", self.page),
            Route("/data/maintenance", self.maintenance),
        ]

    async def refining(self, request: Request) -> Response:
        """Return the runs that there are, what was chosen, and what was refined."""
        found = await self._looked(request, Asked(do="refining"), RefiningShown)
        if isinstance(found, Response):
            return found
        said = asdict(refining_in(found.refining, self._say_of(request)))
        return JSONResponse({"ok": True, "refining": said})

    async def refined(self, request: Request) -> Response:
        """Return one refinement."""
        asked = Asked(do="refined", number=_number(request))
        found = await self._looked(request, asked, RefinedShown)
        if isinstance(found, Response):
            return found
        said = asdict(refined_in(found.refined, self._say_of(request)))
        return JSONResponse({"ok": True, "refined": said})

    async def page(self, request: Request) -> Response:
        """Return refine's own page as a file: it has a style of its own."""
        asked = Asked(do="refined_page", number=_number(request))
        found = await self._looked(request, asked, Printed, status=404)
        if isinstance(found, Response):
            return found
        head = {"content-disposition": f'attachment; filename="{FILE}"'}
        return Response(found.html, media_type="text/html; charset=utf-8", headers=head)

    async def maintenance(self, request: Request) -> Response:
        """Return the line over weeks."""
        found = await self._looked(request, Asked(do="maintenance"), MaintenanceShown)
        if isinstance(found, Response):
            return found
        said = asdict(maintenance_in(found.maintenance, self._say_of(request)))
        return JSONResponse({"ok": True, "maintenance": said})

    async def _looked(
        self, request: Request, asked: Asked, kind: type[Shown], status: int = 200
    ) -> Shown | Response:
        """Return what the commissioner shows, or the answer that says why not."""
        say = self._say_of(request)
        if self._session_of(request) is None:
            return stranger(say)
        found = await self._commission.look(asked, kind)
        if isinstance(found, Refusal):
            return JSONResponse({"ok": False, "text": refusal_in(found, say)}, status)
        return found


def _number(request: Request) -> int:
    """Return the number of a refinement that is asked for; 0, which none has, for no number."""
    said = request.query_params.get("number", "")
    is_one = said.isascii() and said.isdecimal() and len(said) <= MOST_DIGITS
    return int(said) if is_one else 0
