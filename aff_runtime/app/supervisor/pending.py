"""Questions to the control process that still wait for their reply."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from aff_runtime.app.link.answers import Done
from aff_runtime.app.link.messages import Question
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.link.request_socket import Asked, Caller
from aff_runtime.app.supervisor.control_child import ControlChild
from aff_runtime.base.ports import Clock

AnswerOf = Callable[[Reply], Done]
PATIENCE_S = 2.0  # with the control process
REPLY_NS = 500_000_000  # of that, for the reply to what is done at the last moment
NOT_RUNNING = "the control process is not running; see `aff-runtime status`"


@dataclass(slots=True, kw_only=True)
class _Waiting:
    """Who asked (None: the supervisor itself), how to answer, until when."""

    asked: Asked | None
    answer: AnswerOf
    until_ns: int


class Pending:
    """Matches replies to questions by number; every question gets exactly one answer."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._questions: dict[int, _Waiting] = {}
        self._last = 0

    def ask(
        self,
        control: ControlChild | None,
        question: Question,
        answer: AnswerOf,
        *,
        asked: Asked | None = None,
        not_sent: str = NOT_RUNNING,
    ) -> None:
        """Put a question to the control process; it has one answer, now or later.

        Parameters
        ----------
        control : None while there is none.
        answer : makes one of the reply, for ``asked`` where somebody waits for it.
        not_sent : what is replied when it cannot be asked.
        """
        self._last += 1
        until_ns = self._clock.now_ns() + int(PATIENCE_S * 1e9)
        self._questions[self._last] = _Waiting(asked=asked, answer=answer, until_ns=until_ns)
        said = replace(question, id=self._last, valid_until_ns=until_ns - REPLY_NS)
        if control is None or not control.link.send(said):
            self.resolve(Reply(id=said.id, ok=False, message=not_sent))

    def resolve(self, reply: Reply) -> None:
        """Answer the question of this number; a late reply has none and is dropped."""
        question = self._questions.pop(reply.id, None)
        if question is None:
            return
        answer = question.answer(reply)
        if question.asked is not None:
            question.asked.answer(answer)

    def expire(self) -> None:
        """Answer those who have waited too long."""
        now_ns = self._clock.now_ns()
        for ident, question in list(self._questions.items()):
            if now_ns >= question.until_ns:
                text = "the control process did not reply in time"
                self.resolve(Reply(id=ident, ok=False, message=text))

    def refuse_all(self, text: str) -> None:
        """Answer everybody with a refusal."""
        for ident in list(self._questions):
            self.resolve(Reply(id=ident, ok=False, message=text))

    def forget(self, caller: Caller) -> None:
        """Answer nobody where the caller has hung up; what else a reply does is still done."""
        for question in self._questions.values():
            if question.asked is not None and question.asked.caller is caller:
                question.asked = None
