"""Which signal of a DBC or EDS file can be what is looked for, the likeliest first."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from aff_runtime.app.setup.bus.roles import Role, has_one
from aff_runtime.base.units import to_si, unit_info
from aff_runtime.fieldbus.can.named_signal import NamedSignal

OWN, OWNER, GROUP = 3.0, 2.0, 1.0
"""What a word adds that stands in the signal's own name, or in that of its message or node.

``GROUP`` : of a word for what it is, which as the name of a message is often that of a group.
"""
AGAINST = 4.0
"""What a word takes away that speaks against it: more than one word for it can add."""
UNIT, MOVES, SENDER = 2.0, 3.0, 2.0
LIKELY = 0.5
"""Share of all that names can add from which on a row is proposed."""
AHEAD = 1.5  # of the next row, from which on the first one is taken unasked
OUR_NAME = frozenset({"aff"})


@dataclass(frozen=True, slots=True, kw_only=True)
class Ranked:
    """One signal and how well it fits.

    Attributes
    ----------
    share : of all that names and unit can add; 1 where all say so.
    is_named : a word for what it is stands in its name, or in that of its message or node.
    is_whole : a word for whose it is stands there as well.
    """

    signal: NamedSignal
    score: float
    share: float
    is_named: bool
    is_whole: bool


def ranked(
    role: Role,
    signals: Iterable[NamedSignal],
    *,
    taken: Mapping[str, bool],
    moves: Mapping[str, bool],
) -> list[Ranked]:
    """Return the signals that can be what ``role`` says, best first.

    Parameters
    ----------
    taken : signals that are something already, by name, and whether AFF writes them.
    moves : whether each signal that was heard moved, by its name.
    """
    every = list(signals)
    # a frame has one sender
    directions = {one.layout.name: taken[one.name] for one in every if one.name in taken}
    rows = [
        _rank(role, one, moves)
        for one in every
        if one.name not in taken
        and directions.get(one.layout.name, role.written) == role.written
        and can_be(role, one)
    ]
    return sorted(rows, key=lambda row: (-row.score, not row.is_named, row.signal.name))


def can_be(role: Role, signal: NamedSignal) -> bool:
    """Return whether a signal can be it at all: its way, its bits, its sign, its unit."""
    if signal.sent_to_us is not None and signal.sent_to_us == role.written:
        return False
    field = signal.field
    info = unit_info(signal.unit) if signal.unit else None
    if not role.unit:
        is_word = not field.is_float and (field.factor, field.offset) == (1.0, 0.0)
        fits = field.length >= role.least_bits
        if role.same_bits:
            fits = field.length == role.least_bits
        return is_word and fits and info is None
    if role.signed:
        bare = signal.unit in {"", role.unit}  # a DBC's factor is SI there
        return field.signed and not field.is_float and field.offset == 0.0 and bare
    return info is None or to_si(info.symbol)[0] == role.unit


def _rank(role: Role, signal: NamedSignal, moves: Mapping[str, bool]) -> Ranked:
    what, *whose = role.groups
    is_own, is_owner = has_one(what, signal.called), has_one(what, signal.owner)
    score, most = OWN if is_own else GROUP if is_owner else 0.0, OWN * len(role.groups)
    is_whole = is_own or is_owner
    for group in whose:
        if has_one(group, signal.called):
            score += OWN
        elif has_one(group, signal.owner):
            score += OWNER
        else:
            is_whole = False
    if role.needs and not has_one(role.needs, signal.called):
        score -= 2.0 * AGAINST
    if has_one(role.against, signal.called):
        score -= AGAINST
    if role.unit and signal.unit and unit_info(signal.unit) is not None:
        score, most = score + UNIT, most + UNIT
    if any(has_one(OUR_NAME, sender) for sender in signal.senders):
        score += SENDER if role.written else -SENDER
    if role.moves and signal.name in moves:
        score += MOVES if moves[signal.name] else -MOVES
    return Ranked(
        signal=signal,
        score=score,
        share=score / most,
        is_named=is_own or is_owner,
        is_whole=is_whole,
    )


def is_likely(rows: list[Ranked]) -> bool:
    """Return whether the first row is worth proposing."""
    return bool(rows) and rows[0].is_named and rows[0].share >= LIKELY


def is_alone(rows: list[Ranked]) -> bool:
    """Return whether all names say the first row, and no other one comes near it."""
    is_ahead = len(rows) == 1 or (bool(rows) and rows[0].score - rows[1].score >= AHEAD)
    return is_likely(rows) and rows[0].is_whole and is_ahead
