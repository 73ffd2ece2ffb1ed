"""How a process that works for the commissioner begins: behind control, tied to its parent."""

from __future__ import annotations

import ctypes
import os
import resource
import signal

from aff_runtime.base.process_bounds import bound_process

LOWEST = 19
"""Nice value: last of all processes."""
_PR_SET_PDEATHSIG = 1
OOM_SCORE = 900
"""Of 1000: among the first to go where memory runs out, long before the service."""


def end_with_parent() -> None:
    """Have the kernel end this process when the one that began it ends."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)


def leave_to_control() -> None:
    """Keep off the last processor, which the control process has to itself where there are two."""
    allowed = sorted(os.sched_getaffinity(0))
    if len(allowed) > 1:
        os.sched_setaffinity(0, allowed[:-1])


def give_way(processor_s: int, file_bytes: int) -> None:
    """Take the lowest priority, and bound processor time and the size of a file.

    Which processors it may use it has from its parent, a job, which keeps off that of the control
    process. Where memory runs out this one goes first. A hard limit that is lower stays.
    """
    end_with_parent()
    os.nice(LOWEST)
    limits = {resource.RLIMIT_CPU: processor_s, resource.RLIMIT_FSIZE: file_bytes}
    bound_process(limits, oom_score=OOM_SCORE)
