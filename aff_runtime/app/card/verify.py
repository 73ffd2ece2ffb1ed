"""Whether a card is what was written: its chain, its newest hash, the records that it names."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from aff_runtime.app.card.book import card_file, content_of
from aff_runtime.app.card.chain import follow
from aff_runtime.app.card.entries import Measured, entries_of
from aff_runtime.app.card.records import differences


@dataclass(frozen=True, slots=True, kw_only=True)
class Verified:
    """What was found; ``wrong`` is empty where the card holds."""

    path: Path
    entries: int
    newest: str
    wrong: tuple[str, ...]


def verify(given: Path, newest: str = "", *, records: bool = False) -> Verified:
    """Follow a card's chain.

    Parameters
    ----------
    given : the card's file or folder. ``newest`` : hash that a printed page shows; empty: none.
    records : also whether the files of the records still are what was measured.

    Raises
    ------
    ConfigError
        The file cannot be read.
    """
    path = card_file(given)
    chain = follow(content_of(path))
    wrong = [chain.wrong] if chain.wrong else []
    if not wrong and newest and chain.newest != newest:
        number = next((k.number for k in chain.links if k.sha256 == newest), 0)
        wrong.append(
            f"the page's hash is that of entry {number}: {len(chain.links) - number} were added"
            if number
            else "no entry has the page's hash: entries were taken away, or it is another card"
        )
    if not wrong and records:
        contents = [one.content for one in entries_of(chain)]
        measured = [one for one in contents if isinstance(one, Measured)]
        wrong = [text for one in measured for w in one.windows for text in differences(w)]
    return Verified(path=path, entries=len(chain.links), newest=chain.newest, wrong=tuple(wrong))
