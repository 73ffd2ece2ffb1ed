"""Words of ``gateway``: what is read and written, and where each one sits."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from aff_runtime.base.runs.counted_angle import WORD_COUNTS
from aff_runtime.config.quantity import (
    Few,
    Flag,
    Name,
    Register,
    Section,
    SiPerCount,
    Text,
    Whole,
    key,
)

WordType = Literal["u16", "i16", "u32", "i32"]
SIGNAL = (
    "Signal that carries it, on CAN: MESSAGE.Signal of the DBC file, or NODE.0xIIII of an object "
    "in a PDO on CANopen."
)


def _register(text: str) -> Any:
    """Declare the number of a register; absent on CAN."""
    return key(text, default=None, alias="register", ge=0, le=465536)


class ReadWord(Section):
    """A status word that the PLC writes and AFF reads."""

    register_number: Register | None = _register(
        "Number of the register, counted as address_base says; on Modbus."
    )
    signal: Text | None = key(SIGNAL, default=None)
    type: Literal["u16"] = key("Word type; these words are always u16.", default="u16")


class StatusBit(Section):
    """Where one status bit stands, and which state of it means yes."""

    register_number: Register | None = _register(
        "Number of the register it stands in, counted as address_base says. Absent: that of "
        "status. The same register may carry other bits, but no other value."
    )
    bit: Annotated[int, Whole("bit")] = key("Its place in the word; 0 counts 1.", ge=0, le=15)
    inverted: Flag = key(
        "true when 0 means yes (a WEB_INTACT that the PLC has as web break).", default=False
    )


class StatusBits(Section):
    """The bits of a PLC that has status words of its own; a bit that is not here reads 0."""

    LINE_RUN: StatusBit | None = key("The line runs: nothing is corrected at rest.", default=None)
    AFF_ENABLE_REQUEST: StatusBit | None = key(
        "The PLC lets AFF correct; needed unless permissives.enable_from_plc is false.",
        default=None,
    )
    REMOTE: StatusBit | None = key("The line is in remote operation.", default=None)
    WEB_INTACT: StatusBit | None = key("No web break is seen.", default=None)
    SPLICE_ACTIVE: StatusBit | None = key(
        "A splice runs; rolls with resets_on: splice forget.", default=None
    )
    TENSION_VALID: StatusBit | None = key("The tension reading may be used.", default=None)
    ESTOP_OK: StatusBit | None = key("No emergency stop is active.", default=None)
    RESET_EDGE: StatusBit | None = key("Its rise is a reset of AFF's fault.", default=None)

    @property
    def given(self) -> dict[str, StatusBit]:
        """Return the bits that have a place, by name."""
        placed = {name: getattr(self, name) for name in type(self).model_fields}
        return {name: place for name, place in placed.items() if place is not None}


class StatusWord(ReadWord):
    """The status word of the PLC; without ``bits`` in AFF's own order of bits."""

    bits: StatusBits | None = key(
        "Where each status bit stands, for a PLC with status words of its own; on Modbus. "
        "Absent: LINE_RUN is bit 0 of the word, then AFF_ENABLE_REQUEST, REMOTE, WEB_INTACT, "
        "SPLICE_ACTIVE, TENSION_VALID, ESTOP_OK and RESET_EDGE, bit 7.",
        default=None,
    )


class Channel(Section):
    """A measured value; the name of the key ends with its SI unit."""

    register_number: Register | None = _register(
        "Number of its (first) register, counted as address_base says; on Modbus."
    )
    signal: Text | None = key(SIGNAL, default=None)
    type: WordType | None = key(
        "How the device stores it: u16 or i16 in one word, u32 or i32 in two; on Modbus. Wrong "
        "sign or jumps at 32768 mean u16 and i16 are mixed up.",
        default=None,
    )
    scale: SiPerCount = key(
        "SI units in one count (on CAN: in one physical unit of the signal), from the manual; "
        "may be text with a unit (`0.1 mm`), of an angle `4096 counts/turn`. "
        "Change it when the value differs from the drive's display by a fixed factor. "
        "Negative when the device counts against the web direction.",
        ge=-1e6,
        le=1e6,
    )
    wraps: Flag = key(
        "true when the count starts over after its largest value (encoder angles).", default=False
    )
    wraps_after: Annotated[int, Whole("counts")] | None = key(
        "On Modbus, counts after which it starts over, where its word holds more: 4096 for an "
        "encoder of one turn, 3600 for an axis in tenths of a degree. On CAN the range of the "
        "signal says it.",
        default=None,
        ge=8,
        le=4294967296,
    )

    @property
    def range_rad(self) -> float | None:
        """Return after how much an angle starts over, rad; None where its word does not say."""
        return self.range_counts * abs(self.scale) or None

    @property
    def range_counts(self) -> int:
        """Return after how many counts it starts over; 0 where it does not, or nobody says."""
        if self.type is None or not self.wraps:
            return 0
        return self.wraps_after or WORD_COUNTS[self.type]


