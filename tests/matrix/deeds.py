"""What befalls the processes themselves: killed, held up, out of disk, fed with rubbish."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tests.hil.live_line import LiveLine
from tests.processes import kill, pause, until

RUBBISH = "version: 1\nline: [this, is: not\n\ta site file"
HELD_S = 1.0  # how long a stopped process stays stopped


def no_undo(line: LiveLine) -> None:
    """Leave everything as it is."""
    del line


@dataclass(frozen=True, slots=True, kw_only=True)
class Deed:
    """One blow against real processes.

    Attributes
    ----------
    reaction : latch or ride as in ``table.yaml``; zero where a new plant has to start with it.
    do : the blow; returns the plant time at which it began.
    undo : what a technician does about it.
    """

    name: str
    reaction: str
    do: Callable[[LiveLine], float]
    undo: Callable[[LiveLine], None] = no_undo


def children(pid: int) -> list[int]:
    """Return the processes that ``pid`` has started."""
    path = Path(f"/proc/{pid}/task/{pid}/children")
    return [int(word) for word in path.read_text().split()] if path.exists() else []


def recorder_pid(line: LiveLine) -> int:
    """Return the recorder of the running service, 0 without one."""
    for pid in children(line.service.process.pid):
        if b"telemetry.recorder" in Path(f"/proc/{pid}/cmdline").read_bytes():
            return pid
    return 0


def _control(line: LiveLine) -> int:
    return int(line.status()["control_pid"])


def _killed(line: LiveLine, *pids: int) -> float:
    struck_s = line.now_s()
    for pid in pids:
        kill(pid)
    return struck_s


def _kill_runtime(line: LiveLine) -> float:
    return _killed(line, _control(line), line.service.process.pid, recorder_pid(line))


def _kill_plant(line: LiveLine) -> float:
    kill(line.plant.process.pid)
    pause(0.5)
    line.start_plant_again()
    return 0.0  # a new plant, a new time


def _held(line: LiveLine, pid: int) -> float:
    struck_s = line.now_s()
    os.kill(pid, signal.SIGSTOP)
    try:
        pause(HELD_S)
    finally:
        os.kill(pid, signal.SIGCONT)
    return struck_s


def _start_service(line: LiveLine) -> None:
    line.start_again()
    until("the service sees the PLC", lambda: line.status().get("comm") == "OK")


def _rubbish(line: LiveLine) -> float:
    struck_s = line.now_s()
    line.edit(RUBBISH)
    until("CONFIG_DIFFERS", lambda: bool(line.status().get("config_differs")))
    return struck_s


def _good_again(line: LiveLine) -> None:
    line.edit(line.site_text)
    until("no difference", lambda: not line.status()["config_differs"])


def _fill_disk(line: LiveLine) -> float:
    """Leave nothing of the file system that records, log, site file and sockets are on."""
    struck_s = line.now_s()
    free = os.statvfs(line.bench.folder)
    filler = line.bench.folder / "filler"
    subprocess.run(
        ["fallocate", "-l", str(free.f_bavail * free.f_frsize - (1 << 16)), str(filler)],
        check=True,
    )
    with filler.open("ab") as stream:
        try:
            while True:
                os.write(stream.fileno(), bytes(4096))
        except OSError:
            pass  # full
    pause(2.0)
    return struck_s


def _empty_disk(line: LiveLine) -> None:
    (line.bench.folder / "filler").unlink()


DEEDS = (
    Deed(
        name="control process killed -9",
        reaction="latch",
        do=lambda line: _killed(line, _control(line)),
    ),
    Deed(
        name="supervisor killed -9",
        reaction="latch",
        undo=_start_service,
        do=lambda line: _killed(line, line.service.process.pid),
    ),
    Deed(name="whole runtime killed -9", reaction="latch", do=_kill_runtime, undo=_start_service),
    Deed(name="PLC killed -9 and restarted", reaction="zero", do=_kill_plant),
    Deed(
        name="recorder killed -9",
        reaction="ride",
        do=lambda line: _killed(line, recorder_pid(line)),
    ),
    Deed(
        name="control process stopped 1 s",
        reaction="latch",
        do=lambda line: _held(line, _control(line)),
    ),
    Deed(
        name="supervisor stopped 1 s",
        reaction="ride",
        do=lambda line: _held(line, line.service.process.pid),
    ),
    Deed(
        name="PLC stopped 1 s",
        reaction="latch",
        do=lambda line: _held(line, line.plant.process.pid),
    ),
    Deed(name="disk full", reaction="ride", do=_fill_disk, undo=_empty_disk),
    Deed(name="config replaced by rubbish", reaction="ride", do=_rubbish, undo=_good_again),
)
KILLS = tuple(deed for deed in DEEDS if "killed" in deed.name)
HARMLESS = tuple(deed for deed in DEEDS if "killed" not in deed.name)
