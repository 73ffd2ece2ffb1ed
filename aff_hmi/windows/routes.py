"""What the page of the scope asks for, by GET: ticks as bytes, or as a file; kept windows."""

from __future__ import annotations

import asyncio
import csv
import io
import sqlite3
from collections.abc import Callable
from dataclasses import asdict

from starlette.requests import HTTPConnection, Request
from starlette.responses import JSONResponse, Response
from starlette.routing import BaseRoute, Route

from aff_hmi.scope.picture import encode, table, waiting
from aff_hmi.scope.scope import Scope
from aff_hmi.scope.shot import Shot, ShotRequest, asked_of
from aff_hmi.see.data_routes import NO_SENSE, NOT_NOW, harmless, refused
from aff_hmi.windows.desk import NOT_THERE, WindowDesk
from aff_hmi.words import Say


def tick_routes(
    scope: Scope, windows: WindowDesk, say_of: Callable[[HTTPConnection], Say]
) -> list[BaseRoute]:
    """Return the routes of scope and kept windows."""
    data = ScopeData(scope, windows, say_of)
    return [
        Route("/data/scope", data.ticks),
        Route("/data/scope.csv", data.file),
        Route("/data/windows", data.windows),
    ]


class ScopeData:
    """Answers what is asked of the scope.

    Parameters
    ----------
    say_of : the language of a request.
    """

    def __init__(
        self, scope: Scope, windows: WindowDesk, say_of: Callable[[HTTPConnection], Say]
    ) -> None:
        self._scope = scope
        self._windows = windows
        self._say_of = say_of
        self._one = asyncio.Lock()

    async def ticks(self, request: Request) -> Response:
        """Return a shot as bytes; one without ticks while a trigger has not fired."""
        asked = asked_of(request.query_params)
        shot = await self._shot(request, asked)
        if isinstance(shot, Response):
            return shot
        assert asked is not None
        ring = "" if asked.kept else self._scope.ticks.ident
        body = waiting() if shot is None else encode(shot, asked, self._say_of(request), ring)
        return Response(body, media_type="application/octet-stream")

    async def file(self, request: Request) -> Response:
        """Return exactly what a shot shows as a file for a spreadsheet; one at a time."""
        asked = asked_of(request.query_params)
        if self._one.locked():
            return refused(503, self._say_of(request)(NOT_NOW))
        async with self._one:
            shot = await self._shot(request, asked)
            if isinstance(shot, Response):
                return shot
            assert asked is not None
            text = "" if shot is None else await asyncio.to_thread(_written, shot, asked)
        return Response(
            text,
            media_type="text/csv; charset=utf-8",
            headers={"content-disposition": 'attachment; filename="aff-ticks.csv"'},
        )

    async def windows(self, request: Request) -> Response:
        """Return what is said of every kept window."""
        try:
            kept = await self._windows.windows()
        except (sqlite3.Error, BlockingIOError):
            return refused(503, self._say_of(request)(NOT_NOW))
        return JSONResponse({"ok": True, "windows": [asdict(one) for one in kept]})

    async def _shot(self, request: Request, asked: ShotRequest | None) -> Shot | Response | None:
        say = self._say_of(request)
        if asked is None:
            return refused(400, say(NO_SENSE))
        try:
            kept = await self._windows.ticks(asked.kept) if asked.kept else None
            if asked.kept and kept is None:
                return refused(404, say(NOT_THERE))
            return self._scope.shot(asked, kept)
        except KeyError:
            return refused(400, say(NO_SENSE))
        except (sqlite3.Error, BlockingIOError):
            return refused(503, say(NOT_NOW))


def _written(shot: Shot, asked: ShotRequest) -> str:
    text = io.StringIO()
    writer = csv.writer(text)
    for n, row in enumerate(table(shot, asked)):
        writer.writerow(row if n else map(harmless, row))
    return text.getvalue()
