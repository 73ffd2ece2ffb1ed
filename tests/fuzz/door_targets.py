"""What comes through the door under any bytes: a message of this release, or an error of ours."""

from __future__ import annotations

from aff_runtime.app.door.messages import (
    DoorMessageError,
    Facts,
    Hello,
    RingGone,
    RingPassed,
    SentAway,
    decode,
    encode,
)
from tests.aff_hmi.moments import facts
from tests.fuzz.source import Source

PACKETS = [
    encode(one) for one in (facts(), Hello(version="1"), RingGone(), RingPassed(), SentAway())
]


def packet(data: bytes) -> str:
    """A packet, spoilt or made of the bytes themselves."""
    source = Source(data)
    kind = source.below(len(PACKETS) + 1)
    said = source.take(4096) if kind == len(PACKETS) else source.spoilt(PACKETS[kind])
    why = ""
    try:
        message = decode(said)
    except DoorMessageError as error:
        why = str(error)
    assert why.isprintable()
    if not why and isinstance(message, Facts):
        decode(encode(message))
    return "refused" if why else "ok"


SEEDS = [
    bytes(8),
    bytes([len(PACKETS)]) + PACKETS[0],
    bytes(range(1, 40)),
    b"\x01\x00\x07\xff" * 9,
]
