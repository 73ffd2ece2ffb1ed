"""What each word on the wire means: register records and the map of one gateway."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.signals import Status

MAX_READ_WORDS = 125
MAX_WRITE_WORDS = 121


class WordType(StrEnum):
    """Type of one value on the wire."""

    U16 = "u16"
    I16 = "i16"
    U32 = "u32"
    I32 = "i32"
    F32 = "f32"

    @property
    def word_count(self) -> int:
        """Number of 16-bit words."""
        return 1 if self in (WordType.U16, WordType.I16) else 2


class WordOrder(StrEnum):
    """Which half of a double word comes first on the wire."""

    HIGH_FIRST = "high_first"
    LOW_FIRST = "low_first"


def wire_address(register: int, address_base: int) -> int:
    """Turn a register number as printed in a manual into the zero-based address on the wire.

    Parameters
    ----------
    register : number from the manual.
    address_base : 0 when the manual counts from 0, 1 when it counts from 1. With base 1 the
        holding register references 40001..49999 and 400001..465536 lose their prefix as well.

    Raises
    ------
    ConfigError
        When the result is no wire address.
    """
    if address_base not in (0, 1):
        raise ConfigError(f"address_base {address_base}: write 0 or 1")
    address = register - address_base
    if address_base == 1 and 40001 <= register <= 49999:
        address = register - 40001
    elif address_base == 1 and 400001 <= register <= 465536:
        address = register - 400001
    if not 0 <= address <= 0xFFFF:
        raise ConfigError(
            f"register {register} with address_base {address_base} gives wire address "
            f"{address}, outside 0..65535"
        )
    return address


@dataclass(frozen=True, slots=True, kw_only=True)
class Register:
    """One value of one or two words.

    Attributes
    ----------
    name : channel name with its SI unit, ``unwind_tension_N``.
    address : zero-based wire address of its first word.
    type : type on the wire.
    scale : SI units per count; may be negative, never 0.
    word_order : order of the two halves, used by 32-bit types only.
    wraps : True when the counter runs through its range, so that steps unwrap it.
    wraps_after : counts after which it starts over; 0 where that is all that its words hold.
    """

    name: str
    address: int
    type: WordType = WordType.U16
    scale: float = 1.0
    word_order: WordOrder = WordOrder.HIGH_FIRST
    wraps: bool = False
    wraps_after: int = 0

    def __post_init__(self) -> None:
        if not 0 <= self.address <= 0x10000 - self.type.word_count:
            raise ConfigError(f"{self.name}: wire address {self.address} outside 0..65535")
        if not math.isfinite(self.scale) or self.scale == 0.0:
            raise ConfigError(f"{self.name}: scale {self.scale} must be finite and not 0")
        if self.wraps and self.type is WordType.F32:
            raise ConfigError(f"{self.name}: an f32 has no counter range to wrap; use i32 or u32")
        if not 0 <= self.wraps_after <= 1 << (16 * self.type.word_count):
            raise ConfigError(f"{self.name}: its words hold no {self.wraps_after} counts")

    @property
    def addresses(self) -> range:
        """Wire addresses of its words."""
        return range(self.address, self.address + self.type.word_count)


@dataclass(frozen=True, slots=True, kw_only=True)
class Correction:
    """One correction word and, where the PLC checks one, its ones-complement copy.

    ``complement_address`` is the first word of the copy; None when the device has none.
    """

    register: Register
    complement_address: int | None

    def __post_init__(self) -> None:
        name, kind = self.register.name, self.register.type
        if kind in (WordType.U16, WordType.U32):
            raise ConfigError(f"{name}: a correction has a sign; use i16, i32 or f32, not {kind}")
        if self.register.wraps:
            raise ConfigError(f"{name}: a correction cannot wrap")
        last = 0x10000 - kind.word_count
        if self.complement_address is not None and not 0 <= self.complement_address <= last:
            raise ConfigError(f"{name}: complement address {self.complement_address} not on wire")

    @property
    def addresses(self) -> tuple[int, ...]:
        """Wire addresses of the value and of its copy."""
        own = tuple(self.register.addresses)
        if self.complement_address is None:
            return own
        return own + tuple(range(self.complement_address, self.complement_address + len(own)))


@dataclass(frozen=True, slots=True, kw_only=True)
class StatusPlace:
    """Where the PLC has one status bit.

    Attributes
    ----------
    means : the bit of ``Status`` that it is.
    address, bit : wire address of its word, and its place there, 0..15.
    inverted : True when 0 means yes.
    """

    means: Status
    address: int
    bit: int
    inverted: bool = False

    def __post_init__(self) -> None:
        if not 0 <= self.bit <= 15:
            raise ConfigError(f"status bit {self.means.name}: bit {self.bit} outside 0..15")


@dataclass(frozen=True, slots=True, kw_only=True)
class RegisterMap:
    """Every word this service reads and every word it writes, nothing else.

    Attributes
    ----------
    plc_heartbeat, status, roll_id : addresses of the three u16 words every PLC must show.
    channels : readings in the order of ``Snapshot.values``.
    aff_heartbeat, state, echo : addresses of the three words every PLC must take.
    aff_echo : address at which the PLC shows the ``aff_heartbeat`` it took; None without one.
    status_places : where each status bit stands; empty when ``status`` has them in our own order.
    applied : per correction the word in which the PLC shows what of it it applies, None without
        one; empty where there is none at all.
    alarm, limit, config_revision : addresses, None where the device has no such word; ``limit``
        is the limit in force of the first correction, in its counts.
    corrections : in the order of ``Command.corrections``.

    Raises
    ------
    ConfigError
        For a gap in the write block, a word with two owners, or a block too long for one frame.
    """

    plc_heartbeat: int
    status: int
    roll_id: int
    channels: tuple[Register, ...]
    aff_heartbeat: int
    state: int
    echo: int
    corrections: tuple[Correction, ...]
    alarm: int | None = None
    limit: int | None = None
    config_revision: int | None = None
    aff_echo: int | None = None
    applied: tuple[Register | None, ...] = ()
    status_places: tuple[StatusPlace, ...] = ()

    def __post_init__(self) -> None:
        self._check_read_block()
        self._check_write_block()

    @property
    def read_start(self) -> int:
        """First address of the read block."""
        return min(self._read_addresses())

    @property
    def read_count(self) -> int:
        """Words in the read block."""
        return max(self._read_addresses()) + 1 - self.read_start

    @property
    def write_start(self) -> int:
        """First address of the write block."""
        return min(address for address, _ in self._write_owners())

    @property
    def write_count(self) -> int:
        """Words in the write block."""
        return max(address for address, _ in self._write_owners()) + 1 - self.write_start

    def _read_addresses(self) -> list[int]:
        words = [self.plc_heartbeat, self.status, self.roll_id]
        if self.aff_echo is not None:
            words.append(self.aff_echo)
        words.extend(place.address for place in self.status_places)
        for register in (*self.channels, *self.applied):
            words.extend(register.addresses if register is not None else ())
        return words

    def _write_owners(self) -> list[tuple[int, str]]:
        named = (
            ("aff_heartbeat", self.aff_heartbeat),
            ("state", self.state),
            ("echo", self.echo),
            ("alarm", self.alarm),
            ("limit", self.limit),
            ("config_revision", self.config_revision),
        )
        owners = [(address, name) for name, address in named if address is not None]
        for correction in self.corrections:
            owners.extend((address, correction.register.name) for address in correction.addresses)
        return owners

    def _check_read_block(self) -> None:
        if len(self.applied) not in (0, len(self.corrections)):
            raise ConfigError("applied: give one entry per correction, or none at all")
        addresses = self._read_addresses()
        if min(addresses) < 0 or max(addresses) > 0xFFFF:
            raise ConfigError("read block: an address lies outside 0..65535")
        if self.read_count > MAX_READ_WORDS:
            raise ConfigError(
                f"read block {self.read_start}..{max(addresses)} has {self.read_count} words, "
                f"one frame carries {MAX_READ_WORDS}; move the registers closer together"
            )

    def _check_write_block(self) -> None:
        owner_of: dict[int, str] = {}
        theirs = set(self._read_addresses())
        for address, name in self._write_owners():
            if not 0 <= address <= 0xFFFF:
                raise ConfigError(f"write {name}: wire address {address} outside 0..65535")
            if address in owner_of:
                raise ConfigError(
                    f"write {name}: wire address {address} already carries {owner_of[address]}"
                )
            if address in theirs:
                raise ConfigError(f"write {name}: wire address {address} is a word the PLC writes")
            owner_of[address] = name
        block = range(self.write_start, self.write_start + self.write_count)
        gaps = [address for address in block if address not in owner_of]
        if gaps:
            raise ConfigError(
                f"write block {block[0]}..{block[-1]} would overwrite wire address "
                f"{', '.join(map(str, gaps[:8]))}, which is not ours; close the gap"
            )
        if len(block) > MAX_WRITE_WORDS:
            raise ConfigError(
                f"write block has {len(block)} words, one frame carries {MAX_WRITE_WORDS}"
            )
