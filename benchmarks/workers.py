"""What every bench takes its processes from: one killed or hanging costs its job a repeat.

The campaign comes here too. Its rule to know the product by the command line alone is about what
is under test there, and who gives work out says nothing of a line.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from aff_runtime.base.python_child import module_command
from sim_plant.base.worker_pool import LostJobError, WorkerPool
from sim_plant.fleet.cluster import Cluster

__all__ = ["Cluster", "LostJobError", "WorkerPool", "add_workers", "by_hand", "kill_when"]

PATIENCE_S = 120.0
"""For a scheduler and workers to be there: a busy machine takes a while."""


def add_workers(parser: argparse.ArgumentParser) -> None:
    """Add the options that say who does the work."""
    parser.add_argument("--workers", type=int, default=2, help="of a cluster made here")
    parser.add_argument(
        "--scheduler",
        default="",
        metavar="tcp://HOST:PORT",
        help="the Dask scheduler of a cluster that runs; default: one made on this machine",
    )


@contextmanager
def by_hand(folder: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """Start a scheduler and two workers on loopback; yield its address and the workers.

    They end with this, and by themselves where this is killed: the scheduler without work, then
    the workers without it.
    """
    folder.mkdir(parents=True, exist_ok=True)
    address = folder / "scheduler.json"
    address.unlink(missing_ok=True)
    rest = ["--no-dashboard", "--scheduler-file", str(address)]
    scheduler = ["distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0"]
    scheduler += ["--idle-timeout", f"{PATIENCE_S:g}s"]
    worker = ["distributed.cli.dask_worker", "--nthreads", "1", "--no-nanny"]
    worker += ["--death-timeout", f"{PATIENCE_S:g}"]
    logs = [folder / f"worker{k}.log" for k in (1, 2)]
    begun = [_begun([*scheduler, *rest], folder / "scheduler.log")]
    try:
        _until(lambda: address.exists() and address.stat().st_size > 0, "a scheduler")
        workers = [_begun([*worker, *rest], log) for log in logs]
        begun += workers
        _until(lambda: all(map(_registered, logs)), "two workers")
        yield _told(address), workers
    finally:
        for process in reversed(begun):
            process.kill()
            process.wait()


def kill_when(ready: Callable[[], bool], worker: subprocess.Popen[bytes]) -> None:
    """Kill a worker (SIGKILL) with the job that it has, as soon as something is so."""
    while not ready():
        if worker.poll() is not None:
            return
        time.sleep(0.2)  # noqa: TID251
    os.kill(worker.pid, signal.SIGKILL)
    sys.stderr.write(f"worker {worker.pid} killed\n")


def _begun(command: Sequence[str], log: Path) -> subprocess.Popen[bytes]:
    with log.open("wb") as said:
        begun = [*module_command(command[0]), *command[1:]]
        return subprocess.Popen(begun, stdout=said, stderr=said)


def _registered(log: Path) -> bool:
    """Return whether a worker is known to its scheduler, as its log says."""
    return b"Registered to" in log.read_bytes()


def _told(file: Path) -> str:
    return str(json.loads(file.read_text(encoding="utf-8"))["address"])


def _until(ready: Callable[[], bool], what: str) -> None:
    end = time.monotonic() + PATIENCE_S  # noqa: TID251
    while not ready():
        if time.monotonic() > end:  # noqa: TID251
            raise TimeoutError(f"{what}: nothing after {PATIENCE_S:g} s; see its log")
        time.sleep(0.05)  # noqa: TID251
