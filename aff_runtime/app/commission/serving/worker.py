"""One job in a process of its own, and what it has said."""

from __future__ import annotations

import asyncio
import contextlib
import os
from collections import deque

from aff_runtime.app.check.limits import ONE_THREAD
from aff_runtime.app.commission.link.answers import Answer
from aff_runtime.app.commission.link.job_lines import (
    Ended,
    Refused,
    Reply,
    Start,
    encode,
    read_line,
)
from aff_runtime.app.commission.link.messages import MAX_TOLD_BYTES, Refusal, Request, Why
from aff_runtime.app.commission.paths import Paths
from aff_runtime.app.commission.views.of_line import QuestionView, SaidLine
from aff_runtime.app.supervisor.child_environment import without_service_manager
from aff_runtime.base.python_child import talking_child

JOB = "aff_runtime.app.commission.job"
KEPT_LINES = 40  # newest lines of a job, for a screen
DIED = "its process ended without an answer; see the log of the commissioner"
STOPPED = "stopped"
CUT = "stopped; look at the card and the site file"  # of a job that may have changed something
KILLED = "its commissioner was ended before it answered; look at the card and the site file"
KEEPS = (
    "begin",
    "step",
    "sign",
    "words",
    "try",
    "keep",
    "undo",
    "try_refined",
    "exchange",
    "try_settings",
    "save_settings",
    "go_back",
)
"""Jobs that may have changed what lasts before they said so: a file, the settings that run."""


class Worker:
    """Runs one job.

    Attributes
    ----------
    asked : what it does. ``said`` : its newest lines.
    question : what it waits for; None where it waits for nothing.
    is_unsure : it was ended without an answer, and may have changed what lasts (``KEEPS``).
    """

    def __init__(self, asked: Request, where: Paths) -> None:
        self.asked = asked
        self.said: deque[SaidLine] = deque(maxlen=KEPT_LINES)
        self.question: QuestionView | None = None
        self.is_unsure = False
        self._where = where
        self._process: asyncio.subprocess.Process | None = None
        self._is_stopped = False

    async def run(self) -> Answer:
        """Return the job's answer, or a refusal; an answer that came before a stop counts."""
        environment = without_service_manager() | ONE_THREAD
        self._process = process = await talking_child(JOB, environment, MAX_TOLD_BYTES)
        self._write(Start(asked=self.asked, where=self._where, parent=os.getpid()))
        answer: Answer | None = None
        if self._is_stopped:
            process.kill()
        assert process.stdout is not None
        try:
            with contextlib.suppress(ValueError):  # no line of ours: it has not answered
                while line := await process.stdout.readline():
                    answer = self._hear(line) or answer
        finally:
            self.is_unsure = answer is None and self.asked.do in KEEPS
            if process.returncode is None and not self._is_stopped:
                process.kill()
            await process.wait()
        self.question = None
        return answer or Refusal(why=Why.REFUSED, name=self._unanswered())

    def answer(self, number: int, text: str) -> bool:
        """Give a person's answer to the job; False when it waits for another question or none."""
        if self.question is None or self.question.number != number:
            return False
        self.question = None
        self._write(Reply(number=number, text=text))
        return True

    def stop(self) -> None:
        """Kill the job; ``run`` then returns."""
        self._is_stopped = True
        self.question = None
        if self._process is not None and self._process.returncode is None:
            self._process.kill()

    def _hear(self, line: bytes) -> Answer | None:
        """Take one line; the answer when it is the last one."""
        match read_line(self.asked.do, line):
            case SaidLine() as said:
                self.said.append(said)
            case QuestionView() as question:
                self.question = None if self._is_stopped else question
            case Ended() as ended:
                return ended.answer
            case Refused() as refused:
                return Refusal(why=Why.REFUSED, name=refused.text)
        return None

    def _unanswered(self) -> str:
        if not self._is_stopped:
            return DIED
        return CUT if self.is_unsure else STOPPED

    def _write(self, said: Start | Reply) -> None:
        assert self._process is not None
        assert self._process.stdin is not None
        self._process.stdin.write(encode(said).encode() + b"\n")
