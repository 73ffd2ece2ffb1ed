"""How a Modbus connection is made from its parts."""

from __future__ import annotations

import ssl

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.ports import Clock
from aff_runtime.fieldbus.modbus.frames import ModbusFrames, WireFunction
from aff_runtime.fieldbus.modbus.registers import RegisterMap
from aff_runtime.fieldbus.modbus.tcp import ModbusTcpTransport
from aff_runtime.fieldbus.modbus.tcp_wire import TcpWire, Wire
from aff_runtime.fieldbus.modbus.tls_wire import TlsWire


def modbus_tcp(
    *,
    host: str,
    port: int,
    device_id: int,
    register_map: RegisterMap,
    clock: Clock,
    function: WireFunction = WireFunction.FC23,
    tls: ssl.SSLContext | None = None,
    server_name: str = "",
) -> ModbusTcpTransport:
    """Return a Modbus TCP client, in TLS when ``tls`` is given.

    The name is resolved here, the connection is made by ticks.

    Raises
    ------
    WireError
        When the host name cannot be resolved.
    ConfigError
        When a number does not fit the protocol.
    """
    wire = tcp_wire(host, port, tls, server_name)
    frames = _frames(device_id, register_map)
    return ModbusTcpTransport(frames=frames, wire=wire, clock=clock, function=function)


def tcp_wire(
    host: str, port: int, tls: ssl.SSLContext | None = None, server_name: str = ""
) -> Wire:
    """Return a TCP connection, in TLS when ``tls`` is given; not connected yet.

    Raises
    ------
    WireError
        When the host name cannot be resolved.
    """
    if tls is None:
        return TcpWire(host, port)
    return TlsWire(host, port, tls, server_name or host)


def modbus_rtu(
    *,
    device: str,
    baud: int,
    parity: str,
    stop_bits: int,
    device_id: int,
    register_map: RegisterMap,
    clock: Clock,
    function: WireFunction = WireFunction.FC23,
) -> ModbusTcpTransport:
    """Return a Modbus RTU master on a serial line; the line is opened by ticks.

    Raises
    ------
    ConfigError
        When a number does not fit the protocol, or pyserial is not installed.
    """
    wire = rtu_wire(device, baud=baud, parity=parity, stop_bits=stop_bits)
    frames = _frames(device_id, register_map)
    return ModbusTcpTransport(frames=frames, wire=wire, clock=clock, function=function)


def rtu_wire(device: str, *, baud: int, parity: str, stop_bits: int) -> Wire:
    """Return a serial line, not opened yet.

    Raises
    ------
    ConfigError
        When pyserial is not installed.
    """
    try:
        from aff_runtime.fieldbus.modbus.rtu_wire import RtuWire  # noqa: PLC0415 (needs the can extra)
    except ImportError as error:
        raise ConfigError(
            f"RTU needs pyserial: pip install 'aff-runtime[can]' ({error})"
        ) from None
    return RtuWire(device, baud=baud, parity=parity, stop_bits=stop_bits)


def _frames(device_id: int, register_map: RegisterMap) -> ModbusFrames:
    return ModbusFrames(
        device_id=device_id,
        read_start=register_map.read_start,
        read_count=register_map.read_count,
        write_start=register_map.write_start,
        write_count=register_map.write_count,
    )
