"""Modbus RTU frames over a TCP connection: a serial device server that passes bytes through."""

from __future__ import annotations

from typing import Final

from aff_runtime.fieldbus.modbus.byte_stream import CLOSED, Connecting
from aff_runtime.fieldbus.modbus.rtu_frames import MOST_BYTES, RtuFraming
from aff_runtime.fieldbus.modbus.tcp_wire import TcpWire

_MOST_READS: Final = 16
"""Of a server that says more than this unasked no reply can be told."""


class RtuTcpWire:
    """``ByteStream`` over a TCP connection that carries serial frames (device id, PDU, CRC).

    The bytes of a reply come in any pieces. A server may still send what a lost request had asked
    for: what is there when a request leaves is thrown away, and what comes later is told by its
    function (``RtuFraming``).

    Parameters
    ----------
    host, port : the device server; a name is resolved here, once.

    Raises
    ------
    WireError
        When the name cannot be resolved.
    """

    lossy = False

    def __init__(self, host: str, port: int) -> None:
        self._tcp = TcpWire(host, port)
        self._framing = RtuFraming()
        self._view = memoryview(bytearray(MOST_BYTES))

    @property
    def why_closed(self) -> str:
        """The system's own words."""
        return self._tcp.why_closed

    def start_connect(self) -> bool:
        """Begin a connection attempt; False when it failed at once."""
        self._framing.clear()
        return self._tcp.start_connect()

    def connecting(self) -> Connecting:
        """Return the state of the attempt, without waiting."""
        return self._tcp.connecting()

    def send(self, frame: bytes) -> bool:
        """Hand over one request; what was left from before is dropped."""
        for _ in range(_MOST_READS):
            left = self._tcp.receive(self._view, 0)
            if left == 0:
                return self._tcp.send(self._framing.request(frame))
            if left == CLOSED:
                break
        return False

    def receive(self, into: memoryview, wait_ns: int) -> int:
        """Wait at most ``wait_ns`` for bytes; return a whole reply as MBAP, 0 for none yet."""
        count = self._tcp.receive(self._view, wait_ns)
        if count == 0 and wait_ns <= 0:
            return self._framing.nothing_more()
        if count <= 0:
            return count
        return self._framing.deliver(bytes(self._view[:count]), into)

    def close(self, *, abort: bool) -> None:
        """Close; ``abort`` drops unsent and unacknowledged bytes instead of delivering them."""
        self._framing.clear()
        self._tcp.close(abort=abort)
