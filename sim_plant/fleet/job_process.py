"""One job in a process of its own, with a limit of time; what runs on a worker of the cluster."""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable
from typing import Any

from aff_runtime.base.python_child import module_command

THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_NUM_THREADS")


DONE, RAISED, ENDED = "done", "raised", "ended"
"""What a job came to: its result, what it raised, how its process was lost."""

Outcome = tuple[str, Any]


def orders(work: Callable[[Any], Any], job: Any) -> bytes:
    """Return what the process of a job is told: where its modules are, what to do, with what."""
    return pickle.dumps(([path for path in sys.path if path], pickle.dumps((work, job))))


def in_own_process(told: bytes, limit_s: float) -> Outcome:
    """Do a job; return what it came to: (``DONE``, result), (``RAISED``, error), (``ENDED``, why).

    One that takes longer than ``limit_s`` is ended, with all that it started. Nothing is raised:
    Dask would log every loss with its call stack.
    """
    lifeline, ours = os.pipe()
    try:
        with subprocess.Popen(
            [*module_command("sim_plant.fleet.job_child"), str(lifeline)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            pass_fds=(lifeline,),
            start_new_session=True,
            env={**dict.fromkeys(THREADS, "1"), **os.environ},
        ) as child:
            try:
                answer, _ = child.communicate(told, timeout=limit_s)
            except subprocess.TimeoutExpired:
                return ENDED, f"took longer than {limit_s:g} s"
            finally:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(child.pid, signal.SIGKILL)
    finally:
        os.close(ours)
        os.close(lifeline)
    if child.returncode != 0 or not answer:
        code = child.returncode
        return ENDED, f"ended by signal {-code}" if code < 0 else f"ended with code {code}"
    outcome: Outcome = pickle.loads(answer)
    return outcome
