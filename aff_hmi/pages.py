"""The routes: one table; what is not in it is 404."""

from __future__ import annotations

from functools import cache

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from starlette.applications import Starlette
from starlette.requests import HTTPConnection, Request
from starlette.responses import HTMLResponse, Response
from starlette.routing import BaseRoute, Route, WebSocketRoute
from starlette.websockets import WebSocket

from aff_hmi.bundles import FOLDER, served
from aff_hmi.commission.looks import Looks
from aff_hmi.commission.routes import CommissionData
from aff_hmi.commission.run_routes import RunData
from aff_hmi.commission.settings_routes import SettingsData
from aff_hmi.hand_routes import HandRoutes, place_of
from aff_hmi.hub import Hub
from aff_hmi.see.alarm_desk import AlarmDesk
from aff_hmi.sources import PAGES as SEEN
from aff_hmi.words import LANGUAGES, NAMES, Say, figures_in, language_of, say_in
from aff_runtime import __version__
from aff_runtime.app.report.metrics.exposition import CONTENT_TYPE
from aff_runtime.base.ports import Clock

COMMISSIONED = {
    "/commission": "commission.html",
    "/card": "card.html",
    "/settings": "settings.html",
    "/refine": "refine.html",
    "/maintenance": "maintenance.html",
}


@cache
def _templates() -> Environment:
    """Return the templates: each is compiled once in a process."""
    return Environment(
        loader=FileSystemLoader(FOLDER / "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


class Pages:
    """Serves the overview, and what can be pressed where the hub has a hand.

    Parameters
    ----------
    language : of a reader whose browser asks for none that there is.
    """

    def __init__(self, hub: Hub, language: str, clock: Clock) -> None:
        self._hub = hub
        self._language = language
        self.presses: HandRoutes | None = None
        if hub.hand is not None:
            self.presses = HandRoutes(
                hub.hand,
                clock,
                hub.counts,
                say_of=self._say_of,
                alarms=AlarmDesk(hub.kept) if hub.kept is not None else None,
                windows=hub.sources.windows if hub.sources is not None else None,
                commission=hub.commission,
            )
        self._files = served(has_hand=hub.hand is not None)
        self._templates = _templates()

    def app(self) -> Starlette:
        """Return the routes."""
        routes: list[BaseRoute] = [
            Route("/", self.overview),
            Route("/static/{name}", self.asset),
            Route("/metrics", self.metrics),
            WebSocketRoute("/live", self.live),
        ]
        if self._hub.sources is not None:
            routes += [Route(path, self.seen) for path in SEEN]
            routes += self._hub.sources.routes(self._say_of)
        if self.presses is not None:
            routes += [Route("/login", self.login), *self.presses.routes()]
        if self.presses is not None and self._hub.commission is not None:
            routes += [Route(path, self.commissioned) for path in COMMISSIONED]
            looks = Looks(self._hub.commission, self.presses.session_of, self._say_of)
            for of_page in (CommissionData, RunData, SettingsData):
                routes += of_page(looks).routes()
        app = Starlette(routes=routes)
        app.router.redirect_slashes = False  # a path that is in no table is 404, and no other path
        return app

    async def overview(self, request: Request) -> Response:
        """Return the page; numbers come by the socket."""
        return self._page("overview.html", request)

    async def seen(self, request: Request) -> Response:
        """Return one of the pages beside the overview."""
        path = request.scope["path"]
        template, topic = SEEN[path]
        return self._page(template, request, path=path, topic=topic)

    async def commissioned(self, request: Request) -> Response:
        """Return one of the pages of who commissions."""
        path = request.scope["path"]
        return self._page(COMMISSIONED[path], request, path=path)

    async def login(self, request: Request) -> Response:
        """Return the page on which one logs in."""
        return self._page("login.html", request, path="/login")

    def _back(self, request: Request) -> str:
        """Return the page of ours from which one has come to log in; else the overview."""
        wanted, hub = request.query_params.get("from", "/"), self._hub
        there = [*(SEEN if hub.sources else ()), *(COMMISSIONED if hub.commission else ())]
        return wanted if wanted in there else "/"

    def _page(self, name: str, request: Request, *, path: str = "/", topic: str = "") -> Response:
        language = self._language_of(request)
        page = self._templates.get_template(name).render(
            _=say_in(language),
            figures=lambda text: figures_in(text, say_in(language)),
            language=language,
            path=path,
            back=self._back(request),
            topic=topic,
            kept=self._hub.kept,
            commissions=self._hub.commission is not None,
            sources=self._hub.sources,
            script=name.removesuffix(".html"),
            others=[(one, NAMES[one]) for one in LANGUAGES if one != language],
            layout=self._hub.layout,
            boot=self._hub.boot,
            version=__version__,
            has_hand=self.presses is not None,
            session=self.presses.session_of(request) if self.presses is not None else None,
            can_bypass=self.presses is not None and self.presses.can_bypass(request),
        )
        return HTMLResponse(page, headers={"vary": "accept-language, cookie"})

    async def asset(self, request: Request) -> Response:
        """Return one of the files that there are."""
        name = request.path_params["name"]
        if name not in self._files:
            return Response("not found\n", 404, media_type="text/plain")
        text, kind = self._files[name]
        return Response(text, media_type=kind)

    async def metrics(self, request: Request) -> Response:
        """Return the numbers of the line for a monitoring system."""
        return Response(self._hub.metrics(), headers={"content-type": CONTENT_TYPE})

    async def live(self, socket: WebSocket) -> None:
        """Look after one browser's socket."""
        language, presses, hand = self._language_of(socket), self.presses, self._hub.hand
        asked, kept = socket.query_params.get("page", ""), self._hub.kept
        topic = asked if kept is not None and asked in kept.topics else ""
        if presses is None or hand is None:
            await self._hub.serve(socket, language, topic=topic)
            return
        token, place, say = presses.token_of(socket), place_of(socket), say_in(language)
        await self._hub.serve(socket, language, lambda: hand.own(token, place, say), topic)

    def _say_of(self, asked: HTTPConnection) -> Say:
        return say_in(self._language_of(asked))

    def _language_of(self, asked: HTTPConnection) -> str:
        wanted = asked.query_params.get("lang", "")
        return language_of(wanted, asked.headers.get("accept-language", ""), self._language)
