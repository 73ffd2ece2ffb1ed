"""The routes: one table; what is not in it is 404."""

from __future__ import annotations

from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from starlette.applications import Starlette
from starlette.requests import HTTPConnection, Request
from starlette.responses import HTMLResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket

from aff_hmi.hub import Hub
from aff_hmi.words import LANGUAGES, NAMES, language_of, say_in
from aff_runtime import __version__
from aff_runtime.app.report.metrics.exposition import CONTENT_TYPE

FOLDER = Path(__file__).parent
ASSETS = {
    "overview.js": "text/javascript; charset=utf-8",
    "freshness.js": "text/javascript; charset=utf-8",
    "overview.css": "text/css; charset=utf-8",
    "icon.svg": "image/svg+xml",
}


class Pages:
    """Serves the overview.

    Parameters
    ----------
    language : of a reader whose browser asks for none that there is.
    """

    def __init__(self, hub: Hub, language: str) -> None:
        self._hub = hub
        self._language = language
        self._texts = {name: (FOLDER / "static" / name).read_bytes() for name in ASSETS}
        self._templates = Environment(
            loader=FileSystemLoader(FOLDER / "templates"),
            autoescape=True,
            undefined=StrictUndefined,
            trim_blocks=True,
            lstrip_blocks=True,
        )

    def app(self) -> Starlette:
        """Return the routes."""
        return Starlette(
            routes=[
                Route("/", self.overview),
                Route("/static/{name}", self.asset),
                Route("/metrics", self.metrics),
                WebSocketRoute("/live", self.live),
            ]
        )

    async def overview(self, request: Request) -> Response:
        """Return the page; numbers come by the socket."""
        language = self._language_of(request)
        page = self._templates.get_template("overview.html").render(
            _=say_in(language),
            language=language,
            others=[(one, NAMES[one]) for one in LANGUAGES if one != language],
            layout=self._hub.layout,
            boot=self._hub.boot,
            version=__version__,
        )
        return HTMLResponse(page, headers={"vary": "accept-language"})

    async def asset(self, request: Request) -> Response:
        """Return one of the files that there are."""
        name = request.path_params["name"]
        if name not in ASSETS:
            return Response("not found\n", 404, media_type="text/plain")
        return Response(self._texts[name], media_type=ASSETS[name])

    async def metrics(self, request: Request) -> Response:
        """Return the numbers of the line for a monitoring system."""
        return Response(self._hub.metrics(), headers={"content-type": CONTENT_TYPE})

    async def live(self, socket: WebSocket) -> None:
        """Look after one browser's socket."""
        await self._hub.serve(socket, self._language_of(socket))

    def _language_of(self, asked: HTTPConnection) -> str:
        wanted = asked.query_params.get("lang", "")
        return language_of(wanted, asked.headers.get("accept-language", ""), self._language)
