"""A DBC file and names of signals to the map of one gateway; cantools reads the file."""

from __future__ import annotations

import logging
import math
import re
from functools import lru_cache

import cantools
from cantools.database.can import Database, Message, Signal
from cantools.database.errors import Error as DatabaseError

from aff_runtime.base.errors import ConfigError
from aff_runtime.fieldbus.can.dbc_bounds import check_bounds
from aff_runtime.fieldbus.can.layout import (
    CanChannel,
    CanCorrection,
    CanMap,
    Field,
    FrameLayout,
    applied_readings,
)
from aff_runtime.fieldbus.can.named_signal import NamedSignal
from aff_runtime.fieldbus.signal_names import NamedError, SignalNames, WireFileError

# What cantools would print on the terminal is said here, with the file and what to do.
logging.getLogger("cantools").addHandler(logging.NullHandler())

COUNTER_NAME = "Counter"


@lru_cache(maxsize=4)
def load_dbc(text: str, where: str) -> Database:
    """Return the database of a DBC file's text; who is given it reads it only.

    To parse takes 0.1 s, and a check asks for the same file several times.

    Raises
    ------
    ConfigError
        The text is no DBC file, two of its signals overlap, or two of its messages have one name
        or one identifier, or a number in it is beyond what a frame can have.
    """
    check_bounds(text, where)
    try:
        loaded = cantools.database.load_string(text, database_format="dbc", strict=True)
    except (DatabaseError, ValueError, TypeError, KeyError, IndexError) as error:
        said = " ".join(str(error).split())
        at = re.search(r"at line (\d+)", said)
        text = f"cannot be read as DBC ({said})"
        raise WireFileError(where, text, int(at[1]) if at else 0) from error
    if not isinstance(loaded, Database) or not loaded.messages:
        raise WireFileError(where, "holds no messages")
    _check_messages(loaded, where)
    return loaded


def _check_messages(database: Database, where: str) -> None:
    """Refuse two messages of one name or one identifier: a signal would be in either."""
    by_name: dict[str, int] = {}
    by_id: dict[tuple[int, bool], str] = {}
    for message in database.messages:
        name, can_id = message.name, message.frame_id
        if name in by_name:
            text = (
                f"two messages are called {name}, 0x{by_name[name]:X} and 0x{can_id:X}. Rename one"
            )
            raise WireFileError(where, text)
        by_name[name] = can_id
        other = by_id.setdefault((can_id, message.is_extended_frame), name)
        if other != name:
            text = f"{other} and {name} both have the identifier 0x{can_id:X}. Give each its own"
            raise WireFileError(where, text)


def can_map(database: Database, names: SignalNames) -> CanMap:
    """Return the map of ``names`` on the bus of ``database``.

    A signal named ``Counter`` in any of the messages is taken as the sender's counter: the low
    bits of the sender's heartbeat.

    Raises
    ------
    ConfigError
        A signal does not exist, or cannot be what it is to be.
    """
    used: dict[str, Message] = {}

    def field(name: str) -> Field:
        message, signal = _find(database, name)
        if signal.is_multiplexer:
            others = [s.name for s in message.signals if s.multiplexer_ids]
            text = (
                f"says which signals {message.name} carries in this frame and is no value itself; "
                f"name one of {', '.join(others) or 'the others'}"
            )
            raise NamedError(name, text)
        used[message.name] = message
        return field_of(message, signal)

    def maybe(name: str) -> Field | None:
        return field(name) if name else None

    words = [field(name) for name in (names.plc_heartbeat, names.status, names.roll_id)]
    own = [field(name) for name in (names.aff_heartbeat, names.state)]
    optional = [
        maybe(name)
        for name in (names.echo, names.alarm, names.limit, names.config_revision, names.aff_echo)
    ]
    channels = tuple(
        CanChannel(name=name, field=field(signal), scale=scale, wraps=wraps)
        for name, (signal, scale, wraps) in names.channels.items()
    )
    corrections = tuple(
        CanCorrection(name=name, field=field(signal), complement=maybe(copy), scale=scale)
        for name, (signal, copy, scale) in names.corrections.items()
    )
    applied = applied_readings(names, field)
    frames = sorted((_layout(m) for m in used.values()), key=lambda layout: layout.can_id)
    return CanMap(
        frames=tuple(frames),
        plc_heartbeat=words[0],
        status=words[1],
        roll_id=words[2],
        channels=channels,
        aff_heartbeat=own[0],
        state=own[1],
        corrections=corrections,
        echo=optional[0],
        alarm=optional[1],
        limit=optional[2],
        config_revision=optional[3],
        aff_echo=optional[4],
        applied=applied,
        recorded_only=names.recorded_only,
    )


