"""What a running screen costs: ``python -m benchmarks.screen PID [--url URL] [--clients 10]``.

Opens sockets as browsers do, answers every frame, and prints frames per second and client,
processor time of the screen's process as a share of one core, and its memory.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
from pathlib import Path
from urllib.parse import urlsplit

from websockets.asyncio.client import connect
from websockets.typing import Origin

from aff_runtime.base.clock import MonotonicClock

PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")
TICKS_PER_S = os.sysconf("SC_CLK_TCK")


def seconds_now() -> float:
    """Return monotonic time, s."""
    return MonotonicClock().now_ns() * 1e-9


def used(pid: int) -> tuple[float, float]:
    """Return processor time, s, and resident memory, MB, of a process."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return (int(fields[11]) + int(fields[12])) / TICKS_PER_S, pages * PAGE_BYTES * 1e-6


async def look(url: str, seconds: float) -> tuple[int, int]:
    """Be one browser; return how many frames came, and their bytes."""
    place = urlsplit(url)
    frames = size = 0
    origin = Origin(f"http://{place.netloc}")
    async with connect(f"ws://{place.netloc}/live?lang=en", origin=origin) as socket:
        await socket.send(json.dumps({"a": 0, "t": 1e3 * seconds_now()}))
        end_s = seconds_now() + seconds
        while seconds_now() < end_s:
            text = await socket.recv()
            frames, size = frames + 1, size + len(text)
            said = json.loads(text)
            await socket.send(json.dumps({"a": said["q"], "t": 1e3 * seconds_now()}))
    return frames, size


async def run(pid: int, url: str, clients: int, seconds: float) -> None:
    """Measure and print."""
    before_s, _ = used(pid)
    start_s = seconds_now()
    found = await asyncio.gather(*(look(url, seconds) for _ in range(clients)))
    if not found:
        await asyncio.sleep(seconds)
    passed_s = seconds_now() - start_s
    after_s, memory_MB = used(pid)
    frames = sum(one[0] for one in found)
    size = sum(one[1] for one in found)
    rate = frames / clients / passed_s if clients else 0.0
    print(
        f"{clients} clients: {rate:.1f} frames/s each of {size / max(1, frames):.0f} bytes, "
        f"{100.0 * (after_s - before_s) / passed_s:.1f} % of a core, {memory_MB:.0f} MB"
    )


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("pid", type=int)
    parser.add_argument("--url", default="http://127.0.0.1:8480/")
    parser.add_argument("--clients", type=int, default=10)
    parser.add_argument("--seconds", type=float, default=15.0)
    given = parser.parse_args()
    asyncio.run(run(given.pid, given.url, given.clients, given.seconds))


if __name__ == "__main__":
    main()
