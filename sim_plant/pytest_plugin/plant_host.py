"""A process that has the line's model loaded and forks one plant per line.

It reads one JSON request per file line and answers each with one that has its ``number``.
``{"serve": [WORDS], "log": PATH}`` forks ``sim-plant serve WORDS`` with its output in ``log`` and
answers the process id. ``{"end": PID}`` ends one and answers its exit code. What cannot be done is
answered by ``error``. Nothing else is written where the answers go. At the end of its input it
ends them all, so that nothing outlives the tests, whatever became of them.
"""

from __future__ import annotations

import contextlib
import ctypes
import importlib
import json
import os
import signal
import sys
import traceback
from typing import Any, TextIO

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import PlantError
from sim_plant.cli.main import main as sim_plant
from sim_plant.line import open_line
from sim_plant.pytest_plugin.host_client import ENDED

_PATIENCE_S = 5.0
_LOOK_AGAIN_S = 0.005
_PR_SET_PDEATHSIG = 1


class PlantHost:
    """Forks and ends plants."""

    def __init__(self) -> None:
        self._plants: set[int] = set()
        self._opened: set[str] = set()

    def serve(self, words: list[str], log: str) -> int:
        """Start one plant and return its process id; its line is compiled here if it must be."""
        if words[0] not in self._opened:
            self._opened.add(words[0])
            _warm(words[0])
        if "--can" in words:
            _warm_can()
        parent = os.getpid()
        written = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
        plant = os.fork()
        if plant == 0:
            _be_a_plant(words, written, parent)
        os.close(written)
        self._plants.add(plant)
        return plant

    def end(self, plant: int) -> int:
        """End a plant of ours; return its exit code, negative for the signal that ended it."""
        if plant not in self._plants:
            raise PlantError(f"process {plant} is no line of this host; its own was lost")
        self._plants.remove(plant)
        for number in (signal.SIGTERM, signal.SIGKILL):
            _signal(plant, number)
            code = _exit_code(plant)
            if code is not None:
                return code
        raise AssertionError(f"process {plant} outlives SIGKILL")

    def end_all(self) -> None:
        """End every plant."""
        for plant in tuple(self._plants):
            self.end(plant)


def _warm(line: str) -> None:
    """Load the model; a line that cannot be opened is told by the plant itself."""
    importlib.import_module("sim_plant.servers.serve")
    try:
        open_line(line)
    except Exception:
        return


def _warm_can() -> None:
    """Load what a bus needs; a missing library is told by the plant itself."""
    with contextlib.suppress(ImportError):
        importlib.import_module("sim_plant.servers.can_catalogue")


def _signal(plant: int, number: signal.Signals) -> None:
    os.kill(plant, number)  # a child that was not waited for: its id is still its own


def _exit_code(plant: int) -> int | None:
    clock = MonotonicClock()
    give_up_ns = clock.now_ns() + int(_PATIENCE_S * 1e9)
    while True:
        done, status = os.waitpid(plant, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status)
        if clock.now_ns() > give_up_ns:
            return None
        clock.sleep_until_ns(clock.now_ns() + int(_LOOK_AGAIN_S * 1e9))


def _be_a_plant(words: list[str], written: int, parent: int) -> None:
    """Say everything into ``written``; never return."""
    code = 1
    try:
        nothing = os.open(os.devnull, os.O_RDONLY)
        for old, new in ((written, 1), (written, 2), (nothing, 0)):
            os.dup2(old, new)
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
        if os.getppid() != parent:
            os._exit(code)
        code = sim_plant(["serve", *words])
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stderr.flush()
        sys.stdout.write(f"{ENDED} {code}\n")
        sys.stdout.flush()
        os._exit(code)


def obey(requests: TextIO, answers: TextIO) -> None:
    """Answer every request until the input ends, then end every plant."""
    host = PlantHost()
    try:
        for text in requests:
            request = json.loads(text)
            answer = {"number": request["number"], **_obeyed(host, request)}
            print(json.dumps(answer), file=answers, flush=True)
    finally:
        host.end_all()


def _obeyed(host: PlantHost, request: Any) -> dict[str, int | str]:
    try:
        if "end" in request:
            return {"exit_code": host.end(request["end"])}
        return {"pid": host.serve(request["serve"], request["log"])}
    except (OSError, PlantError) as error:
        return {"error": str(error)}


def answers_alone() -> TextIO:
    """Return where answers go; whatever else this process prints goes where its errors go."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    return answers


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # ctrl-c is for the tests; they close our input
    obey(sys.stdin, answers_alone())
