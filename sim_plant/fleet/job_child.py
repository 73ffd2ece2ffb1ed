"""The process that does one job: ``python -m sim_plant.fleet.job_child LIFELINE``.

Its work comes pickled on standard input, from our own process; the answer goes out the same way.
When the other end of LIFELINE closes, its caller is gone: it ends, and all that it started.
"""

from __future__ import annotations

import os
import pickle
import signal
import sys
import threading
import traceback

from sim_plant.fleet.job_process import DONE, RAISED


def main() -> int:
    """Do the job and write what it came to; return the exit code."""
    threading.Thread(target=_end_with_caller, args=(int(sys.argv[1]),), daemon=True).start()
    answer_to = os.dup(1)
    os.dup2(2, 1)  # what the job prints must not come between
    paths, work_and_job = pickle.load(sys.stdin.buffer)
    sys.path += [path for path in paths if path not in sys.path]
    try:
        work, job = pickle.loads(work_and_job)
        answer = (DONE, work(job))
    except Exception as error:
        error.add_note(f"in the process of the job:\n{traceback.format_exc()}")
        answer = (RAISED, error)
    with os.fdopen(answer_to, "wb") as out:
        out.write(pickle.dumps(answer))
    return 0


def _end_with_caller(lifeline: int) -> None:
    while os.read(lifeline, 1):
        pass
    os.killpg(0, signal.SIGKILL)  # the leader of a group of its own, and what it has started


if __name__ == "__main__":
    raise SystemExit(main())
