"""Tabs that are opened and closed for a while: what the screen keeps of them is nothing."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path

import numpy as np

from benchmarks.runtime.facts import FactRow
from benchmarks.screen.clients import now_s, opened
from benchmarks.screen.rig import used
from benchmarks.screen.targets import target
from sim_plant.demo.processes import Child

NAME = "P10 tabs that come and go"
EVERY_S = 0.25
LOOKERS = 9
WARM = 0.25  # of the time: what is made once is made by then
MOST_MB, MOST_MB_PER_H = 150.0, 0.1
JUDGED_S = 7200.0  # in two minutes such a slope is less than a page of memory


async def _tabs(url: str, screen: Child, seconds: float) -> tuple[int, list[tuple[float, float]]]:
    """Return how many tabs came and went, and the memory meanwhile: (s, MB)."""
    begun_s, count, memory = now_s(), 0, []
    while now_s() < begun_s + seconds:
        async with opened(url) as socket:
            await socket.send(json.dumps({"a": 0, "t": 1e3 * now_s()}))
            await asyncio.wait_for(socket.recv(), 10.0)
        count += 1
        memory.append((now_s() - begun_s, used(screen.process.pid)[1]))
        await asyncio.sleep(EVERY_S)
    return count, memory


async def _looked_at(
    url: str, screen: Child, seconds: float
) -> tuple[int, list[tuple[float, float]]]:
    """As ``_tabs``, while others look all the time."""

    async def look() -> None:
        async with opened(url) as socket:
            number = 0
            while True:
                await socket.send(json.dumps({"a": number, "t": 1e3 * now_s()}))
                number = json.loads(await socket.recv())["q"]

    lookers = [asyncio.create_task(look()) for _ in range(LOOKERS)]
    try:
        return await _tabs(url, screen, seconds)
    finally:
        for one in lookers:
            one.cancel()
        await asyncio.gather(*lookers, return_exceptions=True)


def churn(url: str, screen: Child, seconds: float) -> list[FactRow]:
    """Return P10: memory, descriptors and threads while tabs come and go beside nine that stay."""
    process = Path(f"/proc/{screen.process.pid}")

    def held() -> tuple[int, int]:
        return len(list((process / "fd").iterdir())), len(list((process / "task").iterdir()))

    asyncio.run(_looked_at(url, screen, min(5.0, seconds)))
    before = held()
    count, memory = asyncio.run(_looked_at(url, screen, seconds))
    asyncio.run(asyncio.sleep(1.0))
    after = held()
    at_s, at_MB = np.asarray([one for one in memory if one[0] >= WARM * seconds]).T
    slope = np.polyfit(at_s / 3600.0, at_MB, 1)[0] if len(at_s) > 2 else float("nan")
    value = f"{at_MB.max():.0f} MB, {slope:+.2f} MB/h"
    held_words = f"descriptors {before[0]} to {after[0]}, threads {before[1]} to {after[1]}"
    about = (
        f"{count} tabs in {seconds:g} s beside {LOOKERS} that stay, the first quarter not counted"
    )
    return [
        FactRow(
            name=NAME,
            value=f"{value}; {held_words}",
            remark=f"{verdict(seconds, float(at_MB.max()), float(slope), before, after)}; {about}",
        )
    ]


def verdict(
    seconds: float,
    most_MB: float,
    slope_MB_h: float,
    before: tuple[int, int],
    after: tuple[int, int],
) -> str:
    """Return P10 with whether it was met: memory and its slope; descriptors and threads held.

    Only the time that a slope of this size takes to show can meet it; in a shorter one the slope
    says nothing either way.
    """
    held = ((after[0], before[0]), (after[1], before[1]))
    words = (
        f"{MOST_MB:g} MB, no descriptor, no thread more, "
        f"at most {MOST_MB_PER_H:g} MB/h over {JUDGED_S / 3600.0:g} h"
    )
    if seconds < JUDGED_S:
        return target(words, (most_MB, MOST_MB), *held, is_judged=False)
    return target(words, (most_MB, MOST_MB), *held, (slope_MB_h, MOST_MB_PER_H))
