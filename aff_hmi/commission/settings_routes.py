"""What the page of settings asks for: the form and versions by GET, what an edit would do."""

from __future__ import annotations

from dataclasses import asdict, replace

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import BaseRoute, Route

from aff_hmi.commission.in_language import refusal_in
from aff_hmi.commission.link import Commission
from aff_hmi.commission.looks import Looks, number_in
from aff_hmi.commission.settings_shown import difference_in, sections_in, settings_in, version_in
from aff_hmi.press_request import PressRequest, Said, refusal
from aff_hmi.words import N_
from aff_runtime.app.commission.link.answers import (
    DifferenceShown,
    SettingsShown,
    TextShown,
    VersionShown,
)
from aff_runtime.app.commission.link.messages import Refusal
from aff_runtime.app.commission.link.messages import Request as Asked
from aff_runtime.app.hand.may import Role
from aff_runtime.config.yaml_marks import MAX_BYTES

TOO_LONG = N_("the text has {kB} kB; a site file has {most} kB at most, so this is none")
NO_TEXT = N_("the text holds half a character: type it anew")


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
    if against := text_against(press):
        return against
    found = await commission.look(edit_in("settings_diff", press.said), DifferenceShown)
    if isinstance(found, Refusal):
        return refusal(409, refusal_in(found, press.say), str(found.why))
    return JSONResponse(
        {"ok": True, "difference": asdict(difference_in(found.difference, press.say))}
    )


async def text(commission: Commission, press: PressRequest) -> Response:
    """Answer with the text that is edited, and the same as a form; nothing is kept."""
    if against := text_against(press):
        return against
    asked = replace(edit_in("settings_text", press.said), former=str(press.said["former"]))
    found = await commission.look(asked, TextShown)
    if isinstance(found, Refusal):
        return refusal(409, refusal_in(found, press.say), str(found.why))
    edited = found.edited
    shown = replace(edited, sections=sections_in(edited.sections, press.say))
    return JSONResponse({"ok": True, "edited": asdict(shown)})


def edit_in(do: str, said: Said) -> Asked:
    """Return what a press says of an edit."""
    return Asked(
        do=do, base=str(said["base"]), edits=str(said["edits"]), site_text=str(said["text"])
    )


def text_against(press: PressRequest) -> Response | None:
    """Refuse in words a text that no site file has; what is in it the commissioner says."""
    for key in ("text", "former"):
        try:
            size = len(str(press.said.get(key, "")).encode("utf-8"))
        except UnicodeEncodeError:
            return refusal(400, press.say(NO_TEXT))
        if size > MAX_BYTES:
            words = press.say(TOO_LONG).replace("{kB}", str(-(-size // 1024)))
            return refusal(413, words.replace("{most}", str(MAX_BYTES >> 10)))
    return None