class Applied(Section):
    """The correction of one actuator as the PLC or drive adds it, after its own limit and fade."""

    register_number: Register | None = _register("Register of the applied correction; on Modbus.")
    signal: Text | None = key(SIGNAL, default=None)
    type: Literal["i16"] = key("Word type on Modbus: always i16.", default="i16")
    scale: SiPerCount = key(
        "Applied correction in one count, in the actuator's unit; on CAN the DBC's factor. What "
        "differs by less than one count of this and one of the correction is the same.",
        ge=1e-9,
        le=100,
    )


class ReadBlock(Section):
    """What AFF reads each tick, in one block of at most 125 words."""

    plc_heartbeat: ReadWord = key(
        "Counter that the PLC raises each scan; proof of life. A step back is an old reading: "
        "a bit that toggles proves nothing."
    )
    status: StatusWord = key("Status bits of the PLC: permissives, enable request, splice.")
    roll_id: ReadWord = key("Counter of splices; a new number resets what resets_on: splice.")
    aff_echo: ReadWord | None = key(
        "Copy of the aff_heartbeat that the PLC took in this scan. Without it nothing tells on "
        "Modbus that another master always writes after us, so that nothing of ours counts.",
        default=None,
    )
    applied: Annotated[Mapping[Name, Applied], *Few] | None = key(
        "By actuator, the correction that the PLC or drive really adds: after its own limit, "
        "fade and watchdog. AFF compares it with what it sent: somebody who writes corrections "
        "to the PLC beside us is APPLIED_DIFFERS. Needs aff_echo. The PLC's ramp to zero takes "
        "0.1 s at most.",
        default=None,
    )
    channels: Annotated[Mapping[Name, Channel], *Few] = key(
        "Measured values by name. The end of the name is the SI unit: _N, _m_s, _m, _rad, "
        "_rad_s, _N_m; _number is a number without one. One that no roll, actuator, believable "
        "range or line speed of this file names is for the record alone: no correction waits for "
        "it, `sim-plant refine` and `aff-runtime watch` read it."
    )


class WriteWord(Section):
    """A u16 word that AFF alone writes."""

    register_number: Register | None = _register(
        "Number of the register, counted as address_base says; on Modbus."
    )
    signal: Text | None = key(SIGNAL, default=None)


class Correction(Section):
    """The correction of one actuator, with its ones complement as proof of integrity."""

    register_number: Register | None = _register("Register of the correction; on Modbus.")
    complement: Register | None = key(
        "Register of its ones complement; the PLC drops the correction when the two differ.",
        default=None,
        ge=0,
        le=465536,
    )
    signal: Text | None = key(SIGNAL, default=None)
    complement_signal: Text | None = key(
        "Signal of its ones complement, on CAN; the PLC drops the correction when the two "
        "differ. Absent only where the device has no such check.",
        default=None,
    )
    type: Literal["i16"] = key("Word type on Modbus: always i16.", default="i16")
    scale: SiPerCount = key(
        "Correction in one count: m/s for velocity_reference, N m for torque_reference; may be "
        "text with a unit. Make it finer when check says that a limit is under 5 counts, "
        "coarser when the limit does not fit the word. The PLC must use the same number.",
        ge=1e-9,
        le=100,
    )


class WriteBlock(Section):
    """What AFF writes each tick: one block without holes. Nothing else is ever written."""

    aff_heartbeat: WriteWord = key("Counter that AFF moves each tick; the PLC watches it.")
    state: WriteWord = key(
        "State bits of AFF: ready, armed, active, fading, bypass, saturated, fault."
    )
    echo: WriteWord = key("Copy of the last plc_heartbeat; proof of the round trip.")
    alarm: WriteWord = key("Code of the present alarm, 0 when none.")
    limit: WriteWord = key("Limit in force of the first actuator, in counts of its correction.")
    config_revision: WriteWord = key(
        "Low 16 bits of the hash of site file and learned files, as `status` shows them."
    )
    corrections: Annotated[Mapping[Name, Correction], *Few] = key(
        "One correction per actuator, by the actuator's name."
    )
