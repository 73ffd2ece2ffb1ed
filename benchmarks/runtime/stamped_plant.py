"""The plant, served as ``sim-plant serve`` does, that also notes when each scan was made.

``python -m benchmarks.runtime.stamped_plant STAMPS.json LINE.yaml ...`` (the rest as for
``sim-plant serve``) writes ``{heartbeat: monotonic time, ns}`` when it is told to end. Plant and
runtime read one and the same clock, so the age of what the runtime uses is a plain difference.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import signal
import sys
from pathlib import Path

from aff_runtime.base.clock import MonotonicClock
from sim_plant.cli.serve import read_options, register
from sim_plant.line import open_line
from sim_plant.servers.map_file import load_plc_map
from sim_plant.servers.plant import Plant
from sim_plant.servers.serve import PlantService


class Stamps:
    """Notes the time of every scan by its heartbeat."""

    def __init__(self) -> None:
        self._clock = MonotonicClock()
        self.by_heartbeat: dict[int, int] = {}

    def on_sample(self, plant: Plant) -> None:
        """Note the scan that was just made, before it goes on any wire."""
        plc_map = plant.plc.map
        at = plc_map.read["plc_heartbeat"] - plc_map.read_start
        self.by_heartbeat[plant.registers.read_words[at]] = self._clock.now_ns()


async def serve(arguments: argparse.Namespace, stamps: Stamps) -> None:
    """Serve until SIGTERM."""
    line = open_line(arguments.line, seed=arguments.seed, speed_m_s=arguments.speed_m_s)
    service = PlantService(line, load_plc_map(arguments.plc), read_options(arguments))
    service.plant.observers.insert(0, stamps.on_sample)
    asyncio.get_running_loop().add_signal_handler(signal.SIGTERM, service.stop)
    await service.run(lambda text: print(text, flush=True))


def main(path: str, words: list[str]) -> None:
    """Serve, then write the stamps to ``path``."""
    parser = argparse.ArgumentParser()
    register(parser.add_subparsers())
    stamps = Stamps()
    asyncio.run(serve(parser.parse_args(words), stamps))
    Path(path).write_text(json.dumps(stamps.by_heartbeat), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1], ["serve", *sys.argv[2:]])
