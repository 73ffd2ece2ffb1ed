"""A card from its first entry to a signature: what a console or a screen calls."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from aff_runtime.app.card.book import CardBook
from aff_runtime.app.card.chain import Chain
from aff_runtime.app.card.entries import (
    BEGUN,
    MEASURED,
    SIGNED,
    Begun,
    CardEntry,
    Inputs,
    Measured,
    Signed,
    Typed,
    as_plain,
    entries_of,
    read_back,
)
from aff_runtime.app.card.figures import StepResult, Verdict
from aff_runtime.app.card.gather import Sources, gather, inputs_of
from aff_runtime.app.card.standing import (
    SIGNABLE,
    Card,
    StepStanding,
    card_of,
    former_samples,
    newest_plc,
)
from aff_runtime.app.card.steps import step_of
from aff_runtime.app.card.typed_values import TypedValues
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.base.files import replace_text
from aff_runtime.base.printable import printable
from aff_runtime.base.release import release_text
from aff_runtime.base.runs.table import few
from aff_runtime.base.text_digest import text_digest
from aff_runtime.config.revision import SHORT

LONGEST_SENTENCE = 600  # characters; so are the bounds of reason and name
SHORTEST_REASON, LONGEST_REASON, SHORTEST_NAME, LONGEST_NAME = 8, 500, 2, 80


@dataclass(frozen=True, slots=True, kw_only=True)
class CardFile:
    """A card on the disk with what it says.

    Attributes
    ----------
    newest : hash that the next entry follows.
    """

    book: CardBook
    entries: tuple[CardEntry, ...]
    newest: str

    @classmethod
    def of(cls, folder: Path) -> CardFile:
        """Read a card.

        Raises
        ------
        ConfigError
            It cannot be read, its chain does not hold, or it is of another release.
        """
        book = CardBook(folder)
        chain = book.read()
        try:
            return cls(book=book, entries=entries_of(chain), newest=chain.newest)
        except ConfigError as error:
            raise ConfigError(f"{book.path}: no card of this release: {error}") from None

    @property
    def begun(self) -> Begun:
        """What the card is of."""
        begun = self.entries[0].content
        assert isinstance(begun, Begun)
        return begun

    @property
    def plc(self) -> str:
        """Version of the PLC's program as it was typed last."""
        return newest_plc(self.entries)

    def card(self, now: Inputs | None = None) -> Card:
        """Return how it stands, against what holds ``now``."""
        return card_of(self.entries, now)

    def standing(self, number: int, now: Inputs | None) -> StepStanding:
        """Return how one step stands.

        Raises
        ------
        RefusedError
            There is none of that number.
        """
        step = step_of(number)
        return next(one for one in self.card(now).steps if one.step is step)


def begin(folder: Path, site: Path, parameters: ParameterRecord) -> str:
    """Begin a card; return the hash of its first entry.

    Raises
    ------
    RefusedError
        There is one already, or the folder cannot be written.
    """
    begun = Begun(
        line=printable(parameters.site.line.name),
        site=str(site.absolute()),
        site_sha256=text_digest(parameters.site_text),
        site_hash=parameters.site_hash,
        release=release_text(),
        machine=" ".join((os.uname().sysname, os.uname().release, os.uname().machine)),
    )
    newest = CardBook(folder).begin(BEGUN, as_plain(begun))
    keep_site(folder, parameters)
    return newest


def measure(
    card: CardFile, number: int, sources: Sources, typed: tuple[Typed, ...], by: str
) -> Measured:
    """Measure a step and put it on the card.

    Raises
    ------
    AffError
        It cannot be measured now; nothing is put on the card.
    """
    step = step_of(number)
    former = former_samples(step, card.entries, inputs_of(sources))
    gathered = gather(step, sources, TypedValues(typed), former)
    result = _bounded(step.measure(gathered.evidence))
    kept = Measured(
        step=number,
        verdict=result.verdict,
        result=result,
        inputs=gathered.inputs,
        windows=gathered.windows,
        typed=typed,
        by=by,
        release=release_text(),
    )
    _put(card, MEASURED, kept)
    return kept


