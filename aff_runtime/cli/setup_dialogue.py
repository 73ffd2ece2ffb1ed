"""Who answers `setup`: a technician at a terminal, or a file that says everything."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from aff_runtime.app.setup.draft import Draft, write_draft
from aff_runtime.app.setup.questions import AnswerError, Question
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.units import UnitError
from aff_runtime.cli.terminal import ask, complain, say
from aff_runtime.config.findings import SiteFileError
from aff_runtime.config.yaml_marks import MarkedTree, read_marked

LEAVE = "q"


class LeftError(Exception):
    """The technician leaves; what is known is kept."""


class Script:
    """Answers from a file, by the names of the questions; as they are written there."""

    def __init__(self, path: Path) -> None:
        self._tree: MarkedTree = read_marked(path)
        self._asked: set[str] = set()
        self._texts: Mapping[str, str] = {
            name: self._tree.marks[(name,)].written for name in self._tree.values
        }
        lists = [
            name for name, value in self._tree.values.items() if isinstance(value, dict | tuple)
        ]
        if lists:
            raise SiteFileError(
                [self._tree.finding((name,), "write one answer, as text.") for name in lists]
            )

    def answer(self, question: Question) -> str:
        """Return what the file says, else the default."""
        self._asked.add(question.name)
        text = self._texts.get(question.name, question.default)
        if text is None:
            what = f"no answer to {question.name}: {question.text}. Add it."
            raise SiteFileError([self._tree.finding((), what)])
        return text

    def refused(self, question: Question, why: str) -> SiteFileError:
        """Return the error for an answer that cannot be taken."""
        return SiteFileError([self._tree.finding((question.name,), why)])

    def has(self, name: str) -> bool:
        """Return whether the file itself answers a question."""
        return name in self._texts

    def left_over(self, draft: Draft) -> list[str]:
        """Return findings for what nobody asked for, and no quantity that was kept answers."""
        known = {f"{channel}.{part}" for channel in draft.words for part in ("display", "pick")}
        left = [name for name in self._texts if name not in self._asked | known]
        return [str(self._tree.finding((name,), "was not asked for.")) for name in left]


class Dialogue:
    """Asks, keeps and says again.

    Parameters
    ----------
    draft : what is known; ``path`` : where it is kept.
    script : answers from a file; None: the terminal.
    """

    def __init__(self, draft: Draft, path: Path, script: Script | None) -> None:
        self.draft = draft
        self.path = path
        self.script = script

    def keep(self, draft: Draft) -> None:
        """Keep what is known now."""
        self.draft = draft
        try:
            write_draft(self.path, draft)
        except OSError as error:
            raise ConfigError(f"{self.path}: cannot be written: {error.strerror}") from error

    def ask(self, question: Question) -> str:
        """Return the answer to a question, which is kept: the file's, the kept one, a new one."""
        kept = self.draft.answers.get(question.name)
        if kept is not None and not (self.script is not None and self.script.has(question.name)):
            return self._checked(question, kept)
        answer = self.ask_anew(question)
        self.keep(self.draft.with_answer(question.name, answer))
        return answer

    def ask_anew(self, question: Question) -> str:
        """Return an answer that is not kept."""
        while True:
            text = self._text(question)
            try:
                return question.default if text == question.default else question.read(text)
            except (AnswerError, UnitError) as error:
                if self.script is not None:
                    raise self.script.refused(question, str(error)) from None
                complain(f"  {error}")

    def _checked(self, question: Question, kept: str) -> str:
        try:
            answer = kept if kept == question.default else question.read(kept)
        except (AnswerError, UnitError) as error:
            raise ConfigError(
                f"{self.path}: answers.{question.name}: {error} Correct it there, or ask again "
                f"with `--again {question.name}`."
            ) from None
        say(f"  {question.name}: {answer} (kept)")
        return answer

    def _text(self, question: Question) -> str:
        if self.script is not None:
            text = self.script.answer(question)
            say(f"{question.text}: {text}")
            return text
        default = f" [{question.default}]" if question.default else ""
        try:
            text = ask(f"{question.text}{default}:").strip()
        except EOFError:
            raise LeftError from None
        if text == LEAVE:
            raise LeftError
        return text or question.default or ""


def row_reader(
    rows: Mapping[int, str], at: Mapping[int, int], *words: str
) -> Callable[[str], str]:
    """Return the reader of a row's number, of its word such as w5 by ``at``, or of ``words``."""

    def read(text: str) -> str:
        shown = text.strip()
        named = [n for n, address in at.items() if shown == f"w{address}"]
        if named:
            return str(named[0])
        if shown in words or (shown.isdecimal() and int(shown) in rows):
            return shown
        last = f"1 to {max(rows)}" if rows else "no row"
        raise AnswerError(f'"{shown[:40]}": write {" or ".join([last, *words])}.')

    return read
