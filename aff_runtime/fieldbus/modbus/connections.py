"""Every way to carry Modbus words: one row each; the row makes what carries the bytes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.ports import Clock
from aff_runtime.fieldbus.modbus.byte_stream import ByteStream
from aff_runtime.fieldbus.modbus.frames import ModbusFrames, WireFunction
from aff_runtime.fieldbus.modbus.registers import RegisterMap
from aff_runtime.fieldbus.modbus.rtu_tcp_wire import RtuTcpWire
from aff_runtime.fieldbus.modbus.tcp_wire import TcpWire
from aff_runtime.fieldbus.modbus.tls_wire import TlsWire, client_context
from aff_runtime.fieldbus.modbus.transport import ModbusTransport
from aff_runtime.fieldbus.modbus.udp_wire import UdpWire


@dataclass(frozen=True, slots=True, kw_only=True)
class Connection:
    """One row.

    Attributes
    ----------
    text : what it is, for a reader.
    wire : makes the byte stream from the section of the site file and the folder in which its
        names begin; it is not connected yet. AffError when that cannot be: a name that cannot be
        resolved, a file that cannot be used.
    """

    text: str
    wire: Callable[[Any, Path], ByteStream]


class TlsNames(Protocol):
    """Section ``tls``: names of PEM files, and the server's name."""

    @property
    def ca(self) -> str:
        """Of the authority."""
        ...

    @property
    def certificate(self) -> str | None:
        """Our own."""
        ...

    @property
    def private_key(self) -> str | None:
        """Of our certificate."""
        ...

    @property
    def crl(self) -> str | None:
        """List of withdrawn certificates."""
        ...

    @property
    def server_name(self) -> str | None:
        """Name in the server's certificate; None: its host."""
        ...


def modbus(
    wire: ByteStream,
    *,
    device_id: int,
    register_map: RegisterMap,
    clock: Clock,
    function: WireFunction = WireFunction.FC23,
    silence_before_reconnect_s: float = 0.05,
) -> ModbusTransport:
    """Return a Modbus client on a byte stream; the connection is made by ticks.

    Raises
    ------
    ConfigError
        When a number does not fit the protocol.
    """
    frames = ModbusFrames(
        device_id=device_id,
        read_start=register_map.read_start,
        read_count=register_map.read_count,
        write_start=register_map.write_start,
        write_count=register_map.write_count,
    )
    return ModbusTransport(
        frames=frames,
        wire=wire,
        clock=clock,
        function=function,
        silence_before_reconnect_s=silence_before_reconnect_s,
    )


def tcp_wire(
    host: str, port: int, tls: TlsNames | None = None, folder: Path = Path()
) -> ByteStream:
    """Return a TCP connection, in TLS when its files are named; not connected yet.

    Raises
    ------
    WireError
        When the host name cannot be resolved.
    ConfigError
        When a file of TLS cannot be used.
    """
    if tls is None:
        return TcpWire(host, port)
    context = client_context(
        folder / tls.ca,
        folder / tls.certificate if tls.certificate is not None else None,
        folder / tls.private_key if tls.private_key is not None else None,
        folder / tls.crl if tls.crl is not None else None,
    )
    return TlsWire(host, port, context, tls.server_name or host)


def rtu_wire(device: str, *, baud: int, parity: str, stop_bits: int) -> ByteStream:
    """Return a serial line, not opened yet; parity none, even or odd.

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
    return RtuWire(device, baud=baud, parity=parity[0].upper(), stop_bits=stop_bits)


CONNECTIONS: Mapping[str, Connection] = {
    "modbus_tcp": Connection(
        text="Modbus TCP client, FC23 or FC16 + FC3, in TLS when it is declared",
        wire=lambda tcp, folder: tcp_wire(tcp.host, tcp.port, tcp.tls, folder),
    ),
    "modbus_rtu": Connection(
        text="Modbus RTU master on a serial line",
        wire=lambda rtu, _folder: rtu_wire(
            rtu.device, baud=rtu.baud, parity=rtu.parity, stop_bits=rtu.stop_bits
        ),
    ),
    "modbus_udp": Connection(
        text="Modbus over UDP, one frame in one datagram",
        wire=lambda udp, _folder: UdpWire(udp.host, udp.port),
    ),
    "modbus_rtu_tcp": Connection(
        text="Modbus RTU frames over TCP, through a serial device server",
        wire=lambda server, _folder: RtuTcpWire(server.host, server.port),
    ),
}
