"""What becomes of the workers of a killed process."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
from pathlib import Path

from tests.processes import is_running, kill, until

PATIENCE_S = 60.0


def outlived(script: Path, how: signal.Signals) -> list[int]:
    """Run ``script``, which prints the ids of its workers; end it; return the workers that stay.

    What stays is killed.
    """
    parent = begun([str(script)])
    assert parent.stdout is not None
    workers = [int(word) for word in parent.stdout.readline().split()]
    assert workers
    return left_by(parent, workers, how)


def begun(arguments: list[str]) -> subprocess.Popen[str]:
    """Start Python on ``arguments`` with this tree's packages."""
    return subprocess.Popen(
        [sys.executable, *arguments],
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[1])},
    )


def left_by(parent: subprocess.Popen[str], workers: list[int], how: signal.Signals) -> list[int]:
    """End ``parent``; return which of its workers stay, and kill them."""
    assert parent.stdout is not None
    parent.send_signal(how)
    parent.wait()
    parent.stdout.close()
    with contextlib.suppress(AssertionError):  # who stays is told by name
        until("the workers end", lambda: not any(map(is_running, workers)), PATIENCE_S)
    left = [pid for pid in workers if is_running(pid)]
    for pid in left:
        kill(pid)
    return left


def children(pid: int) -> list[int]:
    """Return the processes that a process has begun, in any of its threads, and not ended."""
    found = []
    for thread in Path(f"/proc/{pid}/task").glob("*/children"):
        with contextlib.suppress(OSError):
            found += [int(child) for child in thread.read_text().split()]
    return found


def descendants(pid: int) -> list[int]:
    """Return the processes that a process has begun, and those that these have."""
    own = children(pid)
    return [*own, *(below for child in own for below in descendants(child))]
