"""A card and a measurement as lines for a terminal."""

from __future__ import annotations

from collections.abc import Iterator

from aff_runtime.app.card.entries import Measured, Signed
from aff_runtime.app.card.figures import Figure
from aff_runtime.app.card.page import interval_text, unfinished, value_text
from aff_runtime.app.card.standing import Card

HOW_TO_TYPE = "what is typed: --typed 'NAME=VALUE UNIT', once for each"


def card_lines(card: Card) -> Iterator[str]:
    """Yield how every step stands, then what is left to do."""
    yield f"{card.begun.line}: {card.entry_count} entries, newest {card.newest}"
    for one in card.steps:
        signed = signed_line(one.signed) if one.signed is not None else ""
        yield f"{one.step.number:3}  {one.step.title[:52]:52}  {one.stand:14}  {signed}".rstrip()
    for sentence in unfinished(card):
        yield f"left to do: {sentence}"


def signed_line(signed: Signed) -> str:
    """Return who signed, and what could not be compared then."""
    return "; ".join((f"signed as {signed.name}", *signed.not_compared))


def measured_lines(measured: Measured) -> Iterator[str]:
    """Yield the figures of a measurement, and what it says."""
    for figure in measured.result.figures:
        yield _figure(figure)
    for text in measured.result.waits_for:
        yield f"missing   {text}"
    if any("type " in text for text in measured.result.waits_for):
        yield f"          {HOW_TO_TYPE}"
    for text in measured.result.proposals:
        yield f"proposed  {text}"
    for text in measured.result.remarks:
        yield f"remark    {text}"
    yield f"step {measured.step}: {measured.verdict}"


def _figure(figure: Figure) -> str:
    mark = {True: "ok   ", False: "FAIL ", None: "-    "}[figure.good]
    interval = interval_text(figure)
    beside = f" ({interval})" if interval else ""
    limit = f"; {figure.limit}" if figure.limit else ""
    return f"{mark} {figure.name}: {value_text(figure)}{beside}{limit}"
