"""A screen finds the PLC's words: the interview of `aff-runtime setup`, answered at the screen."""

from __future__ import annotations

from aff_runtime.app.commission.link.answers import Done
from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.link.talk import Talk
from aff_runtime.app.commission.paths import Paths, status_of
from aff_runtime.app.setup.asking.dialogue import Dialogue, LeftError
from aff_runtime.app.setup.asking.draft import read_draft
from aff_runtime.app.setup.asking.questions import Question
from aff_runtime.app.setup.flow import content_of, interview, write
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.signals import State

LIVE_STATES = (State.ARMED.name, State.ACTIVE.name, State.FADING.name)
"""In which a correction may be going out, as `TickRow.is_live` has it."""


class ScreenAsker:
    """An `Asker`: puts what is asked on a screen, where somebody can always try again."""

    is_patient = True

    def __init__(self, talk: Talk) -> None:
        self._talk = talk

    def answers_itself(self, name: str) -> bool:
        """Return False: a screen has no answers of its own, such as a file of them has."""
        return False

    def answer(self, question: Question) -> str:
        """Return what is answered, else the default; ``LeftError`` when somebody leaves."""
        try:
            text = self._talk.ask(
                question.name,
                question.text,
                question.default,
                choices=question.choices,
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


def find_words(where: Paths, asked: Request, talk: Talk) -> Done:
    """Find the PLC's words and write the site file.

    Parameters
    ----------
    asked : its ``again`` holds names of questions or quantities, separated by spaces, that were
        answered or found before and shall be asked once more.

    Raises
    ------
    RefusedError
        A correction may be going out, or somebody has saved the site file meanwhile.
    AffError
        It cannot go on; what was answered is kept beside the site file.
    """
    status = status_of(where.socket)
    if status is not None and status.state in LIVE_STATES:
        raise RefusedError("a correction goes out; bypass first")
    kept_in = where.site.with_suffix(".setup.json")
    draft = read_draft(kept_in)
    for name in asked.again.split():
        draft = draft.without(name)
    dialogue = Dialogue(draft, kept_in, ScreenAsker(talk))
    before = content_of(where.site)
    try:
        interview(dialogue)
        is_written = write(dialogue, where.site, before)
    except LeftError:
        return Done(text="left; what was answered is kept")
    return Done(text=f"wrote {where.site}" if is_written else "the site file stays as it is")
