"""How a job speaks with its commissioner: lines of JSON, out on stdout and in on stdin."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TextIO

from aff_runtime.app.commission.link.job_lines import JobLine, encode, read_reply
from aff_runtime.app.commission.views.of_line import QuestionView, SaidLine
from aff_runtime.base.printable import printable

LONGEST = 600  # characters of a line


class Talk:
    """The job's end of the conversation.

    Parameters
    ----------
    heard : where answers come from. ``said`` : where lines go.
    """

    def __init__(self, heard: TextIO, said: TextIO) -> None:
        self._heard = heard
        self._said = said
        self._number = 0

    def say(self, text: str) -> None:
        """Say how it goes."""
        self.tell(SaidLine(kind="say", text=printable(text, LONGEST)))

    def complain(self, text: str) -> None:
        """Say what is wrong."""
        self.tell(SaidLine(kind="complain", text=printable(text.strip(), LONGEST)))

    def ask(
        self,
        name: str,
        text: str,
        default: str | None,
        *,
        choices: Sequence[str] = (),
        rows: Sequence[tuple[str, str]] = (),
    ) -> str:
        """Return what is answered; EOFError when the commissioner has gone.

        Parameters
        ----------
        name : of the question. ``default`` : taken when nothing is said; None: something must be.
        choices : words that may be answered. ``rows`` : answer and text of what may be picked.
        """
        self._number += 1
        asked = QuestionView(
            number=self._number,
            name=name,
            text=text,
            default=default,
            choices=tuple(choices),
            rows=tuple(rows),
        )
        self.tell(asked)
        while line := self._heard.readline():
            said = read_reply(line)
            if said.number == self._number:
                return said.text
        raise EOFError

    def tell(self, said: JobLine) -> None:
        """Say one thing."""
        self._said.write(encode(said) + "\n")
        self._said.flush()
