"""Who answers `setup` on the console: a technician at a terminal, or a file that says all."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from aff_runtime.app.setup.asking.dialogue import LeftError
from aff_runtime.app.setup.asking.draft import Draft
from aff_runtime.app.setup.asking.questions import Question
from aff_runtime.cli.terminal import ask, complain, say
from aff_runtime.config.findings import SiteFileError
from aff_runtime.config.yaml_marks import MarkedTree, read_marked

LEAVE = "q"


class _Console:
    """What terminal and file have in common: lines are printed."""

    def say(self, line: str) -> None:
        """Print how it goes."""
        say(line)

    def complain(self, line: str) -> None:
        """Print what is wrong."""
        complain(line)

    def _rows(self, question: Question) -> None:
        for value, row in question.rows:
            say(f"  {value}: {row}")


class Terminal(_Console):
    """A technician who types."""

    is_patient = True

    def answers_itself(self, name: str) -> bool:
        """Return False: whoever types has not typed yet."""
        return False

    def answer(self, question: Question) -> str:
        """Return what is typed, else the default."""
        self._rows(question)
        default = f" [{question.default}]" if question.default else ""
        try:
            text = ask(f"{question.text}{default}:").strip()
        except EOFError:
            raise LeftError from None
        if text == LEAVE:
            raise LeftError
        return text or question.default or ""

    def refuse(self, question: Question, why: str) -> None:
        """Say why; the question is asked again."""
        complain(f"  {why}")


class Script(_Console):
    """Answers from a file, by the names of the questions; as they are written there."""

    is_patient = False

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

    def answers_itself(self, name: str) -> bool:
        """Return whether the file itself answers a question."""
        return name in self._texts

    def answer(self, question: Question) -> str:
        """Return what the file says, else the default."""
        self._rows(question)
        self._asked.add(question.name)
        text = self._texts.get(question.name, question.default)
        if text is None:
            what = f"no answer to {question.name}: {question.text}. Add it."
            raise SiteFileError([self._tree.finding((), what)])
        say(f"{question.text}: {text}")
        return text

    def refuse(self, question: Question, why: str) -> None:
        """Raise the error for an answer that cannot be taken."""
        raise SiteFileError([self._tree.finding((question.name,), why)])

    def left_over(self, draft: Draft) -> list[str]:
        """Return findings for what nobody asked for, and no quantity that was kept answers."""
        known = {f"{channel}.{part}" for channel in draft.words for part in ("display", "pick")}
        left = [name for name in self._texts if name not in self._asked | known]
        return [str(self._tree.finding((name,), "was not asked for.")) for name in left]
