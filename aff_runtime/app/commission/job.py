"""``python -m aff_runtime.app.commission.job``: one job of the commissioner, in its own process.

Its first line on stdin says what to do. It may take minutes, parse foreign records and wait for
an answer; who has it done can end it at any moment. It ends with its commissioner: a later one
would take it for ended, and do the same beside it.
"""

from __future__ import annotations

import ctypes
import json
import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path

from aff_runtime.app.commission import card_jobs, line_view, settings_jobs, setup_jobs
from aff_runtime.app.commission.messages import Request, Told
from aff_runtime.app.commission.sources import Where
from aff_runtime.app.commission.talk import Talk
from aff_runtime.base.errors import AffError

Job = Callable[[Where, Request, Talk], Told]
JOBS: dict[str, Job] = {
    "card": card_jobs.card,
    "page": card_jobs.printed,
    "begin": card_jobs.begin,
    "step": card_jobs.step,
    "sign": card_jobs.sign,
    "verify": card_jobs.verified,
    "line": line_view.line,
    "words": setup_jobs.words,
    "try": settings_jobs.try_proposed,
    "keep": settings_jobs.keep,
    "undo": settings_jobs.undo,
}
NICE = 10
_PR_SET_PDEATHSIG = 1


def main() -> int:
    """Do what the first line says; the last line said is what became of it."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    os.nice(NICE)
    _leave_to_control()
    said = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # whatever a library prints is no line of ours
    talk = Talk(sys.stdin, said)
    first = json.loads(sys.stdin.readline())
    if os.getppid() != first.pop("parent"):  # it had ended before we asked to end with it
        return 1
    where = Where(**{name: Path(path) for name, path in first.pop("where").items()})
    asked = Request.from_json(first)
    try:
        talk.tell({"done": JOBS[asked.do](where, asked, talk)})
    except AffError as error:
        talk.tell({"refused": str(error)})
    except EOFError:
        return 1
    return 0


def _leave_to_control() -> None:
    """Keep off the last processor, which the control process has to itself where there are two."""
    allowed = sorted(os.sched_getaffinity(0))
    if len(allowed) > 1:
        os.sched_setaffinity(0, allowed[:-1])


if __name__ == "__main__":
    sys.exit(main())
