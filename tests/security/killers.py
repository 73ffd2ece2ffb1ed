"""Jobs that end or stop the process that does them; light to import, a worker does it."""

import contextlib
import os
import signal
import struct
import time
from dataclasses import dataclass, field
from multiprocessing.context import SpawnContext, SpawnProcess
from pathlib import Path
from types import SimpleNamespace
from typing import ClassVar

import numpy as np

MB = 1 << 20


def is_hit(folder, hits):
    """Return whether it is this try's turn to go wrong, and count it in ``folder``."""
    if len(list(folder.iterdir())) >= hits:
        return False
    (folder / str(os.getpid())).touch()
    return True


def campaign_row(job):
    """Return a row of the campaign; case 1 ends its worker as often as the environment says."""
    seed, number, _ = job
    if number == 1 and is_hit(Path(os.environ["HIT_FOLDER"]), int(os.environ["HITS"])):
        os.kill(os.getpid(), signal.SIGKILL)
    refine = {"verdict": {"verdict": "nothing", "effects": []}, "said": [], "error": ""}
    row = {"number": number, "group": "healthy", "seed": seed, "faults": [], "classes": []}
    more = {"floor": {}, "coordinate": {}, "refine": refine, "refine_s": 1.0, "refine_cpu_s": 1.0}
    return row | more | {"snr": []}


def bench_rows(part):
    """Return the rows of a part of the control bench; the FxLMS ends its worker."""
    jobs, _ = part
    if jobs[0].law == "FxLMS" and is_hit(Path(os.environ["HIT_FOLDER"]), int(os.environ["HITS"])):
        os.kill(os.getpid(), signal.SIGKILL)
    return [{"section": j.section, "case": j.case.name, "law": j.law, "cpu_s": 1.0} for j in jobs]


def stop_in_an_answer():
    """Send the beginning of a megabyte to whoever waits for our answer, and stop."""
    for name in Path("/proc/self/fd").iterdir():
        with contextlib.suppress(OSError):
            if os.readlink(name).startswith("socket:"):
                os.write(int(name.name), struct.pack("!i", MB) + b"half")
    os.kill(os.getpid(), signal.SIGSTOP)


class StoppedProcess(SpawnProcess):
    """A worker; the first one is stopped before it has taken its orders."""

    stopped: ClassVar[list[int]] = []

    def start(self):
        super().start()
        if not self.stopped:
            self.stopped.append(self.pid)
            os.kill(self.pid, signal.SIGSTOP)


class StoppingContext(SpawnContext):
    Process = StoppedProcess


_twin = []


def adopt(twin):
    """Keep the line that `number_of` asks."""
    _twin[:] = [twin]


def number_of(seed):
    """Return what the adopted line answers: the number of the case."""
    return float(_twin[0].simulate(SimpleNamespace(seed=seed))[0])


@dataclass(frozen=True)
class Twin:
    """A line that answers with the number of its case; ``hit`` says how often one goes wrong."""

    folder: Path
    how: str
    number: int = 7
    hits: int = 1
    channels: tuple[str, ...] = ()
    speed_m_s: np.ndarray = field(default_factory=lambda: np.zeros(1))

    def simulate(self, case):
        if case.seed == self.number and is_hit(self.folder, self.hits):
            if self.how == "killed":
                os.kill(os.getpid(), signal.SIGKILL)
            if self.how == "hangs":
                time.sleep(600.0)
            if self.how == "stopped while it answers":
                stop_in_an_answer()
            if self.how == "killed while it answers":
                return np.zeros(64 * MB)
        time.sleep(0.01)
        return np.array([float(case.seed)])
