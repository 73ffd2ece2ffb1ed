"""What a screen says to the hand under any bytes: a command, or an error of ours."""

from __future__ import annotations

import contextlib

from aff_runtime.app.hand.messages import HandMessageError, encode, read_said, read_told
from tests.aff_runtime.app.hand.test_messages import COMMAND, NOTICE
from tests.fuzz.source import Source

PACKETS = [encode(COMMAND), encode(NOTICE)]


def packet(data: bytes) -> str:
    """A packet, spoilt or made of the bytes themselves; what is taken for true says itself."""
    source = Source(data)
    kind = source.below(len(PACKETS) + 1)
    said = source.take(4096) if kind == len(PACKETS) else source.spoilt(PACKETS[kind])
    try:
        found = read_said(said)
    except HandMessageError as error:
        why = str(error)
        assert why
        assert why.isprintable()
        found = None
    if found is not None:
        assert read_said(encode(found)) == found
        assert found.account.isprintable()
    with contextlib.suppress(HandMessageError):
        read_told(said)
    return "refused" if found is None else "ok"


SEEDS = [
    bytes(8),
    b"\x01" + bytes(7),
    b"\x02" + PACKETS[0],
    bytes(range(1, 40)),
    b"\x01\x07\xff" * 9,
]
