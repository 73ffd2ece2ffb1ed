"""The tests' end of the process that forks plants."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from aff_runtime.base.errors import PlantError
from aff_runtime.base.python_child import module_command

ENDED = "ended"
"""The last line of a plant's log begins with it; the exit code follows."""
_HOST = "sim_plant.pytest_plugin.plant_host"
_ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS")  # who forks has one
_PATIENCE_S = 30.0


class HostClient:
    """Starts the process at the first line, and ends it with everything it started.

    Parameters
    ----------
    folder : for the log of the process.
    module : what the process runs.
    """

    def __init__(self, folder: Path, module: str = _HOST) -> None:
        self._module = module
        self._log = folder / "host.log"
        self._process: subprocess.Popen[str] | None = None

    def serve(self, words: Sequence[str], log: Path) -> int:
        """Begin ``sim-plant serve WORDS``; return its process id.

        The first line on a machine compiles its model: ten seconds and more.

        Raises
        ------
        PlantError
            The line model is not installed, or the process ended.
        """
        return self._ask({"serve": list(words), "log": str(log)}, "pid")

    def end(self, plant: int) -> int:
        """End a plant; return its exit code, negative for the signal that ended it."""
        return self._ask({"end": plant}, "exit_code")

    def close(self) -> None:
        """End every plant and the process."""
        process, self._process = self._process, None
        if process is None:
            return
        process.communicate(timeout=_PATIENCE_S)

    def _ask(self, request: Mapping[str, str | int | list[str]], wanted: str) -> int:
        process = self._process = self._process or self._start()
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            process.stdin.write(json.dumps(request) + "\n")
            process.stdin.flush()
            return int(json.loads(process.stdout.readline())[wanted])
        except (OSError, ValueError) as error:
            said = self._log.read_text(encoding="utf-8", errors="replace")
            raise PlantError(f"the process of the simulated lines ended:\n{said}") from error

    def _start(self) -> subprocess.Popen[str]:
        if importlib.util.find_spec("numba") is None:
            raise PlantError(
                "the line model is not installed here: pip install 'aff-runtime[plant]'"
            )
        with self._log.open("wb") as log:
            return subprocess.Popen(
                module_command(self._module),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=log,
                text=True,
                start_new_session=True,
                env=os.environ | dict.fromkeys(_ONE_THREAD, "1"),
            )
