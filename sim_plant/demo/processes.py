"""The plant and the runtime as two real processes, started and ended by their handles."""

from __future__ import annotations

import json
import os
import select
import signal
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import PlantError
from aff_runtime.base.python_child import module_command
from sim_plant.demo.runtime_status import RuntimeStatus
from sim_plant.servers.answers import PlantStatus
from sim_plant.servers.control_client import ask

PLANT = tuple(module_command("sim_plant.cli.main"))
RUNTIME = tuple(module_command("aff_runtime.cli.main"))
SCREEN = tuple(module_command("aff_hmi.main"))  # as a program: nothing imports it


@dataclass(frozen=True, slots=True, kw_only=True)
class Bench:
    """Paths and wire of one session of plant and runtime."""

    folder: Path
    site: Path
    plant_arguments: tuple[str, ...]

    @property
    def plant_socket(self) -> Path:
        """Control socket of the plant."""
        return self.folder / "plant.sock"

    @property
    def plant_record(self) -> Path:
        """What the plant writes down of itself."""
        return self.folder / "plant.csv.gz"

    @property
    def runtime_dir(self) -> Path:
        """Private directory of the runtime's sockets and shared memory."""
        return self.folder / "run"


def end_as_by_hand() -> None:
    """Take being told to end, or a terminal that closes, as ctrl-c: children are ended then.

    A service whose demo is gone would go on correcting, with the rights of real time.
    """
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.default_int_handler)


class Child:
    """A process of ours with its output in a log file; ended by its own handle only."""

    def __init__(
        self,
        name: str,
        command: Sequence[str],
        log: Path,
        ready: str = "",
        environment: Mapping[str, str] | None = None,
        *,
        piped: bool = False,
        patience_s: float = 120.0,
    ) -> None:
        self.name, self.log = name, log
        self._stream = log.open("wb")
        self.process = subprocess.Popen(
            list(command),
            stdout=subprocess.PIPE if ready or piped else self._stream,
            stderr=self._stream,
            start_new_session=True,
            env=None if environment is None else dict(environment),
        )
        if ready:
            try:
                self.await_line(ready, patience_s)
            except BaseException:
                self.stop()  # nobody else has its handle
                raise

    def await_line(self, start: str, patience_s: float) -> str:
        """Return the first output line that begins with ``start``.

        Raises
        ------
        PlantError
            When the process ends or stays silent; the message quotes its log.
        """
        clock = MonotonicClock()
        end_ns = clock.now_ns() + int(patience_s * 1e9)
        pipe = self.process.stdout
        assert pipe is not None
        while clock.now_ns() < end_ns:
            if select.select([pipe], [], [], 0.2)[0]:
                line = pipe.readline().decode(errors="replace")
                if line.startswith(start):
                    return line.strip()
                if not line and self.process.poll() is not None:
                    break
        raise PlantError(f"{self.name} did not become ready: {self.tail()}")

    def tail(self) -> str:
        """Return the end of the log."""
        self._stream.flush()
        return self.log.read_text(errors="replace")[-1500:]

    def stop(self, patience_s: float = 15.0) -> int:
        """Ask the process to end; kill it when it does not. Return its exit code."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            try:
                self.process.wait(patience_s)
            except subprocess.TimeoutExpired:
                os.killpg(self.process.pid, signal.SIGKILL)
                self.process.wait()
        if self.process.stdout is not None:
            self.process.stdout.close()
        self._stream.close()
        return int(self.process.returncode)

    def __enter__(self) -> Child:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.stop()


def plant_status(bench: Bench) -> PlantStatus:
    """Return what the plant does now."""
    return PlantStatus.from_json(ask(bench.plant_socket, "status"))


ALARM_EXIT = 5  # status says so while an alarm stands; its output is still the status


COMMAND_S = 90.0
"""So long a command may take, where nothing else is said."""


def runtime_command(bench: Bench, *words: str, patience_s: float = COMMAND_S) -> str:
    """Run one ``aff-runtime`` command against the service and return what it printed.

    Raises
    ------
    PlantError
        When it exits with an error; the message is the command's own. Or it takes longer than
        ``patience_s``, s.
    """
    try:
        done = subprocess.run(
            [*RUNTIME, *words, "--runtime-dir", str(bench.runtime_dir)],
            capture_output=True,
            text=True,
            timeout=patience_s,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise PlantError(
            f"aff-runtime {' '.join(words)}: no answer within {patience_s:g} s: free the machine "
            f"of other work and try again; {bench.folder / 'runtime.log'} says how far it came"
        ) from None
    allowed = (0, ALARM_EXIT) if words[0] == "status" else (0,)
    if done.returncode not in allowed:
        raise PlantError(
            f"aff-runtime {' '.join(words)}: exit {done.returncode}: "
            f"{done.stderr.strip() or done.stdout.strip()}"
        )
    return done.stdout


def runtime_status(bench: Bench) -> RuntimeStatus:
    """Return how the runtime stands."""
    return RuntimeStatus.from_json(json.loads(runtime_command(bench, "status", "--json")))
