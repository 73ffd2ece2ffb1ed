"""``python -m aff_runtime.app.commission.job``: one job of the commissioner, in its own process.

Its first line on stdin says what to do. It may take minutes, parse foreign records and wait for
an answer; whoever asked for it can end it at any moment. It ends with its commissioner: one that
is started later would think it ended, and start it again beside it.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable

from aff_runtime.app.commission.background_process import LOWEST, end_with_parent, leave_to_control
from aff_runtime.app.commission.card import jobs as card_jobs
from aff_runtime.app.commission.line import setup_jobs
from aff_runtime.app.commission.line import view as line_view
from aff_runtime.app.commission.link.answers import Answer
from aff_runtime.app.commission.link.job_lines import Ended, Refused, read_start
from aff_runtime.app.commission.link.messages import LONG, Request
from aff_runtime.app.commission.link.talk import Talk
from aff_runtime.app.commission.paths import Paths
from aff_runtime.app.commission.records import maintenance_jobs, refine_jobs
from aff_runtime.app.commission.settings import form_jobs as settings_form_jobs
from aff_runtime.app.commission.settings import jobs as settings_jobs
from aff_runtime.app.commission.settings import text_jobs as settings_text_jobs
from aff_runtime.base.errors import AffError

Job = Callable[[Paths, Request, Talk], Answer]
JOBS: dict[str, Job] = {
    "card": card_jobs.card,
    "page": card_jobs.printed,
    "begin": card_jobs.begin,
    "step": card_jobs.step,
    "sign": card_jobs.sign,
    "verify": card_jobs.verified,
    "line": line_view.line,
    "words": setup_jobs.find_words,
    "try": settings_jobs.try_proposed,
    "keep": settings_jobs.keep,
    "undo": settings_jobs.undo,
    "refining": refine_jobs.refining,
    "refined": refine_jobs.refined,
    "refined_page": refine_jobs.page,
    "lacks": refine_jobs.lacks,
    "refine": refine_jobs.refine,
    "try_refined": refine_jobs.try_refined,
    "maintenance": maintenance_jobs.maintenance,
    "add_runs": maintenance_jobs.add_runs,
    "exchange": maintenance_jobs.exchange,
    "settings": settings_form_jobs.form,
    "settings_version": settings_form_jobs.version,
    "settings_diff": settings_form_jobs.difference,
    "settings_text": settings_text_jobs.text,
    "try_settings": settings_form_jobs.try_edited,
    "save_settings": settings_form_jobs.save_edited,
    "go_back": settings_form_jobs.go_back,
}
NICE = 10
"""Of a job of seconds, for which somebody waits: behind the service, before jobs of hours."""


def main() -> int:
    """Do what the first line says; the last line said is what became of it.

    Nothing is said of it, and 1 is returned, where the commissioner has gone: it had ended before
    the job began, or stdin ended while the job waited for an answer that it needs.
    """
    end_with_parent()
    leave_to_control()
    said = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # whatever a library prints is no line of ours
    talk = Talk(sys.stdin, said)
    start = read_start(sys.stdin.readline())
    if os.getppid() != start.parent:  # it had ended before we asked to end with it
        return 1
    os.nice(LOWEST if start.asked.do in LONG else NICE)
    try:
        talk.tell(Ended(answer=JOBS[start.asked.do](start.where, start.asked, talk)))
    except AffError as error:
        talk.tell(Refused(text=str(error)))
    except EOFError:
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
