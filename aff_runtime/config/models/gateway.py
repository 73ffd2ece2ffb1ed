"""Section ``gateway``: the connection to the PLC and its register map."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from annotated_types import MaxLen

from aff_runtime.config.quantity import (
    Few,
    Flag,
    Milliseconds,
    Name,
    Register,
    Section,
    SiPerCount,
    Text,
    Whole,
    key,
)

WordType = Literal["u16", "i16", "u32", "i32"]
CanInterface = Literal["socketcan", "slcan_tty", "frame_socket", "udp_multicast"]
WIRES = ("modbus_tcp", "modbus_rtu", "can_dbc", "canopen_402")
Node = Annotated[int, Whole("node id")]
SIGNAL = (
    "Signal that carries it, on CAN: MESSAGE.Signal of the DBC file, or NODE.0xIIII of an object "
    "in a PDO on CANopen."
)
INTERFACE = (
    "socketcan on the gateway; slcan_tty for a serial adapter without a kernel driver; "
    "frame_socket (a unix socket) and udp_multicast for benches."
)
CAN_DEADLINE = (
    "Longest wait for the PLC's frames in one tick. Raise it when status shows timeouts on a "
    "healthy bus; it must stay below cycle_ms."
)


class Tls(Section):
    """Modbus/TCP Security; file names are relative to the folder of the site file."""

    ca: Text = key("Certificate (PEM) that the PLC's certificate is checked against.")
    certificate: Text | None = key(
        "Our own certificate (PEM), for a PLC that asks for one.", default=None
    )
    private_key: Text | None = key(
        "Its key (PEM); readable by the service's user alone.", default=None
    )
    server_name: Text | None = key("Name in the PLC's certificate. Absent: host.", default=None)


class ModbusTcp(Section):
    """How the PLC or gateway is reached."""

    host: Text = key("Address of the PLC or gateway. Change it when the network plan changes.")
    tls: Tls | None = key("Modbus/TCP Security, usually on port 802.", default=None)
    port: Annotated[int, Whole("TCP port")] = key(
        "TCP port of its Modbus server. Change it only when the device says another.",
        default=502,
        ge=1,
        le=65535,
    )
    device_id: Annotated[int, Whole("unit identifier")] = key(
        "Modbus unit identifier. Change it behind a serial gateway or when the device "
        "answers to one number alone.",
        default=1,
        ge=0,
        le=255,
    )
    deadline_ms: Milliseconds = key(
        "Longest wait for the reply of one tick; a later reply counts as lost. Raise it when "
        "status shows timeouts on a healthy network; it must stay below cycle_ms.",
        default=3.0,
        ge=0.5,
        le=50,
    )
    function: Literal["fc23", "fc3_fc16"] = key(
        "Function codes: fc23 reads and writes in one request; fc3_fc16 uses two, for a "
        "device that lacks fc23 (it answers with exception 1).",
        default="fc23",
    )


class ModbusRtu(Section):
    """How a device on a serial line is reached."""

    device: Text = key("Serial line of the gateway, /dev/ttyS0.")
    baud: Annotated[int, Whole("bit/s")] = key(
        "Bit rate of the line; `check` refuses one that is too slow for the cycle.",
        default=115_200,
        ge=9_600,
        le=1_000_000,
    )
    parity: Literal["none", "even", "odd"] = key("Parity, as the device is set.", default="even")
    stop_bits: Annotated[Literal[1, 2], Whole("stop bits")] = key(
        "Stop bits, as the device is set; the standard has 2 without parity.", default=1
    )
    device_id: Annotated[int, Whole("unit identifier")] = key(
        "Number of the device on the line.", default=1, ge=1, le=247
    )
    deadline_ms: Milliseconds = key(
        "Longest wait for the reply of one tick; it must stay below cycle_ms.",
        default=8.0,
        ge=0.5,
        le=90,
    )
    function: Literal["fc23", "fc3_fc16"] = key(
        "Function codes: fc23 reads and writes in one request; fc3_fc16 uses two.",
        default="fc23",
    )


class CanDbc(Section):
    """How the PLC is reached on CAN; the DBC file says where every signal sits."""

    interface: CanInterface = key(INTERFACE, default="socketcan")
    channel: Text = key("CAN interface of the gateway (can0), or the tty of an slcan adapter.")
    bitrate: Annotated[int, Whole("bit/s")] = key(
        "Bit rate of the bus, for the load and for slcan; SocketCAN's own is set by the system. "
        "Use 1 Mbit/s or 500 kbit/s.",
        default=500_000,
        ge=10_000,
        le=1_000_000,
    )
    dbc: Text = key("DBC file, relative to the folder of the site file.")
    deadline_ms: Milliseconds = key(CAN_DEADLINE, default=3.0, ge=0.5, le=50)


class ObjectValue(Section):
    """One object of a CANopen node and the value it must have."""

    object: Text = key("Index in quotes, `0x6007`, or with its subindex, `0x2030:1`.")
    value: Annotated[int, Whole("count")] = key(
        "Value written at start and read back; a node that says another is not started.",
        ge=-(2**31),
        le=2**32 - 1,
    )


class CanopenNode(Section):
    """One node of the CANopen network."""

    node: Node = key("Node id, as set at the device.", ge=1, le=127)
    eds: Text = key("EDS file, relative to the folder of the site file.")
    objects: Annotated[tuple[ObjectValue, ...], MaxLen(64)] = key(
        "Objects to set and verify at start, above all the reaction to our lost heartbeat "
        "(0x6007 at CiA 402 drives).",
        default=(),
    )


class Canopen402(Section):
    """How PLC and drives are reached on CANopen; the EDS files say what every PDO carries."""

    interface: CanInterface = key(INTERFACE, default="socketcan")
    channel: Text = key("CAN interface of the gateway (can0), or the tty of an slcan adapter.")
    bitrate: Annotated[int, Whole("bit/s")] = key(
        "Bit rate of the bus. Use 1 Mbit/s or 500 kbit/s.",
        default=500_000,
        ge=10_000,
        le=1_000_000,
    )
    own_node: Node = key("Our node id; no device may have it.", default=100, ge=1, le=127)
    heartbeat_ms: Annotated[int, Whole("ms")] = key(
        "Period of our heartbeat.", default=20, ge=5, le=1000
    )
    lost_after_ms: Annotated[int, Whole("ms")] = key(
        "The nodes take us for dead after this time without our heartbeat, or without our PDO; "
        "at least three periods.",
        default=80,
        ge=15,
        le=290,
    )
    node_heartbeat_ms: Annotated[int, Whole("ms")] = key(
        "Period asked of the nodes' heartbeats; three missing ones are a lost node.",
        default=50,
        ge=10,
        le=1000,
    )
    nodes: Annotated[Mapping[Name, CanopenNode], *Few] = key("The devices, by name.")
    deadline_ms: Milliseconds = key(CAN_DEADLINE, default=3.0, ge=0.5, le=50)


class ReadWord(Section):
    """A status word that the PLC writes and AFF reads."""

    register_number: Register | None = key(
        "Number of the register, counted as address_base says; on Modbus.",
        default=None,
        alias="register",
        ge=0,
        le=465536,
    )
    signal: Text | None = key(SIGNAL, default=None)
    type: Literal["u16"] = key("Word type; these words are always u16.", default="u16")


class Channel(Section):
    """A measured value; the name of the key ends with its SI unit."""

    register_number: Register | None = key(
        "Number of its (first) register, counted as address_base says; on Modbus.",
        default=None,
        alias="register",
        ge=0,
        le=465536,
    )
    signal: Text | None = key(SIGNAL, default=None)
    type: WordType | None = key(
        "How the device stores it: u16 or i16 in one word, u32 or i32 in two; on Modbus. Wrong "
        "sign or jumps at 32768 mean u16 and i16 are mixed up.",
        default=None,
    )
    scale: SiPerCount = key(
        "SI units in one count (on CAN: in one physical unit of the signal), from the manual; "
        "may be text with a unit (`0.1 mm`). "
        "Change it when the value differs from the drive's display by a fixed factor. "
        "Negative when the device counts against the web direction.",
        ge=-1e6,
        le=1e6,
    )
    wraps: Flag = key(
        "true when the count starts over after its largest value (encoder angles).", default=False
    )


class ReadBlock(Section):
    """What AFF reads each tick, in one block of at most 125 words."""

    plc_heartbeat: ReadWord = key("Counter that the PLC moves each scan; proof of life.")
    status: ReadWord = key("Status bits of the PLC: permissives, enable request, splice.")
    roll_id: ReadWord = key("Counter of splices; a new number resets what resets_on: splice.")
    channels: Annotated[Mapping[Name, Channel], *Few] = key(
        "Measured values by name. The end of the name is the SI unit: _N, _m_s, _m, _rad, "
        "_rad_s, _N_m."
    )


class WriteWord(Section):
    """A u16 word that AFF alone writes."""

    register_number: Register | None = key(
        "Number of the register, counted as address_base says; on Modbus.",
        default=None,
        alias="register",
        ge=0,
        le=465536,
    )
    signal: Text | None = key(SIGNAL, default=None)


class Correction(Section):
    """The correction of one actuator, with its ones complement as proof of integrity."""

    register_number: Register | None = key(
        "Register of the correction; on Modbus.", default=None, alias="register", ge=0, le=465536
    )
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
    config_revision: WriteWord = key("Low 16 bits of the site file's hash.")
    corrections: Annotated[Mapping[Name, Correction], *Few] = key(
        "One correction per actuator, by the actuator's name."
    )


class Gateway(Section):
    """The connection to the PLC and the register map."""

    modbus_tcp: ModbusTcp | None = key("PLC on Modbus TCP. Give exactly one.", default=None)
    modbus_rtu: ModbusRtu | None = key("Device on Modbus RTU, a serial line.", default=None)
    can_dbc: CanDbc | None = key("PLC on CAN, described by a DBC file.", default=None)
    canopen_402: Canopen402 | None = key("PLC and drives on CANopen (CiA 402).", default=None)
    address_base: Annotated[Literal[0, 1], Whole("number of the first register")] | None = key(
        "On Modbus. 0: register numbers are wire addresses. 1: the first register is number 1, "
        "40001 or 400001, as manuals write it. Values shifted by one register mean the other "
        "one is right.",
        default=None,
    )
    word_order: Literal["high_first", "low_first"] | None = key(
        "Which word of a 32-bit value comes first, on Modbus. Absurd 32-bit values mean the "
        "other one.",
        default=None,
    )
    read: ReadBlock = key("What AFF reads each tick.")
    write: WriteBlock = key("What AFF writes each tick; nothing else is ever written.")

    @property
    def wire(self) -> str:
        """Return the key of the one way in use."""
        return next((name for name in WIRES if getattr(self, name) is not None), "")

    @property
    def modbus(self) -> ModbusTcp | ModbusRtu | None:
        """Return the Modbus section in use, if any."""
        return self.modbus_tcp or self.modbus_rtu

    @property
    def can(self) -> CanDbc | Canopen402 | None:
        """Return the CAN section in use, if any."""
        return self.can_dbc or self.canopen_402

    @property
    def deadline_ms(self) -> float:
        """Return the longest wait for the PLC in one tick, ms."""
        way: ModbusTcp | ModbusRtu | CanDbc | Canopen402 | None = getattr(self, self.wire, None)
        return way.deadline_ms if way is not None else 0.0

    def wire_address(self, register: int) -> int:
        """Return the address on the wire of a register number of this file.

        With ``address_base: 1``, 40001..49999 and 400001..465536 are manual notation of
        holding registers; any other number counts from 1.
        """
        if not self.address_base:
            return register
        for first, last in ((40001, 49999), (400001, 465536)):
            if first <= register <= last:
                return register - first
        return register - 1
