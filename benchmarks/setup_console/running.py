"""A service beside the simulated plant, as somebody at a console runs it."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aff_runtime.base.clock import MonotonicClock
from sim_plant.demo.processes import RUNTIME, Child
from sim_plant.demo.session import pause
from sim_plant.servers.answers import PlantStatus
from sim_plant.servers.control_client import ask

PATIENCE_S = 700.0
TRIES = 3


class PlayError(Exception):
    """A command did not do what it should."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Note:
    """What one step took, and how it ended."""

    step: str
    seconds: float
    exit: int
    said: tuple[str, ...]


class Running:
    """One service and one plant.

    Parameters
    ----------
    folder : for runs and state. ``plant`` : its control socket. ``say`` : tells how it goes.

    Attributes
    ----------
    notes : every command, in order.
    """

    def __init__(self, folder: Path, site: Path, plant: Path, say: Callable[[str], None]) -> None:
        self.folder, self.site, self.say = folder, site, say
        self.runtime_dir = folder / "run"
        self.notes: list[Note] = []
        self._plant = plant
        self._service: Child | None = None
        self._clock = MonotonicClock()

    # --- the service ----------------------------------------------------------------------------

    def start(self) -> None:
        """Start the service, and wait until it is there."""
        command = [*RUNTIME, "run", str(self.site), *self.where(), *self.state()]
        command += ["--record-dir", str(self.folder / "runs")]
        self._service = Child("runtime", command, self.folder / "runtime.log")
        for _ in range(100):
            self.wait(0.5)
            if self.state_now() in ("FAULT", "OFF", "READY", "BYPASS"):
                return
        raise PlayError(f"the service does not start: {self._service.tail()}")

    def end(self, *, kill: bool) -> None:
        """End the service, at once where ``kill``."""
        assert self._service is not None
        if kill:
            self._service.process.kill()
        self._service.stop()
        self._service = None

    def stop(self) -> None:
        """End what runs."""
        if self._service is not None:
            self.end(kill=False)

    def probe(self) -> None:
        """Probe; again where a busy machine ended it."""
        for _ in range(TRIES):
            code, _ = self.aff("probe", "probe", str(self.site), *self.where(), ok=(0, 4, 5))
            if code == 0:
                return
        raise PlayError("the probe does not end well")

    def arm(self) -> None:
        """Arm until it is on: a machine that others use may trip it."""
        for _ in range(3 * TRIES):
            if self.state_now() == "ACTIVE":
                return
            self.aff("arm", "arm", *self.where(), ok=(0, 4, 5))
            self.wait(3.0)
        raise PlayError("it cannot be armed")

    def into_shadow(self) -> None:
        """Go into shadow."""
        for _ in range(TRIES):
            if self.state_now() == "SHADOW":
                return
            self.aff("shadow", "shadow", "on", *self.where(), ok=(0, 4, 5))
            self.wait(1.0)
        raise PlayError("it does not go into shadow")

    def state_now(self) -> str:
        """Return the guard's state; empty where no service answers."""
        done = self.run("status", "--json", *self.where())
        try:
            return str(json.loads(done.stdout)["state"])
        except (ValueError, KeyError):
            return ""

    def recorded_until(self) -> tuple[float, Path]:
        """Return the time of the newest tick (s of the record), and the folder of the record."""
        status = json.loads(self.run("status", "--json", *self.where()).stdout)
        return float(status["signals"]["time_s"]), Path(status["recorder"]["folder"])

    # --- commands -------------------------------------------------------------------------------

    def aff(self, step: str, *words: str, ok: Sequence[int] = (0,)) -> tuple[int, list[str]]:
        """Run a command, note it; return its exit code and its lines."""
        began_s = self.now_s()
        done = self.run(*words)
        lines = (done.stdout + done.stderr).splitlines()
        seconds = round(self.now_s() - began_s, 1)
        self.notes.append(
            Note(step=step, seconds=seconds, exit=done.returncode, said=tuple(lines))
        )
        self.say(f"  {step}: exit {done.returncode}, {seconds} s; {lines[-1] if lines else ''}")
        if done.returncode not in ok:
            raise PlayError(f"aff-runtime {' '.join(words)}: exit {done.returncode}: {lines}")
        return done.returncode, lines

    def run(self, *words: str) -> subprocess.CompletedProcess[str]:
        """Run a command of the console."""
        return subprocess.run(
            [*RUNTIME, *words], capture_output=True, text=True, timeout=PATIENCE_S, check=False
        )

    def where(self) -> tuple[str, ...]:
        """Return the option that names the service."""
        return ("--runtime-dir", str(self.runtime_dir))

    def state(self) -> tuple[str, ...]:
        """Return the option that names what it keeps."""
        return ("--state-dir", str(self.folder / "state"))

    # --- the plant ------------------------------------------------------------------------------

    def tell(self, *words: str) -> dict[str, Any]:
        """Tell the plant something."""
        answer: dict[str, Any] = ask(self._plant, " ".join(words))
        if "error" in answer:
            raise PlayError(f"sim-plant tell {' '.join(words)}: {answer['error']}")
        return answer

    def status_of_plant(self) -> PlantStatus:
        """Return what the plant does now."""
        return PlantStatus.from_json(self.tell("status"))

    def shown(self, channel: str) -> float:
        """Return what a display shows of a channel now."""
        return self.status_of_plant().measured[channel] or 0.0

    def mean(self, channel: str) -> float:
        """Return what a display shows of a channel, which smooths it."""
        values = []
        for _ in range(20):
            values.append(self.shown(channel))
            self.wait(0.1)
        return sum(values) / len(values)

    def now_s(self) -> float:
        """Return the monotonic time."""
        return self._clock.now_ns() * 1e-9

    @staticmethod
    def wait(seconds: float) -> None:
        """Wait."""
        pause(seconds)
