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
_ENDING_S = 5.0
_MOST_BYTES = 65_536


class HostClient:
    """Starts the process at the first line, and ends it with everything it started.

    One that was lost is started again at the next line. Requests are numbered: the answer to one
    whose test was interrupted is dropped, and the plant that it tells of is ended.

    Parameters
    ----------
    folder : for the log of the process.
    module : what the process runs.
    """

    def __init__(self, folder: Path, module: str = _HOST) -> None:
        self._module = module
        self._log = folder / "host.log"
        self._process: subprocess.Popen[bytes] | None = None
        self._requests = 0
        self._rest = b""
        self._nobodys: list[int] = []

    def serve(self, words: Sequence[str], log: Path) -> int:
        """Begin ``sim-plant serve WORDS``; return its process id.

        The first line on a machine compiles its model: ten seconds and more.

        Raises
        ------
        PlantError
            The line model is not installed, the log cannot be written, or the process ended.
        """
        if self._process is not None and self._process.poll() is not None:
            self._forget()
        plant = self._ask({"serve": list(words), "log": str(log)}, "pid")
        while self._nobodys:
            self.end(self._nobodys.pop())
        return plant

    def end(self, plant: int) -> int:
        """End a plant; return its exit code, negative for the signal that ended it.

        Raises
        ------
        PlantError
            It is not there any more, or the process ended and took it along.
        """
        if self._process is None:
            raise PlantError("the process of the simulated lines ended and took this one along")
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
        self._requests += 1
        number = self._requests
        try:
            process.stdin.write(json.dumps({**request, "number": number}).encode() + b"\n")
            process.stdin.flush()
            answer = self._answer(process, number)
        except OSError as error:
            raise PlantError(f"the process of the simulated lines ended {self._why()}") from error
        if "error" in answer:
            raise PlantError(str(answer["error"]))
        return int(answer[wanted])

    def _answer(self, process: subprocess.Popen[bytes], number: int) -> dict[str, int | str]:
        """Return the answer to the request of this number; an older one's plant is nobody's."""
        while True:
            answer = _read_answer(self._line(process))
            if answer.get("number") == number:
                return answer
            if "pid" in answer:
                self._nobodys.append(int(answer["pid"]))

    def _line(self, process: subprocess.Popen[bytes]) -> bytes:
        """Return the next line; what is read of one stays if the wait is interrupted."""
        assert process.stdout is not None
        while b"\n" not in self._rest:
            part = os.read(process.stdout.fileno(), _MOST_BYTES)
            if not part:
                raise BrokenPipeError
            self._rest += part
        line, _, self._rest = self._rest.partition(b"\n")
        return line

    def _why(self) -> str:
        """Forget the process; return how it ended and what it said."""
        code = self._forget()
        how = f"by signal {-code}" if code < 0 else f"with {code}"
        said = self._log.read_text(encoding="utf-8", errors="replace").strip()
        return f"{how}; " + (f"it said:\n{said}" if said else "it said nothing")

    def _forget(self) -> int:
        """Take leave of a process that ended, or closed its side; return its exit code."""
        process, self._process = self._process, None
        assert process is not None
        self._rest = b""
        self._nobodys.clear()
        try:
            process.communicate(timeout=_ENDING_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
        return process.wait()

    def _start(self) -> subprocess.Popen[bytes]:
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
                start_new_session=True,
                env=os.environ | dict.fromkeys(_ONE_THREAD, "1"),
            )


def _read_answer(line: bytes) -> dict[str, int | str]:
    """Return an answer; an empty one for a line that is none, or the end of one."""
    try:
        answer = json.loads(line)
    except ValueError:
        return {}
    return answer if isinstance(answer, dict) else {}
