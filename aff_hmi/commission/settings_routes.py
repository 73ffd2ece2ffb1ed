"""What the page of settings asks for: the form and versions by GET, what an edit would do."""

from __future__ import annotations

from dataclasses import asdict

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import BaseRoute, Route

from aff_hmi.commission.in_language import refusal_in
from aff_hmi.commission.link import Commission
from aff_hmi.commission.looks import Looks, number_in
from aff_hmi.commission.settings_shown import difference_in, settings_in, version_in
from aff_hmi.press_request import PressRequest, refusal
from aff_runtime.app.commission.answers import DifferenceShown, SettingsShown, VersionShown
from aff_runtime.app.commission.messages import Refusal
from aff_runtime.app.commission.messages import Request as Asked
from aff_runtime.app.hand.may import Role


class SettingsData:
    """Answers what is looked at."""

    def __init__(self, looks: Looks) -> None:
        self._looks = looks

    def routes(self) -> list[BaseRoute]:
        """Return the routes."""
        return [
            Route("/data/settings", self.settings),
            Route("/data/settings/version", self.version),
        ]

    async def settings(self, request: Request) -> Response:
        """Return the site file as a form, and its versions."""
        found = await self._looks.looked(request, Asked(do="settings"), SettingsShown)
        if isinstance(found, Response):
            return found
        said = asdict(settings_in(found.settings, self._looks.say_of(request)))
        return JSONResponse({"ok": True, "settings": said})

    async def version(self, request: Request) -> Response:
        """Return one version; what going back would change, to who commissions alone."""
        session = self._looks.session_of(request)
        may_go_back = session is not None and session.account.role >= Role.COMMISSION
        asked = Asked(do="settings_version", number=number_in(request), back=may_go_back)
        found = await self._looks.looked(request, asked, VersionShown)
        if isinstance(found, Response):
            return found
        said = asdict(version_in(found.version, self._looks.say_of(request)))
        return JSONResponse({"ok": True, "version": said})


async def difference(commission: Commission, press: PressRequest) -> Response:
    """Answer what an edit would do: nothing goes out, and nothing is kept."""
    said = press.said
    asked = Asked(do="settings_diff", base=str(said["base"]), edits=str(said["edits"]))
    found = await commission.look(asked, DifferenceShown)
    if isinstance(found, Refusal):
        return refusal(409, refusal_in(found, press.say), str(found.why))
    return JSONResponse(
        {"ok": True, "difference": asdict(difference_in(found.difference, press.say))}
    )
