"""What becomes of the workers of a killed process."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

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
        [sys.executable, *arguments], stdout=subprocess.PIPE, text=True,
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[1])},
    )  # fmt: skip


def left_by(parent: subprocess.Popen[str], workers: list[int], how: signal.Signals) -> list[int]:
    """End ``parent``; return which of its workers stay, and kill them."""
    assert parent.stdout is not None
    parent.send_signal(how)
    parent.wait()
    parent.stdout.close()
    end = time.monotonic() + PATIENCE_S
    while any(map(_runs, workers)) and time.monotonic() < end:
        time.sleep(0.05)
    left = [pid for pid in workers if _runs(pid)]
    for pid in left:
        os.kill(pid, signal.SIGKILL)
    return left


def children(pid: int) -> list[int]:
    """Return the processes that a process has begun and not ended."""
    try:
        return [int(c) for c in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except OSError:
        return []


def _runs(pid: int) -> bool:
    """Return whether a process is there and no zombie."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"
