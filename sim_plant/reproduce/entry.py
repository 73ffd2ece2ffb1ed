"""What an experiment of the catalogue is and what it returns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

Verdict = Literal["agree", "disagree", "new"]
"""``new``: the source makes no claim; the number goes beyond it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ClaimRow:
    """One number beside the source's claim.

    Attributes
    ----------
    quantity : what is measured, with its unit in ``unit``.
    claim : what the source says, in its numbers where it gives any.
    ours : our number.
    verdict, why : agree, disagree or new, and the reason in one sentence.
    """

    quantity: str
    claim: str
    ours: float
    unit: str
    verdict: Verdict
    why: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Disagreement:
    """Two methods for one thing and how far they lie apart; ``limit`` when one is promised."""

    what: str
    first: str
    second: str
    difference: float
    unit: str
    limit: float | None = None

    @property
    def within(self) -> bool:
        """Whether the promise, if any, is kept."""
        return self.limit is None or bool(self.difference <= self.limit)


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """Numbers, method comparisons and figures (inline SVG) of one experiment."""

    rows: tuple[ClaimRow, ...]
    figures: tuple[str, ...]
    disagreements: tuple[Disagreement, ...] = ()
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Experiment:
    """One entry: ``identity`` is what ``--only`` takes, ``where`` the source's numbers."""

    identity: str
    chapter: int
    title: str
    where: str
    run: Callable[[], Result]


def row_of_claim(
    quantity: str, claim: str, ours: float, unit: str, holds: bool, why: str
) -> ClaimRow:
    """Return a row that agrees when ``holds``."""
    verdict: Verdict = "agree" if holds else "disagree"
    return ClaimRow(
        quantity=quantity, claim=claim, ours=float(ours), unit=unit, verdict=verdict, why=why
    )


def beyond(quantity: str, ours: float, unit: str, why: str, claim: str = "none") -> ClaimRow:
    """Return a row for a number the source does not speak about."""
    return ClaimRow(
        quantity=quantity, claim=claim, ours=float(ours), unit=unit, verdict="new", why=why
    )
