"""What `aff-runtime card` does at a terminal, done for a screen; each act returns an `Answer`."""

from __future__ import annotations

from aff_runtime.app.card import page, steps, work
from aff_runtime.app.card.lines import signed_line
from aff_runtime.app.card.typed_values import typed
from aff_runtime.app.card.verify import verify
from aff_runtime.app.commission.card.sources import (
    after_search,
    inputs_now,
    inputs_of,
    said_of,
    sources,
)
from aff_runtime.app.commission.card.view import card_view
from aff_runtime.app.commission.link.answers import Answer, CardShown, Done, Printed
from aff_runtime.app.commission.link.messages import Refusal, Request, Why
from aff_runtime.app.commission.link.talk import Talk
from aff_runtime.app.commission.paths import Paths, parameters_of
from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import AffError, ConfigError

LONGEST_S = 600.0  # reading and computing one step, on the clock; a search before it apart
MEMORY_BYTES = 4 << 30  # beyond what the process has; as `aff-runtime card step`


def card(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Return the card as it stands, compared with what holds now as far as that is known."""
    card_file = work.CardFile.of(where.card)
    try:
        found = sources(where, card_file)
        now = inputs_of(found)
    except AffError as error:
        remark = f"not compared with what holds now: {error}"
        return CardShown(card=card_view(card_file.card(), None, None, [remark]))
    view = card_view(card_file.card(now), found.checked, found.answer, said_of(found))
    return CardShown(card=view)


def printed(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Return the page that prints."""
    card_file = work.CardFile.of(where.card)
    now, said = inputs_now(where, card_file)
    return Printed(html=page.page(card_file.card(now), asked.paper, said))


def begin(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Begin a card."""
    newest = work.begin(where.card, where.site, parameters_of(where.site, where.state))
    return Done(text=f"a card is begun, {newest[:12]}")


def step(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Measure a step, or put on the card that it does not apply."""
    card_file, number, by = work.CardFile.of(where.card), asked.step, asked.by
    found = sources(where, card_file, plc=asked.plc.strip())
    work.keep_site(where.card, found.parameters)
    if asked.leave_out.strip():
        kept = work.leave_out(card_file, number, asked.leave_out, inputs_of(found), by)
    else:
        values = tuple(typed(line) for line in asked.typed.splitlines() if line.strip())
        if number == steps.SEARCH:
            found = after_search(where, found, values, talk.say)
        with bounded_effort("card", ConfigError, seconds=LONGEST_S, memory_bytes=MEMORY_BYTES):
            kept = work.measure(card_file, number, found, values, by)
    return Done(text=f"step {number}: {kept.verdict}")


def sign(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Sign the measurement that the person has seen, and no other."""
    card_file, number = work.CardFile.of(where.card), asked.step
    now = inputs_of(sources(where, card_file))
    last = card_file.standing(number, now).last
    if last is None or last.sha256 != asked.measured:
        return Refusal(why=Why.CHANGED)
    kept = work.sign(card_file, number, now, name=asked.account, reason=asked.reason, by=asked.by)
    return Done(text=f"step {kept.step} {signed_line(kept)}")


def verified(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Return whether the chain holds and the records are as measured.

    The newest hash is for a person to compare with a printed page: entries that were taken off
    the end leave a chain that holds.
    """
    result = verify(where.card, records=True)
    if result.wrong:
        return Done(text=f"does not hold: {'; '.join(result.wrong[:5])}")
    return Done(text=f"{result.entries} entries, whole; newest {result.newest}")
