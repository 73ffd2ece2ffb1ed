"""The whole product as it runs on site: plant and service as processes, a real socket between."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aff_runtime.base.errors import AffError
from aff_runtime.config.loader import load_site
from sim_plant.demo.processes import PLANT, RUNTIME, Bench, Child
from sim_plant.demo.wires import SITES, wire_up
from sim_plant.servers.control_client import ask
from tests.lockstep.fault_table import WORKING_M_S, peak
from tests.lockstep.known_response import LINE, ROOT, SPEED_M_S, known_responses
from tests.processes import Operator, pause, until

ATTEMPTS = 6
SEED = 7
SCAN_S, SPARE_ROWS = 0.005, 400
Rows = list[tuple[float, tuple[float, ...]]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Pauses:
    """How often the machine held up a process so far; by these a scenario was disturbed."""

    watchdog_trips: int
    plant_samples: int
    runtime_ticks: int


class LiveLine(Operator):
    """One plant, one service, and what an operator and a judge at the plant can do.

    Parameters
    ----------
    folder : everything of this session; its name must be short enough for sockets.
    wire : modbus, can or canopen.
    environment : of the service, where it is not ours.
    site_file : of config; the wire's own, or the plain law's on Modbus, where not given.
    speed_m_s : line speed; a roll at 200 FPM is used up after 19 minutes.
    """

    ANSWER_WITHIN_S = 20.0

    def __init__(
        self,
        folder: Path,
        wire: str = "modbus",
        environment: Mapping[str, str] | None = None,
        site_file: str = "",
        speed_m_s: float = SPEED_M_S,
    ) -> None:
        self._speed_m_s = speed_m_s
        shipped = site_file or {"modbus": "euclid_blocks.yaml"}.get(wire, SITES[wire])
        wired = wire_up(wire, ROOT / "config" / shipped, folder)
        self.bench = Bench(folder=folder, site=wired.site, plant_arguments=wired.plant_arguments)
        super().__init__(self.bench.runtime_dir)
        self._environment = environment
        (folder / "learned").mkdir()
        stem = wired.site.stem.removesuffix("_blocks")
        for actuator, response in known_responses(speed_m_s).items():
            path = folder / "learned" / f"{stem}_{actuator}.json"
            path.write_text(response.to_json())
        text = wired.site.read_text()
        self.site_text = re.sub(r"soft_start_s: [\d.]+", "soft_start_s: 0.3", text)
        self.bench.site.write_text(self.site_text)
        actuators = load_site(self.bench.site).actuators.values()
        self.limits_m_s = tuple(actuator.limit for actuator in actuators)
        self.plant = self._start_plant()
        self.service = self._serve()

    def _start_plant(self) -> Child:
        command = [
            *PLANT,
            "serve",
            str(LINE),
            *self.bench.plant_arguments,
            "--speed-m-s",
            str(self._speed_m_s),
            "--seed",
            str(SEED),
            "--control",
            str(self.bench.plant_socket),
        ]
        return Child("plant", command, self.bench.folder / "plant.log", ready="ready")

    def _serve(self) -> Child:
        command = [
            *RUNTIME,
            "run",
            str(self.bench.site),
            "--runtime-dir",
            str(self.runtime_dir),
            "--record-dir",
            str(self.bench.folder / "runs"),
        ]
        log = self.bench.folder / "runtime.log"
        return Child("runtime", command, log, environment=self._environment)

    def close(self) -> None:
        """End both processes."""
        self.service.stop()
        self.plant.stop()

    # --- the operator -----------------------------------------------------------------------

    @property
    def state(self) -> str:
        """State of the guard, or STARTING, or nothing."""
        return str(self.status().get("state", ""))

    @property
    def alarm(self) -> str:
        """Name of the alarm in force."""
        return str((self.status().get("alarm") or {}).get("name", ""))

    def arm(self) -> None:
        """Press arm once; a refusal is shown by the state."""
        with contextlib.suppress(AffError):
            self.ask("arm")

    def ensure_active(self) -> None:
        """Arm until a correction is at work; a busy machine may trip the guard in between."""
        until("the service sees the PLC", lambda: self.status().get("comm") == "OK")
        for _ in range(ATTEMPTS):
            if str(self.status().get("blocked_by", "")).startswith("AFF_ENABLE_REQUEST"):
                self.ask("bypass")  # the PLC has refused: only who disarms is asked back
                pause(0.4)
            if self.state != "ACTIVE":
                self.arm()
            with contextlib.suppress(AssertionError):
                until("a correction at the plant", self.is_working, 6.0)
                return
        raise AssertionError(f"not active: {self.status()}\n{self.service.tail()}")

    def is_working(self) -> bool:
        """Return whether the guard is ACTIVE and the plant adds a correction to speak of."""
        rows = self.history(60)
        return self.state == "ACTIVE" and peak(rows, rows[0][0], rows[-1][0]) > WORKING_M_S

    def edit(self, text: str) -> None:
        """Replace the site file the way editors do."""
        fresh = self.bench.site.with_suffix(".new")
        fresh.write_text(text)
        fresh.replace(self.bench.site)

    def start_again(self) -> None:
        """Start the service anew after it was killed."""
        self.service.stop()
        self.service = self._serve()

    def start_plant_again(self) -> None:
        """Start the plant anew after it was killed."""
        self.plant.stop()
        self.plant = self._start_plant()

    # --- at the plant -----------------------------------------------------------------------

    def at_plant(self, command: str) -> dict[str, Any]:
        """Send one command to the plant."""
        answer = ask(self.bench.plant_socket, command)
        assert "error" not in answer, answer
        return answer

    def now_s(self) -> float:
        """Return plant time, s."""
        return float(self.at_plant("status")["time_s"])

    def history(self, samples: int) -> Rows:
        """Return time and applied corrections of the last samples."""
        answer = self.at_plant(f"history {samples}")
        values = (tuple(row) for row in answer["applied_m_s"])
        return list(zip(answer["time_s"], values, strict=True))

    def since(self, start_s: float) -> Rows:
        """Return time and applied corrections from a plant time on."""
        wanted = round((self.now_s() - start_s) / SCAN_S) + SPARE_ROWS  # a start may take a minute
        rows = self.history(wanted)
        assert rows[0][0] <= start_s or len(rows) < wanted, f"the plant has forgotten {start_s} s"
        return [row for row in rows if row[0] >= start_s]

    def wait_plant(self, until_s: float) -> None:
        """Wait for a plant time; it passes as ours does."""
        pause(max(0.0, until_s - self.now_s()))
        until(f"plant time {until_s}", lambda: self.now_s() >= until_s)

    def pauses(self) -> Pauses:
        """Return what the machine has held up so far."""
        counts = self.at_plant("status")["counts"]
        signals = self.status().get("signals") or {}
        return Pauses(
            watchdog_trips=counts["watchdog_trips"],
            plant_samples=counts["late_samples"] + counts["skipped_samples"],
            runtime_ticks=int(signals.get("missed_count") or 0),
        )
