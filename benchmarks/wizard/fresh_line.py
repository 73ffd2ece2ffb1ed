"""`sim-plant live --fresh`: plant, service that waits, commissioner and screen."""

from __future__ import annotations

import json
import re
import signal
import subprocess
from pathlib import Path

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import PlantError
from benchmarks.setup_console.at_the_machine import IN_M
from benchmarks.wizard.answers import Answers, by_files, by_words
from sim_plant.demo.processes import PLANT
from sim_plant.demo.session import pause
from sim_plant.demo.unusual_plants import PLANTS, UnusualPlant
from sim_plant.demo.wires import SITES, free_port
from sim_plant.servers.answers import PlantStatus
from sim_plant.servers.control_client import ask
from sim_plant.servers.map_file import load_plc_map
from sim_plant.servers.plc_map import PlcMap

START_S, END_S = 180.0, 120.0
CORE_M, LEAST_M = 0.04445, 4.0 * IN_M
"""Radius of the core, and the least of the roll: `radius_min` of the answers."""


class FreshLine:
    """One line to commission.

    Parameters
    ----------
    folder : for everything that it keeps; made anew. ``name`` : of the plant.

    Raises
    ------
    PlantError
        It does not start; with its own words.
    """

    def __init__(self, folder: Path, name: str = "shipped") -> None:
        self.folder = folder
        self.plant: UnusualPlant = PLANTS[name]
        self.site = folder / SITES[self.plant.wire]
        self.socket = folder / "plant.sock"
        port = free_port()
        self.url = f"http://127.0.0.1:{port}/"
        self.log = folder.parent / f"{folder.name}.log"
        self._clock = MonotonicClock()
        command = [*PLANT, "live", "--fresh", "--plant", name, "--out", str(folder)]
        with self.log.open("w") as log:
            self.process = subprocess.Popen(
                [*command, "--listen", f"127.0.0.1:{port}"], stdout=log, stderr=log
            )
        try:
            self._reached = self._await(r"PLC to commission: (.+)")
            self.password = self._await(r"password (\w+)")
        except PlantError:
            self.close()
            raise

    def _await(self, pattern: str) -> str:
        end_ns = self._clock.now_ns() + int(START_S * 1e9)
        while self._clock.now_ns() < end_ns and self.process.poll() is None:
            found = re.search(pattern, self.log.read_text())
            if found is not None:
                return found[1]
            pause(0.2)
        raise PlantError(f"the line did not start: {self.log.read_text()}")

    @property
    def words(self) -> PlcMap | None:
        """The PLC's manual; None on a bus."""
        found = re.search(r"manual: (.+)", self._reached)
        return load_plc_map(Path(found[1])) if found is not None else None

    @property
    def plc_port(self) -> str:
        """Port of the PLC on Modbus."""
        found = re.match(r"[\d.]+:(\d+)", self._reached)
        return found[1] if found is not None else ""

    def answers(self) -> Answers:
        """Return somebody with its displays and its manual."""
        words = self.words
        if words is not None:
            reached = by_words(words, self.plc_port)
        else:
            found = re.search(r"channel (\S+);", self._reached)
            reached = by_files(self.plant.wire, found[1] if found is not None else "")
        return Answers(self.socket, self.plant, words, reached)

    def tell(self, *words: str) -> str:
        """Tell the plant something; return its answer."""
        answer = ask(self.socket, " ".join(words))
        if "error" in answer:
            raise PlantError(f"{' '.join(words)}: {answer['error']}")
        return json.dumps(answer)

    def status(self) -> PlantStatus:
        """Return what the plant does now."""
        return PlantStatus.from_json(ask(self.socket, "status"))

    def seconds_left(self) -> float:
        """Return how long the roll lasts at the present speed, s: to what was typed as its core.

        Below that radius no reading of it is believed; the web itself lasts longer.
        """
        now = self.status()
        radius_m = now.measured["unwind_radius_m"] or 0.0
        above_core = max(1e-9, radius_m**2 - CORE_M**2)
        left_m = (now.web.left_m or 0.0) * (radius_m**2 - LEAST_M**2) / above_core
        return left_m / max(1e-3, now.measured["line_speed_m_s"] or 0.0)

    def radius_shown(self) -> str:
        """Return what the display shows now of the unwind roll, which grows smaller."""
        return f"{(self.status().measured['unwind_radius_m'] or 0.0) * 1e3:.1f} mm"

    def close(self) -> None:
        """End it; its children have some seconds each."""
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(END_S)
