"""Look at a PLC's words without writing any: which order, which type, does it live."""

from __future__ import annotations

import itertools
import struct
from dataclasses import dataclass

from aff_runtime.base.errors import WireError
from aff_runtime.base.ports import Clock, WordTransport
from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus.byte_stream import ByteStream
from aff_runtime.fieldbus.modbus.frames import ModbusFrames, WireFunction
from aff_runtime.fieldbus.modbus.transport import ModbusTransport

BYTE_ORDERS: tuple[tuple[str, tuple[int, int, int, int]], ...] = (
    ("high_first", (0, 1, 2, 3)),
    ("low_first", (2, 3, 0, 1)),
    ("high_first, bytes swapped", (1, 0, 3, 2)),
    ("low_first, bytes swapped", (3, 2, 1, 0)),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Decoding:
    """One double word read in one order."""

    order: str
    u32: int
    i32: int
    f32: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ProbedWord:
    """One word: its last value, its moves, and the double word that starts with it.

    ``decodings`` has one entry per row of ``BYTE_ORDERS``; it is empty for the last word.
    """

    address: int
    u16: int
    i16: int
    changes: int
    decodings: tuple[Decoding, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class MapProbe:
    """What was seen: ``samples`` good replies, and whether the heartbeat word moved in them."""

    samples: int
    failures: int
    heartbeat_moves: bool
    words: tuple[ProbedWord, ...]


def open_read_only(
    *,
    device_id: int,
    read_start: int,
    read_count: int,
    clock: Clock,
    wire: ByteStream,
    patience_s: float = 0.05,
) -> ModbusTransport:
    """Return a transport on ``wire`` that can only ask FC3.

    ``patience_s`` : how long a reply may be outstanding before the connection is made anew, s.

    Raises
    ------
    ConfigError
        When a number does not fit the protocol.
    """
    frames = ModbusFrames(device_id=device_id, read_start=read_start, read_count=read_count)
    return ModbusTransport(
        frames=frames,
        wire=wire,
        clock=clock,
        function=WireFunction.FC3,
        silence_before_reconnect_s=patience_s,
    )


def probe_map(
    transport: WordTransport,
    clock: Clock,
    *,
    read_start: int,
    heartbeat_address: int,
    attempts: int = 50,
    period_s: float = 0.02,
) -> MapProbe:
    """Read the block ``attempts`` times and lay out every reading of every word.

    Parameters
    ----------
    transport : made by ``open_read_only``; nothing is written.
    clock : paces the attempts.
    read_start : wire address of the first word.
    heartbeat_address : wire address of the word that should move.
    attempts : transactions to try; the first few go to connecting.
    period_s : time between them and the deadline of each, s.

    Raises
    ------
    WireError
        When fewer than two replies were good, naming the last failure.
    """
    period_ns = round(period_s * 1e9)
    blocks: list[list[int]] = []
    last_failure = Outcome.NOT_CONNECTED
    for _ in range(attempts):
        deadline_ns = clock.now_ns() + period_ns
        outcome, words = transport.transact([], deadline_ns)
        if outcome is Outcome.OK and (not blocks or len(words) == len(blocks[0])):
            blocks.append(words)
        elif outcome is not Outcome.OK:
            last_failure = outcome
        clock.sleep_until_ns(deadline_ns)
    if len(blocks) < 2:
        raise WireError(
            f"{len(blocks)} of {attempts} reads answered, last failure {last_failure.name}; "
            "check the address (host and port, or the settings of the serial line), the device id "
            "and the first register"
        )
    words_seen = _lay_out(blocks, read_start)
    moving = {word.address for word in words_seen if word.changes}
    return MapProbe(
        samples=len(blocks),
        failures=attempts - len(blocks),
        heartbeat_moves=heartbeat_address in moving,
        words=words_seen,
    )


def decodings(first: int, second: int) -> tuple[Decoding, ...]:
    """Return the double word of two neighbouring words in every order of ``BYTE_ORDERS``."""
    wire = struct.pack(">HH", first, second)
    rows = []
    for order, places in BYTE_ORDERS:
        value = bytes(wire[place] for place in places)
        (u32,) = struct.unpack(">I", value)
        (i32,) = struct.unpack(">i", value)
        (f32,) = struct.unpack(">f", value)
        rows.append(Decoding(order=order, u32=u32, i32=i32, f32=f32))
    return tuple(rows)


def _lay_out(blocks: list[list[int]], read_start: int) -> tuple[ProbedWord, ...]:
    last = blocks[-1]
    rows = []
    for index, word in enumerate(last):
        seen = [block[index] for block in blocks]
        rows.append(
            ProbedWord(
                address=read_start + index,
                u16=word,
                i16=word - 0x10000 if word & 0x8000 else word,
                changes=sum(a != b for a, b in itertools.pairwise(seen)),
                decodings=decodings(word, last[index + 1]) if index + 1 < len(last) else (),
            )
        )
    return tuple(rows)
