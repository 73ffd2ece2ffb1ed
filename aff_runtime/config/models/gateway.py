"""Section ``gateway``: how the PLC is reached, one class per wire, and its words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from annotated_types import MaxLen

from aff_runtime.config.models.words import Applied, ReadBlock, WriteBlock
from aff_runtime.config.quantity import Few, Milliseconds, Name, Section, Text, Whole, key

WIRES = ("modbus_tcp", "modbus_rtu", "modbus_udp", "modbus_rtu_tcp", "can_dbc", "canopen_402")
CanInterface = Literal["socketcan", "slcan_tty", "frame_socket", "udp_multicast"]
Node = Annotated[int, Whole("node id")]
INTERFACE = (
    "socketcan on the gateway; slcan_tty for a serial adapter without a kernel driver; "
    "frame_socket (a unix socket) and udp_multicast for benches."
)
FUNCTION = "Function codes: fc23 reads and writes in one request; fc3_fc16 uses two."
CAN_DEADLINE = (
    "Most time that reading the bus may take of one tick. A tick takes what has arrived and never "
    "waits; what is left is for the next one. Lower it when a babbling device makes ticks late; "
    "it must stay below cycle_ms."
)


class Tls(Section):
    """Modbus/TCP Security; the files lie below the folder of the site file."""

    ca: Text = key("Certificate (PEM) that the PLC's certificate is checked against.")
    certificate: Text | None = key(
        "Our own certificate (PEM), for a PLC that asks for one.", default=None
    )
    private_key: Text | None = key(
        "Its key (PEM); readable by the service's user alone.", default=None
    )
    crl: Text | None = key(
        "List (PEM) of the certificates that the same authority has taken back; a PLC that shows "
        "one of them is not spoken to. It is read when the service starts, and no connection is "
        "made once the list is out of date: give it only where somebody renews it.",
        default=None,
    )
    server_name: Text | None = key(
        "Name in the PLC's certificate, as a DNS name or address of its subjectAltName; a name "
        "that stands in the CN alone does not count. Absent: host.",
        default=None,
    )

    def files(self) -> dict[str, str]:
        """Return the names of the files that are given, by key."""
        names = {
            "ca": self.ca,
            "certificate": self.certificate,
            "private_key": self.private_key,
            "crl": self.crl,
        }
        return {key: name for key, name in names.items() if name is not None}


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
    function: Literal["fc23", "fc3_fc16"] = key(FUNCTION, default="fc23")


class ModbusUdp(Section):
    """How a PLC or gateway is reached by Modbus over UDP, without a connection and without TLS."""

    host: Text = key("Address of the PLC or gateway, on the same switched network.")
    port: Annotated[int, Whole("UDP port")] = key(
        "UDP port of its Modbus server.", default=502, ge=1, le=65535
    )
    device_id: Annotated[int, Whole("unit identifier")] = key(
        "Modbus unit identifier.", default=1, ge=0, le=255
    )
    deadline_ms: Milliseconds = key(
        "Longest wait for the reply of one tick; a later one counts as lost, and a lost one costs "
        "its tick alone. It must stay below cycle_ms.",
        default=3.0,
        ge=0.5,
        le=50,
    )
    function: Literal["fc23", "fc3_fc16"] = key(FUNCTION, default="fc23")


class ModbusRtuTcp(Section):
    """How a device on a serial line is reached through a device server that passes bytes on."""

    host: Text = key("Address of the device server, in its raw (transparent) TCP mode.")
    port: Annotated[int, Whole("TCP port")] = key(
        "TCP port of the serial line at the device server; makers begin at 4001 or 10001.",
        default=4001,
        ge=1,
        le=65535,
    )
    device_id: Annotated[int, Whole("unit identifier")] = key(
        "Number of the device on the line.", default=1, ge=1, le=247
    )
    deadline_ms: Milliseconds = key(
        "Longest wait for the reply of one tick: the line's own time and the server's. It must "
        "stay below cycle_ms.",
        default=8.0,
        ge=0.5,
        le=90,
    )
    function: Literal["fc23", "fc3_fc16"] = key(FUNCTION, default="fc23")


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
    dbc: Text = key("DBC file of 1 MB at most, below the folder of the site file.")
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
    eds: Text = key("EDS file of 1 MB at most, below the folder of the site file.")
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
        "at least three heartbeats, which leave with the ticks: of heartbeat_ms, rounded up to "
        "whole cycles.",
        default=80,
        ge=15,
        le=290,
    )
    node_heartbeat_ms: Annotated[int, Whole("ms")] = key(
        "Period asked of the nodes' heartbeats; three missing ones are a lost node. A shorter one "
        "than cycle_ms is read in bunches.",
        default=50,
        ge=10,
        le=1000,
    )
    nodes: Annotated[Mapping[Name, CanopenNode], *Few] = key("The devices, by name.")
    deadline_ms: Milliseconds = key(CAN_DEADLINE, default=3.0, ge=0.5, le=50)


ModbusWay = ModbusTcp | ModbusRtu | ModbusUdp | ModbusRtuTcp


class Gateway(Section):
    """The connection to the PLC and the register map."""

    modbus_tcp: ModbusTcp | None = key("PLC on Modbus TCP. Give exactly one.", default=None)
    modbus_rtu: ModbusRtu | None = key("Device on Modbus RTU, a serial line.", default=None)
    modbus_udp: ModbusUdp | None = key("PLC on Modbus over UDP datagrams.", default=None)
    modbus_rtu_tcp: ModbusRtuTcp | None = key(
        "Device on Modbus RTU behind a serial device server.", default=None
    )
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
    def applied(self) -> Mapping[str, Applied]:
        """Return what is read of the applied corrections, by actuator."""
        return self.read.applied or {}

    @property
    def wire(self) -> str:
        """Return the key of the one way in use."""
        return next((name for name in WIRES if getattr(self, name) is not None), "")

    @property
    def way(self) -> ModbusWay | CanDbc | Canopen402 | None:
        """Return the section of the way in use."""
        return self.modbus or self.can

    @property
    def modbus(self) -> ModbusWay | None:
        """Return the Modbus section in use, if any."""
        return self.modbus_tcp or self.modbus_rtu or self.modbus_udp or self.modbus_rtu_tcp

    @property
    def can(self) -> CanDbc | Canopen402 | None:
        """Return the CAN section in use, if any."""
        return self.can_dbc or self.canopen_402

    @property
    def deadline_ms(self) -> float:
        """Return the longest wait for the PLC in one tick, ms."""
        return self.way.deadline_ms if self.way is not None else 0.0

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
