"""Readers of the scope that do not read, on real sockets: nobody else waits for them."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

pytest.importorskip("starlette")

from aff_hmi.layout import Layout
from aff_hmi.scope.shot import SECONDS
from aff_hmi.see.kept import Kept
from aff_hmi.timing.usage import server_usage
from aff_hmi.watch import Watch
from aff_runtime.base.clock import MonotonicClock
from tests.aff_hmi.moments import seen
from tests.aff_hmi.scope.played import news
from tests.aff_hmi.served import asked, served

pytestmark = pytest.mark.wire
READERS, EACH = 8, 12  # as many as the gate lets in at once
LARGEST_MB = 0.2  # of one picture


def test_who_asks_for_pictures_and_reads_none_costs_few_of_them_and_holds_up_nobody(
    tmp_path: Path,
) -> None:
    async def play() -> None:
        watch, kept = Watch(tmp_path / "door.sock", MonotonicClock()), Kept(None, MonotonicClock())
        async with served(watch, kept) as (port, hub):
            assert hub.sources is not None
            hub.sources.listen(news([]))
            hub.sources.look(seen(), Layout())
            hub.sources.listen(news(range(6000)))
            names = ",".join(one.name for one in hub.sources.scope.signals[:8])
            path = f"/data/scope?signals={names}&seconds={max(SECONDS)}"
            head = f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode()
            before_MB = server_usage().memory_MB or 0.0
            there = [await asyncio.open_connection("127.0.0.1", port) for _ in range(READERS)]
            for reader, writer in there:
                reader._transport.pause_reading()  # type: ignore[attr-defined]
                writer.write(EACH * head)
            last = hub._number + 5
            while hub._number < last:  # frames go on being made
                await asyncio.sleep(0.02)
            status, _, _ = await asked(port, "/static/icon.svg")
            assert status == "HTTP/1.1 200 OK"
            used_MB = (server_usage().memory_MB or 0.0) - before_MB
            # what waits for a reader is a picture or two of each, never all that he has asked for
            assert used_MB < 3 * READERS * LARGEST_MB + 4.0
            for _, writer in there:
                writer.transport.abort()
        kept.close()

    asyncio.run(play())
