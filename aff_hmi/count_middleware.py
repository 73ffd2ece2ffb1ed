"""Counts what is answered, by route and status, for a monitoring system."""

from __future__ import annotations

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from aff_hmi.counts import Counts
from aff_runtime.base.ports import Clock

NO_ROUTE = "none"
_S = 1e-9


class CountMiddleware:
    """Stands before the gate. Its labels are the paths of the routes' own table."""

    def __init__(self, app: ASGIApp, counts: Counts, clock: Clock) -> None:
        self._app = app
        self._counts = counts
        self._clock = clock

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on; count the answer of a request when it begins."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        begun_ns = self._clock.now_ns()

        async def counting(message: Message) -> None:
            if message["type"] == "http.response.start":
                path = str(getattr(scope.get("route"), "path", NO_ROUTE))
                self._counts.answers[path, str(message["status"])] += 1
                self._counts.answer_times.add((self._clock.now_ns() - begun_ns) * _S)
            await send(message)

        await self._app(scope, receive, counting)
