"""Who may do what now, and why not: by ``may``, the function that judges the press itself."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from aff_hmi.hand import Hand, said_in
from aff_hmi.words import N_, Say
from aff_runtime.app.hand.may import Action, Person, Place, Role

ROLE_WORDS = {
    None: N_("not logged in"),
    Role.VIEW: N_("view"),
    Role.OPERATE: N_("operate"),
    Role.COMMISSION: N_("commission"),
}
PLACE_WORDS = {Place.PANEL: N_("at the panel"), Place.NETWORK: N_("on the network")}


@dataclass(frozen=True, slots=True, kw_only=True)
class WhoLine:
    """Somebody of a role at a place: why not, for every action; empty where he may."""

    role: str
    place: str
    bypass: tuple[str, ...]
    arm: tuple[str, ...]


def who_lines(hand: Hand | None, say: Say) -> tuple[WhoLine, ...]:
    """Return every role at every place; none on a screen for looking only."""
    return tuple(_lines(hand, say)) if hand is not None else ()


def _lines(hand: Hand, say: Say) -> Iterator[WhoLine]:
    for role, word in ROLE_WORDS.items():
        for place, where in PLACE_WORDS.items():
            person = Person(role=role, place=place)
            why = {
                action: tuple(said_in(one, say) for one in hand.reasons_of(action, person))
                for action in Action
            }
            yield WhoLine(
                role=say(word), place=say(where), bypass=why[Action.BYPASS], arm=why[Action.ARM]
            )
