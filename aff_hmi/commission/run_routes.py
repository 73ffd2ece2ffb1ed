"""What the pages of refining and maintenance ask for by GET, for who has logged in."""

from __future__ import annotations

from dataclasses import asdict

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import BaseRoute, Route

from aff_hmi.commission.looks import Looks, number_in, saved
from aff_hmi.commission.of_runs import maintenance_in, refined_in, refining_in
from aff_runtime.app.commission.link.answers import (
    MaintenanceShown,
    Printed,
    RefinedShown,
    RefiningShown,
)
from aff_runtime.app.commission.link.messages import Request as Asked

FILE = "aff-refine.html"


class RunData:
    """Answers what is looked at."""

    def __init__(self, looks: Looks) -> None:
        self._looks = looks

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
        found = await self._looks.looked(request, Asked(do="refining"), RefiningShown)
        if isinstance(found, Response):
            return found
        said = asdict(refining_in(found.refining, self._looks.say_of(request)))
        return JSONResponse({"ok": True, "refining": said})

    async def refined(self, request: Request) -> Response:
        """Return one refinement."""
        asked = Asked(do="refined", number=number_in(request))
        found = await self._looks.looked(request, asked, RefinedShown)
        if isinstance(found, Response):
            return found
        said = asdict(refined_in(found.refined, self._looks.say_of(request)))
        return JSONResponse({"ok": True, "refined": said})

    async def page(self, request: Request) -> Response:
        """Return refine's own page as a file."""
        asked = Asked(do="refined_page", number=number_in(request))
        found = await self._looks.looked(request, asked, Printed, status=404)
        return found if isinstance(found, Response) else saved(found.html, FILE)

    async def maintenance(self, request: Request) -> Response:
        """Return the line over weeks."""
        found = await self._looks.looked(request, Asked(do="maintenance"), MaintenanceShown)
        if isinstance(found, Response):
            return found
        said = asdict(maintenance_in(found.maintenance, self._looks.say_of(request)))
        return JSONResponse({"ok": True, "maintenance": said})
