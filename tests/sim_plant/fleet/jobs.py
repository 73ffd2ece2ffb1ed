"""What the tests give to workers; found there by import."""

import os
import signal
import subprocess
import time
from pathlib import Path


def half(number):
    print("a word on standard output")  # which must not come between
    if number < 0:
        raise ValueError(f"no half of {number}")
    return number / 2


def failed(order):
    """Return the result of a look that could not be refined."""
    from sim_plant.fleet.refine_look import LookResult  # the other jobs do without

    look = order.look
    return LookResult(
        line=look.line, recorded=look.recorded, verdict=None, error="no line", time_s=1.0
    )


def killed_at_first(marks):
    """End by a kill the first time, answer the second: each try leaves a mark."""
    tries = len(list(Path(marks).iterdir()))
    (Path(marks) / str(tries)).touch()
    if tries == 0:
        os.kill(os.getpid(), signal.SIGKILL)
    return tries


def long_and_not_alone(note):
    """Start a process, note its number, and stay."""
    child = subprocess.Popen(["sleep", "600"])
    Path(note).write_text(str(child.pid), encoding="utf-8")
    time.sleep(600.0)


def waiting_for(files):
    """Note who does it, wait for a file to be there, and return its text."""
    note, wanted = map(Path, files)
    with note.open("a", encoding="utf-8") as out:
        out.write(f"{os.getppid()}\n")
    while not wanted.exists():
        time.sleep(0.01)
    return wanted.read_text(encoding="utf-8")


def one_waits(order):
    """Refine a look to a row; that of the line ``film2`` notes its worker and waits for a file."""
    folder = order.look.file.parent
    if order.look.line == "film2":
        waiting_for((folder / "who", folder / "wanted"))
    return failed(order)
