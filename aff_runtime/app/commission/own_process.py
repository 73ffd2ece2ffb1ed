"""What a process that works for the commissioner does first: it gives way, and ends with it."""

from __future__ import annotations

import ctypes
import os
import resource
import signal

from aff_runtime.base.process_bounds import bound_process

LOWEST = 19
_PR_SET_PDEATHSIG = 1
OOM_SCORE = 900


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

    What began this process has left the processor of the control process already. Where memory
    runs out this one goes first. A hard limit that is lower stays.
    """
    end_with_parent()
    os.nice(LOWEST)
    limits = {resource.RLIMIT_CPU: processor_s, resource.RLIMIT_FSIZE: file_bytes}
    bound_process(limits, oom_score=OOM_SCORE)
