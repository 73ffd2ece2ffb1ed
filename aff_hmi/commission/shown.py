"""What the pages of card and commissioning get, as frozen records with the names of their JSON.

They are the commissioner's own records with what a reader's language adds to them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from aff_runtime.app.commission.views.of_line import (
    DriveRow,
    LastJob,
    NoService,
    SaidLine,
    ServiceView,
    SiteView,
    StepView,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ShownStep(StepView):
    """A step with the mark and the word of how it stands.

    Attributes
    ----------
    typed_labels : of each of ``typed_names``, what is wanted.
    """

    mark: str
    stand_word: str
    typed_labels: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ShownDriveRow(DriveRow):
    """An identified number with its unit."""

    unit: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ShownQuestion:
    """What a job waits for; ``choices`` and ``rows`` : what is answered, and its text."""

    number: int
    name: str
    text: str
    default: str | None
    choices: tuple[tuple[str, str], ...]
    rows: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ShownLine(SaidLine):
    """A line of a job; ``lang`` : ``en`` where it is in no words of ours, else the page's own."""

    lang: str


@dataclass(frozen=True, slots=True, kw_only=True)
class JobInShort:
    """The job that is under way, for who may not commission: what it is, and no more."""

    do: str
    said: tuple[SaidLine, ...] = ()
    ask: None = None
    name: str
    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ShownJob:
    """The job that is under way; ``name`` is what it is called."""

    do: str
    step: int
    said: tuple[ShownLine, ...]
    ask: ShownQuestion | None
    name: str
    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ShownLast(LastJob):
    """The job that ended last; ``name`` is what it is called."""

    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class SiteInShort:
    """Whether there is a site file, for who may not commission."""

    there: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ShownState:
    """How commissioning stands, for one reader.

    Attributes
    ----------
    is_open : whether his session commissions. ``may`` : whether he may.
    left_s : seconds until tried settings return; None where none are tried.
    """

    ok: Literal[True] = True
    protocol: int
    by: str
    site: SiteView | SiteInShort
    service: NoService | ServiceView
    card: bool
    job: ShownJob | JobInShort | None
    last: ShownLast | None
    long: ShownJob | JobInShort | None
    long_last: ShownLast | None
    is_open: bool
    may: bool
    left_s: int | None = None
