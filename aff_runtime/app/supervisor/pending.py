"""Questions to the control process that still wait for their reply."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from aff_runtime.app.link.answers import Done
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.link.request_socket import Asked, Caller
from aff_runtime.base.ports import Clock

AnswerOf = Callable[[Reply], Done]


@dataclass(slots=True, kw_only=True)
class _Question:
    """Who asked (None: the supervisor itself), how to answer, until when."""

    asked: Asked | None
    answer: AnswerOf
    until_ns: int


class Pending:
    """Matches replies to questions by number; every question gets exactly one answer."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._questions: dict[int, _Question] = {}
        self._last = 0

    def expect(self, asked: Asked | None, answer: AnswerOf, patience_s: float) -> int:
        """Return the number of a new question."""
        self._last += 1
        until_ns = self._clock.now_ns() + int(patience_s * 1e9)
        self._questions[self._last] = _Question(asked=asked, answer=answer, until_ns=until_ns)
        return self._last

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
