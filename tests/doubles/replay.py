"""A word transport that says again what a PLC once said."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.signals import Outcome

ScriptedReply = Sequence[int] | Outcome


class ReplayTransport:
    """``WordTransport`` that returns one recorded row per tick, then NOT_CONNECTED for ever.

    Parameters
    ----------
    rows : per tick the read block, or the outcome of a tick that had none.
    """

    def __init__(self, rows: Iterable[ScriptedReply]) -> None:
        self._rows = tuple(row if isinstance(row, Outcome) else tuple(row) for row in rows)
        self._next = 0

    def transact(self, write_words: list[int], deadline_ns: int) -> tuple[Outcome, list[int]]:
        """Return the next row; what is written and the deadline play no part."""
        if self._next >= len(self._rows):
            return Outcome.NOT_CONNECTED, []
        row = self._rows[self._next]
        self._next += 1
        if isinstance(row, Outcome):
            return row, []
        return Outcome.OK, list(row)

    def close(self) -> None:
        """Skip what is left."""
        self._next = len(self._rows)


def read_rows(path: Path) -> tuple[ScriptedReply, ...]:
    """Read a recording: one tick per line, words separated by commas, or an outcome's name.

    Empty lines and what follows a ``#`` are skipped; words are 0..65535.

    Raises
    ------
    ConfigError
        With file and line, for a line that is neither or a file that cannot be read.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: cannot be read ({error})") from error
    rows: list[ScriptedReply] = []
    for number, line in enumerate(lines, start=1):
        text = line.partition("#")[0].strip()
        if text:
            rows.append(_row(text, f"{path}:{number}"))
    return tuple(rows)


def _row(text: str, where: str) -> ScriptedReply:
    if text in Outcome.__members__:
        return Outcome[text]
    try:
        words = tuple(int(word) for word in text.split(","))
    except ValueError:
        names = ", ".join(Outcome.__members__)
        raise ConfigError(
            f"{where}: {text!r} is neither words separated by commas nor one of {names}"
        ) from None
    if min(words) < 0 or max(words) > 0xFFFF:
        raise ConfigError(f"{where}: a word lies outside 0..65535")
    return words