def dbc_signals(database: Database) -> tuple[NamedSignal, ...]:
    """Return every signal of the file that a site could name, in the order of the file.

    What no site file may name is left out: frames of more than 8 bytes, nested pages, selectors of
    pages, and the sender's ``Counter``, which is taken unasked.
    """
    found = []
    for message in database.messages:
        try:
            layout = _layout(message)
            fields = [
                (signal, field_of(message, signal))
                for signal in message.signals
                if not signal.is_multiplexer and signal.name != COUNTER_NAME
            ]
        except ConfigError:
            continue
        found += [
            NamedSignal(
                name=str(field),
                field=field,
                layout=layout,
                called=signal.name,
                owner=message.name,
                unit=signal.unit or "",
                senders=tuple(message.senders),
            )
            for signal, field in fields
        ]
    return tuple(found)


def field_of(message: Message, signal: Signal) -> Field:
    """Return where a signal sits; Motorola start bits count from the most significant bit."""
    big = signal.byte_order == "big_endian"
    shift = signal.start
    if big:
        first = 8 * (signal.start // 8) + 7 - signal.start % 8
        shift = 8 * message.length - first - signal.length
    ids = signal.multiplexer_ids
    if ids is not None and len(ids) != 1:
        raise ConfigError(f"{message.name}.{signal.name}: one multiplexer value, not {ids}")
    return Field(
        name=signal.name,
        frame=message.name,
        shift=shift,
        length=signal.length,
        big_endian=big,
        signed=signal.is_signed,
        is_float=signal.is_float,
        factor=float(signal.scale),
        offset=float(signal.offset),
        minimum=-math.inf if signal.minimum is None else float(signal.minimum),
        maximum=math.inf if signal.maximum is None else float(signal.maximum),
        selector=None if ids is None else ids[0],
    )


def _layout(message: Message) -> FrameLayout:
    selectors = [s for s in message.signals if s.is_multiplexer]
    if len(selectors) > 1 or any(s.multiplexer_ids for s in selectors):
        raise ConfigError(f"{message.name}: nested multiplexing is not read")
    counters = [s for s in message.signals if s.name == COUNTER_NAME]
    return FrameLayout(
        name=message.name,
        can_id=message.frame_id,
        extended=message.is_extended_frame,
        length=message.length,
        multiplexer=field_of(message, selectors[0]) if selectors else None,
        counter=field_of(message, counters[0]) if counters else None,
        pages=len({page for s in message.signals for page in s.multiplexer_ids or ()}),
    )


def _find(database: Database, name: str) -> tuple[Message, Signal]:
    message_name, _, signal_name = name.partition(".")
    for message in database.messages:
        if message.name == message_name:
            for signal in message.signals:
                if signal.name == signal_name:
                    return message, signal
            known = ", ".join(signal.name for signal in message.signals)
            raise NamedError(name, f"{message_name} has no such signal; it has {known}")
    known = ", ".join(message.name for message in database.messages)
    said = f"there is no message {message_name}" if signal_name else "write MESSAGE.Signal"
    raise NamedError(name, f"{said}; the messages are {known}")
