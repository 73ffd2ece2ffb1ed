"""What a page asks for beside its frames: history, by GET, and nothing is changed by it."""

from __future__ import annotations

import csv
import io
import sqlite3
from collections.abc import Callable
from dataclasses import asdict, replace
from datetime import UTC, datetime

from starlette.requests import HTTPConnection, Request
from starlette.responses import JSONResponse, Response
from starlette.routing import BaseRoute, Route

from aff_hmi.see import events
from aff_hmi.see.alarm_part import event_line
from aff_hmi.see.flags import Flag, flags
from aff_hmi.see.kept import Kept
from aff_hmi.see.trend_part import trend_part
from aff_hmi.see.trends import WINDOWS, Curves
from aff_hmi.words import N_, Say

MOST_IN_FILE = 10_000
LONGEST_ROLL = 60
NOT_NOW = N_("the history cannot be read now; try again")
NO_SENSE = N_("that is no request of this screen")
FORMULA = ("=", "+", "-", "@", "\t", "\r")


def data_routes(kept: Kept, say_of: Callable[[HTTPConnection], Say]) -> list[BaseRoute]:
    """Return the routes of history."""
    data = Data(kept, say_of)
    return [
        Route("/data/events", data.events),
        Route("/data/events.csv", data.events_file),
        Route("/data/trend", data.trend),
        Route("/data/recent", data.recent),
    ]


class Data:
    """Answers what is asked of history.

    Parameters
    ----------
    say_of : the language of a request.
    """

    def __init__(self, kept: Kept, say_of: Callable[[HTTPConnection], Say]) -> None:
        self._kept = kept
        self._say_of = say_of

    async def events(self, request: Request) -> Response:
        """Return events, the newest first."""
        say = self._say_of(request)
        wanted = wanted_of(request)
        if wanted is None:
            return refused(400, say(NO_SENSE))
        try:
            entries = await self._kept.store.ask(lambda c: events.select(c, wanted))
        except (sqlite3.Error, BlockingIOError):
            return refused(503, say(NOT_NOW))
        cycle_s = self._kept.cycle_s
        return JSONResponse(
            {"ok": True, "events": [asdict(event_line(e, say, cycle_s)) for e in entries]}
        )

    async def events_file(self, request: Request) -> Response:
        """Return events as a file for a spreadsheet, times in UTC."""
        say = self._say_of(request)
        wanted = wanted_of(request)
        if wanted is None:
            return refused(400, say(NO_SENSE))
        try:
            whole = replace(wanted, most=MOST_IN_FILE)
            entries = await self._kept.store.ask(lambda c: events.select(c, whole))
        except (sqlite3.Error, BlockingIOError):
            return refused(503, say(NOT_NOW))
        text = io.StringIO()
        writer = csv.writer(text)
        writer.writerow(("utc", "tick", "kind", "roll", "name", "text", "who"))
        for entry in entries:
            line = event_line(entry, say)
            cells = (line.kind, line.roll, line.name, line.text, line.who)
            tick = "" if line.tick is None else line.tick
            writer.writerow((_utc(line.utc_s), tick, *map(harmless, cells)))
        return Response(
            text.getvalue(),
            media_type="text/csv; charset=utf-8",
            headers={"content-disposition": 'attachment; filename="aff-events.csv"'},
        )

    async def trend(self, request: Request) -> Response:
        """Return the curves of a group over a window; of a group that is none, those there are.

        A page that was opened before the line was known has none to choose from until then: it
        asks for no group, which is no wrong request.
        """
        say, asked = self._say_of(request), request.query_params
        group, window = asked.get("group", ""), asked.get("window", "")
        try:
            read = self._kept.trends.wanted(group, window)
        except KeyError:
            there = {"ok": False, "text": say(NO_SENSE), "groups": self._kept.groups(say)}
            return JSONResponse(there, 200 if not group and window in WINDOWS else 400)
        try:
            curves, flagged = await self._kept.store.ask(lambda c: _with_flags(c, read, say))
        except (sqlite3.Error, BlockingIOError):
            return refused(503, say(NOT_NOW))
        return JSONResponse({"ok": True, "trend": asdict(trend_part(curves, flagged, say))})

    async def recent(self, request: Request) -> Response:
        """Return the last ten minutes of what the overview shows."""
        return JSONResponse({"ok": True, "recent": asdict(self._kept.recent())})


def _with_flags(
    connection: sqlite3.Connection, read: Callable[[sqlite3.Connection], Curves], say: Say
) -> tuple[Curves, list[Flag]]:
    """Return curves and what happened meanwhile."""
    curves = read(connection)
    return curves, flags(connection, curves.from_s, curves.to_s, say)


def wanted_of(request: Request) -> events.Wanted | None:
    """Return which events a request wants; None for what is no request of ours."""
    asked = request.query_params
    kind, roll, before = asked.get("kind", ""), asked.get("roll", ""), asked.get("before", "0")
    is_right = kind in ("", *events.Kind) and len(roll) <= LONGEST_ROLL
    if not is_right or not (before.isascii() and before.isdigit() and len(before) <= 15):
        return None
    return events.Wanted(kind=kind, roll=roll, before=int(before))


def harmless(cell: str) -> str:
    """Return a cell that no spreadsheet takes for a formula."""
    return f"'{cell}" if cell.startswith(FORMULA) else cell


def _utc(utc_s: float) -> str:
    return datetime.fromtimestamp(utc_s, UTC).isoformat(timespec="milliseconds")


def refused(status: int, text: str) -> Response:
    """Return why a question has no answer."""
    return JSONResponse({"ok": False, "text": text}, status)
