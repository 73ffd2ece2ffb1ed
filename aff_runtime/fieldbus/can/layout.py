"""Where every signal sits in its CAN frame, and which signals the runtime reads and writes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from aff_runtime.base.errors import ConfigError
from aff_runtime.fieldbus.signal_names import NamedError, SignalNames

PLC_HEARTBEAT_BITS = 8  # 256 scans: even at 1 ms three times the shipped fault_after_ms
AFF_HEARTBEAT_BITS = 16
MOST_BYTES = 8
_ROUNDING = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """One signal: its bits, seen from the frame read as one integer in the field's byte order.

    Attributes
    ----------
    name, frame : names of the signal and of its frame.
    shift : bits to the right of the field in that integer.
    length : bits of the field.
    big_endian : Motorola byte order.
    signed, is_float : how the bits are a number.
    factor, offset : physical value = count * factor + offset.
    minimum, maximum : believable physical range, infinite where none is given.
    selector : value of the frame's multiplexer under which the field is present; None: always.
    """

    name: str
    frame: str
    shift: int
    length: int
    big_endian: bool = False
    signed: bool = False
    is_float: bool = False
    factor: float = 1.0
    offset: float = 0.0
    minimum: float = -math.inf
    maximum: float = math.inf
    selector: int | None = None

    def __post_init__(self) -> None:
        if not 1 <= self.length <= 64:
            raise ConfigError(f"{self}: {self.length} bits; a CAN signal has 1..64")
        if self.is_float and self.length not in (32, 64):
            raise ConfigError(f"{self}: a float has 32 or 64 bits")
        if not math.isfinite(self.factor) or self.factor == 0.0 or not math.isfinite(self.offset):
            raise ConfigError(
                f"{self}: factor {self.factor} and offset {self.offset} are no scale"
            )
        if self.minimum > self.maximum:
            text = f"its range is {self.minimum:g} to {self.maximum:g}; no value is in it"
            raise NamedError(str(self), text)

    def __str__(self) -> str:
        """Return ``FRAME.Signal``."""
        return f"{self.frame}.{self.name}"

    @property
    def mask(self) -> int:
        """Return as many ones as the field has bits."""
        return (1 << self.length) - 1

    @property
    def count_range(self) -> tuple[int, int]:
        """Return the least and the largest count the bits can hold."""
        if self.signed:
            return -(1 << (self.length - 1)), (1 << (self.length - 1)) - 1
        return 0, self.mask

    @property
    def sent_counts(self) -> tuple[int, int]:
        """Return the least and the largest count that may be sent: bits, and the stated range."""
        least, most = self.count_range
        bounds = [(b - self.offset) / self.factor for b in (self.minimum, self.maximum)]
        if math.isfinite(min(bounds)):
            least = max(least, math.ceil(min(bounds) - _ROUNDING))
        if math.isfinite(max(bounds)):
            most = min(most, math.floor(max(bounds) + _ROUNDING))
        return least, most


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameLayout:
    """One frame on the bus.

    Attributes
    ----------
    multiplexer : the field that selects among the others; None for a plain frame.
    counter : the field that repeats the low bits of the sender's heartbeat; None without one.
    pages : how many pages the sender may go round, whoever reads them; 0 for a plain frame.
    """

    name: str
    can_id: int
    extended: bool
    length: int
    multiplexer: Field | None = None
    counter: Field | None = None
    pages: int = 0

    def __post_init__(self) -> None:
        if not 1 <= self.length <= MOST_BYTES:
            text = (
                f"has {self.length} bytes; a classic CAN frame with a signal has 1 to {MOST_BYTES}"
            )
            raise ConfigError(f"{self.name}: {text}")


@dataclass(frozen=True, slots=True, kw_only=True)
class CanChannel:
    """One reading: SI = physical value * scale; ``wraps`` for angles that start over."""

    name: str
    field: Field
    scale: float = 1.0
    wraps: bool = False

    @property
    def modulus(self) -> int:
        """Return after how many counts the reading starts over; 0 when it does not.

        All counts of its bits, or those of the signal's range where that is narrower. A range
        that names both ends of a turn, 0 to 360 degrees, has one count less: both are one place.
        """
        field = self.field
        if not self.wraps:
            return 0
        ends = [(bound - field.offset) / field.factor for bound in (field.minimum, field.maximum)]
        if not all(map(math.isfinite, ends)):
            return field.mask + 1
        counts = round(abs(ends[1] - ends[0])) + 1
        if not 2 <= counts <= field.mask:
            return field.mask + 1
        count_rad = abs(field.factor * self.scale)
        is_double = _is_turns((counts - 1) * count_rad) and not _is_turns(counts * count_rad)
        return counts - is_double


def _is_turns(angle_rad: float) -> bool:
    turns = angle_rad / (2.0 * math.pi)
    return round(turns) >= 1 and abs(turns - round(turns)) < 1e-6 * turns


@dataclass(frozen=True, slots=True, kw_only=True)
class CanCorrection:
    """One correction and, where the receiver checks one, its ones complement."""

    name: str
    field: Field
    complement: Field | None
    scale: float = 1.0

    @property
    def reach(self) -> tuple[float, float]:
        """Return the least and the largest correction that the signal can carry, SI."""
        field = self.field
        ends = [(count * field.factor + field.offset) * self.scale for count in field.sent_counts]
        return min(ends), max(ends)


@dataclass(frozen=True, slots=True, kw_only=True)
class CanMap:
    """Every signal that is read and every signal that is written.

    ``applied`` : per correction the reading of what the PLC or drive applies, None without one;
    empty where there is none at all. ``recorded_only`` : names of channels that are for the record
    alone; a frame that carries nothing else belongs to no set.

    Raises
    ------
    ConfigError
        A frame is read and written, a field has two owners, two frames share an identifier, a word
        is too narrow or signless.
    """

    frames: tuple[FrameLayout, ...]
    plc_heartbeat: Field
    status: Field
    roll_id: Field
    channels: tuple[CanChannel, ...]
    aff_heartbeat: Field
    state: Field
    corrections: tuple[CanCorrection, ...]
    echo: Field | None = None
    alarm: Field | None = None
    limit: Field | None = None
    config_revision: Field | None = None
    aff_echo: Field | None = None
    applied: tuple[CanChannel | None, ...] = ()
    recorded_only: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        _check_owners(self)
        _check_words(self)

    @property
    def read_fields(self) -> tuple[Field, ...]:
        """Return what is read."""
        words = (self.plc_heartbeat, self.status, self.roll_id)
        echo = () if self.aff_echo is None else (self.aff_echo,)
        readings = (*self.channels, *(shown for shown in self.applied if shown is not None))
        return words + echo + tuple(reading.field for reading in readings)

    @property
    def set_frames(self) -> frozenset[str]:
        """Return the frames of a set: those that carry a word, or a reading that is waited for."""
        extra = {c.field for c in self.channels if c.name in self.recorded_only}
        return frozenset(field.frame for field in self.read_fields if field not in extra)

    @property
    def write_fields(self) -> tuple[Field, ...]:
        """Return what is written, multiplexers and counters aside."""
        words = (self.aff_heartbeat, self.state, self.echo, self.alarm, self.limit)
        fields = [field for field in (*words, self.config_revision) if field is not None]
        for correction in self.corrections:
            fields.append(correction.field)
            if correction.complement is not None:
                fields.append(correction.complement)
        return tuple(fields)

    def frames_of(self, fields: tuple[Field, ...]) -> tuple[FrameLayout, ...]:
        """Return the frames that carry any of ``fields``, in the order of the map."""
        wanted = {field.frame for field in fields}
        return tuple(frame for frame in self.frames if frame.name in wanted)


def applied_readings(
    names: SignalNames, place: Callable[[str], Field]
) -> tuple[CanChannel | None, ...]:
    """Return per correction the reading that shows it applied; empty where none does.

    ``place`` finds the field of a signal.
    """
    found: list[CanChannel | None] = []
    for name in names.corrections if names.applied else ():
        signal, scale = names.applied.get(name, ("", 1.0))
        label = f"applied.{name}"
        found.append(CanChannel(name=label, field=place(signal), scale=scale) if signal else None)
    return tuple(found)


def _check_owners(can_map: CanMap) -> None:
    read = {field.frame for field in can_map.read_fields}
    seen: set[str] = set()
    taken: set[str] = set()
    for field in can_map.read_fields:
        if str(field) in taken:
            raise NamedError(str(field), "is read twice; give every reading its own signal")
        taken.add(str(field))
    for field in can_map.write_fields:
        if field.frame in read:
            text = (
                f"is written, but {field.frame} is read as well, and a frame has one sender. "
                "Take one of the two from another frame"
            )
            raise NamedError(str(field), text)
        if str(field) in seen:
            raise NamedError(str(field), "is written twice; give every value its own signal")
        seen.add(str(field))
    owner: dict[tuple[int, bool], str] = {}
    for frame in can_map.frames:
        other = owner.setdefault((frame.can_id, frame.extended), frame.name)
        if other != frame.name:
            raise ConfigError(
                f"{other} and {frame.name} both have the identifier 0x{frame.can_id:X}; "
                "nobody can tell them apart. Give each its own"
            )
    frames = {frame.name: frame for frame in can_map.frames}
    for field in (*can_map.read_fields, *can_map.write_fields):
        if field.frame not in frames:
            raise ConfigError(f"{field}: no frame {field.frame}")
        page = frames[field.frame].multiplexer
        if field.selector is not None and (page is None or field.selector > page.mask):
            raise NamedError(str(field), f"its page {field.selector} can never be shown")


def _check_words(can_map: CanMap) -> None:
    if can_map.plc_heartbeat.selector is not None:
        raise ConfigError(f"{can_map.plc_heartbeat}: a heartbeat cannot be multiplexed")
    _check_heartbeats(can_map)
    words = (can_map.plc_heartbeat, can_map.status, can_map.roll_id, can_map.aff_heartbeat)
    for word in (*words, can_map.aff_echo):
        if word is not None and word.is_float:
            raise ConfigError(f"{word}: a counter or bit word cannot be a float")
    _check_applied(can_map)
    for channel in can_map.channels:
        if channel.wraps and channel.field.is_float:
            raise ConfigError(f"{channel.field}: a float has no counter range to wrap")
        if not math.isfinite(channel.scale) or channel.scale == 0.0:
            raise ConfigError(f"{channel.name}: scale {channel.scale} must be finite and not 0")
    for correction in can_map.corrections:
        field, copy = correction.field, correction.complement
        if field.is_float:
            raise NamedError(str(field), "a correction cannot be a float; use a signed signal")
        least, most = correction.reach
        if not least < 0.0 < most:
            text = (
                f"carries {least:g} to {most:g}, but a correction has a sign and rests at 0. "
                "Use a signed signal whose range, by bits, offset and bounds, has 0 within"
            )
            raise NamedError(str(field), text)
        zero = field.offset / field.factor
        if abs(zero - round(zero)) > _ROUNDING:
            text = f"no count of it is zero: factor {field.factor:g}, offset {field.offset:g}"
            raise NamedError(str(field), text)
        if copy is not None and copy.length != field.length:
            raise ConfigError(f"{copy}: the complement has {copy.length} bits, not {field.length}")
        if not math.isfinite(correction.scale) or correction.scale == 0.0:
            raise ConfigError(f"{correction.name}: scale must be finite and not 0")


def _check_applied(can_map: CanMap) -> None:
    if len(can_map.applied) not in (0, len(can_map.corrections)):
        raise ConfigError("applied: give one entry per correction, or none at all")
    for reading in can_map.applied:
        if reading is None:
            continue
        if reading.field.is_float:
            text = "an applied correction cannot be a float; use a signed signal"
            raise NamedError(str(reading.field), text)
        if not math.isfinite(reading.scale) or reading.scale == 0.0:
            raise ConfigError(f"{reading.name}: scale must be finite and not 0")


def _check_heartbeats(can_map: CanMap) -> None:
    """Refuse counters that start over while somebody still waits for them to move."""
    beat, ours = can_map.plc_heartbeat, can_map.aff_heartbeat
    if beat.length < PLC_HEARTBEAT_BITS:
        text = (
            f"has {beat.length} bits and starts over after {1 << beat.length} scans. Within the "
            "time in which the PLC must be seen to live (fault_after_ms) an old scan could pass "
            f"for a new one, and a running PLC for a stopped one. Use {PLC_HEARTBEAT_BITS} bits "
            "or more"
        )
        raise NamedError(str(beat), text)
    if ours.length < AFF_HEARTBEAT_BITS:
        text = (
            f"has {ours.length} bits. The PLC's half (AFF_GATEWAY) tells a second master by a "
            f"jump of this counter, and each start over would be one. Use {AFF_HEARTBEAT_BITS} "
            "bits or more"
        )
        raise NamedError(str(ours), text)
    echo = can_map.aff_echo
    if echo is not None and echo.length < AFF_HEARTBEAT_BITS:
        text = (
            f"has {echo.length} bits, but must hold all of aff_heartbeat: by a part of it another "
            f"master could pass for us. Use {AFF_HEARTBEAT_BITS} bits or more"
        )
        raise NamedError(str(echo), text)
    for frame in can_map.frames:
        sender = beat if frame in can_map.frames_of(can_map.read_fields) else ours
        if frame.counter is not None and frame.counter.length > sender.length:
            text = (
                f"has {frame.counter.length} bits, but repeats the low bits of {sender}, which "
                f"has {sender.length}. Make it as short, or give it another name"
            )
            raise NamedError(str(frame.counter), text)
