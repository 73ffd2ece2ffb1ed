"""Hands out the support archive: made at most once in a while, whoever asks."""

from __future__ import annotations

import asyncio
import sqlite3
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime

from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import BaseRoute, Route

from aff_hmi.layout import Layout
from aff_hmi.see import events
from aff_hmi.see.alarm_part import event_line
from aff_hmi.see.kept import Kept
from aff_hmi.support.bundle import MOST_EVENTS, files_of, zipped
from aff_hmi.timing.timing import Timing
from aff_hmi.watch import Observed
from aff_hmi.words import say_in
from aff_runtime.base.ports import Clock

KEPT_NS = 10_000_000_000


class SupportDesk:
    """Makes the archive of the newest moment.

    Parameters
    ----------
    kept, timing : what is put into it. ``metrics`` : returns the numbers as text.
    """

    def __init__(
        self, kept: Kept, timing: Timing, clock: Clock, metrics: Callable[[], str]
    ) -> None:
        self._kept = kept
        self._timing = timing
        self._clock = clock
        self._metrics = metrics
        self._seen = Observed()
        self._made: tuple[int, bytes] | None = None
        self._one = asyncio.Lock()

    def look(self, seen: Observed, layout: Layout) -> None:
        """Take note of a moment."""
        self._seen = seen

    def routes(self) -> list[BaseRoute]:
        """Return the route of the archive."""
        return [Route("/data/support.zip", self.archive)]

    async def archive(self, request: Request) -> Response:
        """Return the archive; of ten seconds all who ask get the same one."""
        async with self._one:
            now_ns = self._clock.now_ns()
            if self._made is None or now_ns - self._made[0] >= KEPT_NS:
                try:
                    self._made = (now_ns, await self._make())
                except (sqlite3.Error, BlockingIOError):
                    return PlainTextResponse("the history cannot be read now; try again\n", 503)
        return Response(
            self._made[1],
            media_type="application/zip",
            headers={"content-disposition": 'attachment; filename="aff-support.zip"'},
        )

    async def _make(self) -> bytes:
        say, kept, seen = say_in("en"), self._kept, self._seen
        wanted = replace(events.Wanted(), most=MOST_EVENTS)
        entries = await kept.store.ask(lambda c: events.select(c, wanted))
        files = files_of(
            seen,
            alarms=kept.alarms(say),
            events=[event_line(one, say) for one in entries],
            timing=self._timing.part(say),
            metrics=self._metrics(),
            utc=datetime.fromtimestamp(kept.wall(), UTC).isoformat(timespec="seconds"),
        )
        return await asyncio.to_thread(zipped, files)