def leave_out(card: CardFile, number: int, reason: str, inputs: Inputs, by: str) -> Measured:
    """Put on the card that a step does not apply.

    Raises
    ------
    ConfigError
        The reason is too short or too long.
    """
    kept = Measured(
        step=step_of(number).number,
        verdict=Verdict.NOT_APPLICABLE,
        result=StepResult(figures=()),
        inputs=inputs,
        reason=_said(reason, "reason", SHORTEST_REASON, LONGEST_REASON),
        by=by,
        release=release_text(),
    )
    _put(card, MEASURED, kept)
    return kept


def sign(card: CardFile, number: int, now: Inputs, *, name: str, reason: str, by: str) -> Signed:
    """Sign the measurement of a step that counts.

    What could not be compared with what holds now stands in the signature.

    Raises
    ------
    RefusedError
        There is nothing to sign, or it has to be done again.
    ConfigError
        Name or reason are too short or too long.
    """
    standing = card.standing(number, now)
    if standing.stand not in SIGNABLE or standing.last is None:
        why = "; ".join(
            (*standing.why, *(standing.measured.result.waits_for if standing.measured else ()))
        )
        raise RefusedError(
            f"step {number} is {standing.stand}{f' ({why})' if why else ''}: nothing to sign"
        )
    kept = Signed(
        step=number,
        measured=standing.last.sha256,
        name=_said(name, "name", SHORTEST_NAME, LONGEST_NAME),
        reason=_said(reason, "reason", SHORTEST_REASON, LONGEST_REASON),
        by=by,
        not_compared=standing.not_compared,
    )
    _put(card, SIGNED, kept)
    return kept


def _put(card: CardFile, kind: str, said: Measured | Signed) -> None:
    """Put an entry on a card; one that could not be read back is refused before."""
    body = as_plain(said)
    try:
        read_back(kind, body)
    except ConfigError as error:
        raise RefusedError(f"{card.book.path}: too much for one entry: {error}") from None
    card.book.add(kind, body, card.newest, lambda chain: _may_follow(card, said, chain))


def _may_follow(card: CardFile, said: Measured | Signed, chain: Chain) -> bool:
    """Return whether an entry may follow what was added since the card was read.

    A search takes an hour, and others sign meanwhile. What is measured rests on its own step's
    entries and on the PLC's version alone.
    """
    entries, seen = entries_of(chain), len(card.entries)
    if not isinstance(said, Measured) or entries[seen - 1 : seen] != card.entries[-1:]:
        return False
    since = [entry.content for entry in entries[seen:]]
    return not any(
        isinstance(one, Begun)
        or one.step == said.step
        or (isinstance(one, Measured) and one.inputs.plc != said.inputs.plc)
        for one in since
    )


def _bounded(result: StepResult) -> StepResult:
    """Return a result with bounded sentences (``LONGEST_SENTENCE``), and few of each kind."""
    return replace(
        result,
        remarks=_cut(result.remarks),
        proposals=_cut(result.proposals),
        missing=_cut(result.missing),
    )


def _cut(sentences: Sequence[str]) -> tuple[str, ...]:
    return tuple(printable(one, LONGEST_SENTENCE) for one in few(sentences))


def keep_site(folder: Path, parameters: ParameterRecord) -> None:
    """Keep the text of the site file beside the card, by its revision."""
    path = folder / f"site-{parameters.site_hash[:SHORT]}.yaml"
    if not path.exists():
        try:
            replace_text(path, parameters.site_text)
        except OSError as error:
            raise RefusedError(
                f"{path}: {error.strerror}; the site file is not kept beside the card"
            ) from None


def _said(text: str, what: str, least: int, most: int) -> str:
    shown = printable(text.strip())
    if not least <= len(shown) <= most:
        raise ConfigError(f"the {what} has {len(shown)} characters; write {least} to {most}")
    return shown
