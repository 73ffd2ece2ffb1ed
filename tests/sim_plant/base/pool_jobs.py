"""What the workers of a pool do in tests; a worker imports this and nothing heavy."""

import os
import signal
from pathlib import Path

_begun = []


class OddError(Exception):
    """An error that cannot be made again from its arguments."""

    def __init__(self, what, why):
        super().__init__(f"{what}: {why}")


def half(number):
    if number == 3:
        raise ValueError("three has no half")
    if number == 5:
        raise OddError("five", "has no half either")
    return number // 2, os.getpid(), tuple(_begun)


def remember(word):
    _begun.append(word)


def refuse():
    raise ValueError("nothing to begin with")


def end_of(job):
    """Note who is at work at the same time, and end the worker where the job says so."""
    folder, name, ends = job
    here = Path(folder, "at-work", name)
    here.touch()
    Path(folder, f"{name} {os.getpid()}").write_text(
        " ".join(sorted(p.name for p in here.parent.iterdir()))
    )
    if ends:
        here.unlink()
        os.kill(os.getpid(), signal.SIGKILL)
    here.unlink()
    return name
