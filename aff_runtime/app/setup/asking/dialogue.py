"""Asks, keeps answers, and shows kept ones; who answers is a terminal, a file, or a screen."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from aff_runtime.app.setup.asking.draft import Draft, write_draft
from aff_runtime.app.setup.asking.questions import AnswerError, Question
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.units import UnitError


class LeftError(Exception):
    """The technician leaves; what is known is kept."""


class Asker(Protocol):
    """Who answers.

    Attributes
    ----------
    is_patient : somebody is there who can try again; else the first refusal ends setup.
    """

    is_patient: bool

    def answers_itself(self, name: str) -> bool:
        """Return whether it has an answer of its own, which goes before the kept one."""

    def answer(self, question: Question) -> str:
        """Return what is answered, as typed; ``LeftError`` when somebody leaves."""

    def refuse(self, question: Question, why: str) -> None:
        """Say why an answer cannot be taken; raises where nobody can give another one."""

    def say(self, line: str) -> None:
        """Say how it goes."""

    def complain(self, line: str) -> None:
        """Say what is wrong."""


class Dialogue:
    """Asks questions, and keeps the answers in a draft.

    Parameters
    ----------
    draft : what is known; ``path`` : where it is kept.
    """

    def __init__(self, draft: Draft, path: Path, asker: Asker) -> None:
        self.draft = draft
        self.path = path
        self.asker = asker

    @property
    def is_patient(self) -> bool:
        """Whether somebody is there who can try again."""
        return self.asker.is_patient

    def say(self, line: str) -> None:
        """Say how it goes."""
        self.asker.say(line)

    def complain(self, line: str) -> None:
        """Say what is wrong."""
        self.asker.complain(line)

    def keep(self, draft: Draft) -> None:
        """Keep what is known now."""
        self.draft = draft
        try:
            write_draft(self.path, draft)
        except OSError as error:
            raise ConfigError(f"{self.path}: cannot be written: {error.strerror}") from error

    def ask(self, question: Question) -> str:
        """Return the answer, and keep it: the asker's own, else the kept one, else a new one."""
        kept = self.draft.answers.get(question.name)
        if kept is not None and not self.asker.answers_itself(question.name):
            return self._checked(question, kept)
        answer = self.ask_anew(question)
        self.keep(self.draft.with_answer(question.name, answer))
        return answer

    def ask_anew(self, question: Question) -> str:
        """Return an answer that is not kept."""
        while True:
            text = self.asker.answer(question)
            try:
                return question.default if text == question.default else question.read(text)
            except (AnswerError, UnitError) as error:
                self.asker.refuse(question, str(error))

    def _checked(self, question: Question, kept: str) -> str:
        try:
            answer = kept if kept == question.default else question.read(kept)
        except (AnswerError, UnitError) as error:
            raise ConfigError(
                f"{self.path}: answers.{question.name}: {error} Correct it there, or ask again "
                f"with `--again {question.name}`."
            ) from None
        self.say(f"  {question.name}: {answer} (kept)")
        return answer


@dataclass(frozen=True, slots=True, kw_only=True)
class RowReader:
    """Takes a row's number, its word such as w5, or one of ``choices``.

    ``at`` : wire address by row.
    ``unsure`` : why an empty answer does not take row 1; empty where it does.
    """

    rows: frozenset[int]
    at: Mapping[int, int]
    choices: tuple[str, ...]
    unsure: str = ""

    def __call__(self, text: str) -> str:
        """Return the row's number, or the choice."""
        shown = text.strip()
        named = [n for n, address in self.at.items() if shown == f"w{address}"]
        if named:
            return str(named[0])
        if shown in self.choices or (shown.isdecimal() and int(shown) in self.rows):
            return shown
        rows = [f"1 to {max(self.rows)}"] if self.rows else []
        takes = " or ".join([*rows, *self.choices])
        if not shown and self.unsure:
            raise AnswerError(f"no row is taken unasked: {self.unsure}. Write {takes}.")
        raise AnswerError(f'"{shown[:40]}": write {takes}.')
