"""Looking at the PLC while somebody answers: patience, rows to pick from, what is kept."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeVar

from aff_runtime.app.setup.asking.dialogue import Dialogue, RowReader
from aff_runtime.app.setup.asking.draft import FoundWord
from aff_runtime.app.setup.asking.plc import scale_of
from aff_runtime.app.setup.asking.quantities import Quantity
from aff_runtime.app.setup.asking.questions import Question
from aff_runtime.app.setup.words.decoding import Decoding
from aff_runtime.app.setup.words.reading import Watched, WordBlock, WordReader
from aff_runtime.base.errors import ConfigError, WireError
from aff_runtime.base.units import UnitError

SKIP = "skip"
T = TypeVar("T")


class Look:
    """What every step needs.

    Parameters
    ----------
    dialogue : asks and keeps.
    reader : of the PLC; it only reads.

    Attributes
    ----------
    blocks : words in a row that the PLC gives; empty before the survey.
    """

    def __init__(self, dialogue: Dialogue, reader: WordReader) -> None:
        self.dialogue = dialogue
        self.reader = reader
        self.blocks: tuple[WordBlock, ...] = ()

    def is_known(self, wanted: Quantity) -> bool:
        """Return whether a quantity was found, or is not there.

        Raises
        ------
        ConfigError : what was kept of it cannot be.
        """
        draft = self.dialogue.draft
        known = draft.words.get(wanted.channel)
        if known is None:
            return wanted.optional and draft.answers.get(f"{wanted.channel}.display") == SKIP
        given = {place for block in self.blocks for place in block.addresses}
        why = ""
        if not given.issuperset(known.decoding.addresses):
            why = f"{known.decoding} is not among the words that the PLC gives"
        try:
            scale_of(known.scale, wanted.unit)
        except UnitError as error:
            why = str(error)
        if why:
            raise ConfigError(
                f"{self.dialogue.path}: words.{wanted.channel}: {why}. Ask again with `--again "
                f"{wanted.channel}`."
            )
        self.dialogue.say(f"  {wanted.channel}: {known.decoding}, scale {known.scale} (kept)")
        return True

    def keep_word(
        self,
        channel: str,
        decoding: Decoding,
        scale: str,
        *,
        wraps_after: int = 0,
        unseen_s: float = 0.0,
    ) -> None:
        """Keep where a quantity was found, and of an angle what ``FoundWord`` says of its end."""
        word = FoundWord(
            address=decoding.address,
            type=decoding.type,
            order=decoding.order,
            scale=scale,
            wraps_after=wraps_after,
            unseen_s=unseen_s,
        )
        self.dialogue.keep(self.dialogue.draft.with_word(channel, word))

    def pick(
        self,
        name: str,
        text: str,
        rows: dict[int, str],
        *choices: str,
        at: Mapping[int, int] | None = None,
        unsure: str = "",
    ) -> str:
        """Return the picked row's number, or one of ``choices``.

        Row 1 is taken unasked, unless ``unsure`` says why not.
        """
        first = "1" if rows else choices[0] if choices else None
        default = first if not unsure else None
        reader = RowReader(rows=frozenset(rows), at=at or {}, choices=choices, unsure=unsure)
        shown = tuple((str(n), row) for n, row in rows.items())
        return self.dialogue.ask_anew(
            Question(name=name, text=text, read=reader, default=default, rows=shown)
        )

    def watch(self, seconds: float, enough: Callable[[Watched], bool] | None = None) -> Watched:
        """Watch all words."""
        return self.patiently(lambda: self.reader.watch(self.blocks, seconds, enough))

    def patiently(self, act: Callable[[], T]) -> T:
        """Return what ``act`` returns; while the PLC is gone say so, and wait for an answer."""
        while True:
            try:
                return act()
            except WireError as error:
                if not self.dialogue.is_patient:
                    raise WireError(f"{error} What was found is kept.") from error
                self.dialogue.complain(f"  {error}")
                text = "The PLC is gone; what was found is kept. Enter: try again; q: leave"
                self.dialogue.ask_anew(
                    Question(name="retry", text=text, read=lambda text: text, default="yes")
                )
