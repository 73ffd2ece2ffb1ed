"""What was answered and found so far, in a small JSON file beside the site file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal

from annotated_types import MaxLen
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic.types import StringConstraints

from aff_runtime.app.setup.asking.questions import FIND, NONE, split_bit
from aff_runtime.app.setup.words.decoding import Decoding
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.files import replace_text
from aff_runtime.base.printable import printable
from aff_runtime.config.plain_file import read_plain

MAX_BYTES = 64 * 1024
FURTHER = "further"
"""Answers ``further.1``, ``.2``: channels to record beside the quantities that setup asks for."""
MOST_FURTHER = 32
SECOND_TENSION = "second.tension"
"""Answer that names the tension which the second driven roller is to keep quiet."""
STRICT = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)
Key = Annotated[str, StringConstraints(pattern=r"^[A-Za-z][A-Za-z0-9_.]*$", max_length=80)]
TextLine = Annotated[str, StringConstraints(pattern=r"^[^\x00-\x1f\x7f]*$", max_length=200)]
SCALE = r"^-?[0-9.]+([eE][-+]?[0-9]+)?( [A-Za-z/ 0-9]+)?$"
ScaleText = Annotated[str, StringConstraints(pattern=SCALE, max_length=40)]
SIGNAL, SENT = "signal.", "sent."
"""How the answers begin that say which signal of a bus is read, or written, as what."""


_FILES = ("wire", "dbc", "eds", "node")
"""Answers with which everything goes that was said of signals: other files name others."""


def _is_of_signals(key: str) -> bool:
    return key.startswith((SIGNAL, SENT, "correction_scale")) or key.endswith(".scale")


class FoundWord(BaseModel):
    """Where a quantity was found, and how it is stored.

    ``order`` : which of two words comes first. ``scale`` : SI units of one count, or such as
    ``4096 counts/turn``, as the site file writes it. ``wraps_after`` : counts after which an angle
    starts over, where that is not all that its words hold; else 0. ``unseen_s`` : for how long an
    angle was watched without its start over being seen; 0 where it was seen.
    """

    model_config = STRICT

    address: int = Field(ge=0, le=65535, strict=True)
    type: Literal["u16", "i16", "u32", "i32"]
    order: Literal["", "high_first", "low_first"]
    scale: ScaleText
    wraps_after: int = Field(default=0, ge=0, le=65536, strict=True)
    unseen_s: float = Field(default=0.0, ge=0.0, le=3600.0)

    @property
    def decoding(self) -> Decoding:
        """Return how it is read."""
        return Decoding(address=self.address, type=self.type, order=self.order)


class Draft(BaseModel):
    """All that is known: ``answers`` by name of the question, ``words`` found by channel."""

    model_config = STRICT

    version: Literal[1] = 1
    answers: Annotated[Mapping[Key, TextLine], MaxLen(200)] = {}
    words: Annotated[Mapping[Key, FoundWord], MaxLen(64)] = {}

    def with_answer(self, name: str, kept: str) -> Draft:
        """Return it with one more answer."""
        return self.model_copy(update={"answers": {**self.answers, name: kept}})

    def with_word(self, channel: str, word: FoundWord) -> Draft:
        """Return it with one more quantity found."""
        return self.model_copy(update={"words": {**self.words, channel: word}})

    def without(self, name: str) -> Draft:
        """Return it without a quantity or answer and what depends on it, to be asked again."""
        gone = {name, *self._named(name)}
        if name.partition(".")[0] in _FILES:
            gone |= {key for key in self.answers if _is_of_signals(key)}
        gone |= {f"{kind}{one}" for one in gone for kind in (SIGNAL, SENT)}
        return self.model_copy(
            update={
                kind: {
                    key: value
                    for key, value in getattr(self, kind).items()
                    if not any(key == one or key.startswith(f"{one}.") for one in gone)
                }
                for kind in ("answers", "words")
            }
        )

    def _named(self, name: str) -> list[str]:
        """Return the channels that this answer, or answers below it, have named."""
        return [
            kept
            for key, kept in self.answers.items()
            if key.startswith((f"{FURTHER}.", SECOND_TENSION))
            and (key == name or key.startswith(f"{name}."))
        ]

    def without_further(self, number: int) -> Draft:
        """Return it without the further channels from ``number`` on."""
        draft = self
        for later in range(number, MOST_FURTHER + 1):
            draft = draft.without(f"{FURTHER}.{later}")
        return draft

    @property
    def further(self) -> tuple[str, ...]:
        """Return the further channels, in the order in which they were named."""
        names = []
        for number in range(1, MOST_FURTHER + 1):
            kept = self.answers.get(f"{FURTHER}.{number}", NONE)
            if kept == NONE:
                break
            names.append(kept)
        return tuple(names)

    @property
    def second(self) -> str:
        """Return the driven roller that is corrected beside the unwind; empty without one."""
        name = self.answers.get("second", NONE)
        return "" if name == NONE else name

    @property
    def found(self) -> frozenset[str]:
        """Return the channels whose word or signal is known."""
        return frozenset(self.words) | {
            name.removeprefix(SIGNAL)
            for name, kept in self.answers.items()
            if name.startswith(SIGNAL) and kept != NONE
        }

    @property
    def order(self) -> str:
        """Return the PLC's word order as far as a quantity of two words tells; else empty."""
        return next((word.order for word in self.words.values() if word.order), "")

    @property
    def owners(self) -> dict[int, str]:
        """Return by wire address (the first register is 0) the channel or answer that has it."""
        owners = {
            address: channel
            for channel, word in self.words.items()
            for address in word.decoding.addresses
        }
        # the answer `echo` names the word `aff_echo`: the PLC's copy of our heartbeat
        for name in ("heartbeat", "roll_id", "status.word", "echo", *self._applied()):
            given = self.answers.get(name, "")
            if given.isdecimal():
                owners.setdefault(int(given), name)
        for name, kept in self.answers.items():
            # of a PLC with status bits in an order of its own: word and bit of each
            if name.startswith("bits.") and kept not in (NONE, FIND):
                owners.setdefault(split_bit(kept)[0], name)
        return owners

    def _applied(self) -> list[str]:
        return [name for name in self.answers if name.startswith("applied.")]


def read_draft(path: Path) -> Draft:
    """Return what was kept in ``path``; nothing where there is no such file.

    Raises
    ------
    ConfigError : it cannot be read, or is not what setup wrote.
    """
    what_to_do = "Delete it to begin anew."
    try:
        raw = read_plain(path, MAX_BYTES)
    except FileNotFoundError:
        return Draft()
    except (OSError, ValueError) as error:
        raise ConfigError(f"{path}: cannot be read ({error}). {what_to_do}") from None
    try:
        return Draft.model_validate(json.loads(raw))
    except ValidationError as error:
        one = error.errors(include_url=False)[0]
        where = printable(".".join(str(part) for part in one["loc"]), 80)
        said = f"{where}: {printable(one['msg'], 120)}"
        raise ConfigError(f"{path}: is not what setup kept: {said}. {what_to_do}") from None
    except (ValueError, RecursionError) as error:
        said = printable(str(error), 120)
        raise ConfigError(f"{path}: is no JSON ({said}). {what_to_do}") from None


def write_draft(path: Path, draft: Draft) -> None:
    """Keep what is known; a reader sees the old file or the whole new one."""
    replace_text(path, draft.model_dump_json(indent=1) + "\n")
