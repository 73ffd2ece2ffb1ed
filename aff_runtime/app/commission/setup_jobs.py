"""The words of the PLC for a screen: the interview of `aff-runtime setup`, answered elsewhere."""

from __future__ import annotations

from aff_runtime.app.commission.answers import Done
from aff_runtime.app.commission.messages import Request
from aff_runtime.app.commission.sources import Paths, status_of
from aff_runtime.app.commission.talk import Talk
from aff_runtime.app.setup.dialogue import Dialogue, LeftError
from aff_runtime.app.setup.draft import read_draft
from aff_runtime.app.setup.flow import content_of, interview, write
from aff_runtime.app.setup.questions import Question
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.signals import State

GOES_OUT = (State.ARMED.name, State.ACTIVE.name, State.FADING.name)


class Screen:
    """Somebody at a screen, who can always try again."""

    is_patient = True

    def __init__(self, talk: Talk) -> None:
        self._talk = talk

    def answers_itself(self, name: str) -> bool:
        """Return False: whoever is at the screen has not answered yet."""
        return False

    def answer(self, question: Question) -> str:
        """Return what is answered, else the default."""
        try:
            text = self._talk.ask(
                question.name,
                question.text,
                question.default,
                choices=question.words,
                rows=question.rows,
            )
        except EOFError:
            raise LeftError from None
        return text.strip() or question.default or ""

    def refuse(self, question: Question, why: str) -> None:
        """Say why; the question is asked again."""
        self._talk.complain(why)

    def say(self, line: str) -> None:
        """Say how it goes."""
        self._talk.say(line.strip())

    def complain(self, line: str) -> None:
        """Say what is wrong."""
        self._talk.complain(line)


def words(where: Paths, asked: Request, talk: Talk) -> Done:
    """Find the PLC's words and write the site file.

    Raises
    ------
    AffError
        It cannot go on; what was answered is kept beside the site file.
    """
    status = status_of(where.socket)
    if status is not None and status.state in GOES_OUT:
        raise RefusedError("a correction goes out; bypass first")
    kept_in = where.site.with_suffix(".setup.json")
    draft = read_draft(kept_in)
    for name in asked.again.split():
        draft = draft.without(name)
    dialogue = Dialogue(draft, kept_in, Screen(talk))
    before = content_of(where.site)
    try:
        interview(dialogue)
        is_written = write(dialogue, where.site, before)
    except LeftError:
        return Done(text="left; what was answered is kept")
    return Done(text=f"wrote {where.site}" if is_written else "the site file stays as it is")
