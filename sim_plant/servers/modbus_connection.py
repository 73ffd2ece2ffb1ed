"""One Modbus TCP connection: cuts the stream into frames, answers each, lies when told to."""

from __future__ import annotations

import asyncio
import socket
from typing import Protocol

from pymodbus.framer import FramerSocket
from pymodbus.pdu import DecodePDU

from sim_plant.servers.faults import Fault, FaultBoard
from sim_plant.servers.modbus_device import ModbusDevice

_HEADER = 7
_LONGEST_BODY = 254  # unit id and PDU
_FRAMER = FramerSocket(DecodePDU(is_server=True))


class ConnectionKeeper(Protocol):
    """Knows the open connections and decides whether one more may live."""

    def admit(self, connection: ModbusConnection) -> bool:
        """Return whether the connection may live."""
        ...

    def forget(self, connection: ModbusConnection) -> None:
        """Note that the connection is gone."""
        ...


class ModbusConnection(asyncio.Protocol):
    """Serves one client.

    Frames are cut here and not by the library's server, which answers only one per segment.
    A stream that is no Modbus (protocol id, impossible length), a client that does not read its
    answers, and one that is silent for ``idle_timeout_s`` are cut off.
    """

    def __init__(
        self,
        keeper: ConnectionKeeper,
        device: ModbusDevice,
        faults: FaultBoard,
        idle_timeout_s: float,
    ) -> None:
        self._keeper = keeper
        self._device = device
        self._faults = faults
        self._idle_timeout_s = idle_timeout_s
        self._buffer = bytearray()
        self._transport: asyncio.Transport | None = None
        self._idle: asyncio.TimerHandle | None = None
        self._heard = False

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Take the connection, or abort it when there are too many."""
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        if not self._keeper.admit(self):
            transport.abort()
            return
        connected = transport.get_extra_info("socket")
        connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._watch_idle()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the connection."""
        if self._idle is not None:
            self._idle.cancel()
        self._keeper.forget(self)

    def pause_writing(self) -> None:
        """Cut off a client that does not read its answers."""
        self.abort()

    def abort(self) -> None:
        """Close at once, dropping what was not sent."""
        if self._transport is not None:
            self._transport.abort()

    def data_received(self, data: bytes) -> None:
        """Answer every complete frame."""
        self._heard = True
        self._buffer += data
        while len(self._buffer) >= _HEADER:
            protocol_id = int.from_bytes(self._buffer[2:4], "big")
            length = int.from_bytes(self._buffer[4:6], "big")
            if protocol_id != 0 or not 2 <= length <= _LONGEST_BODY:
                self.abort()
                return
            if len(self._buffer) < length + 6:
                return
            frame = bytes(self._buffer[: length + 6])
            del self._buffer[: length + 6]
            self._serve(int.from_bytes(frame[:2], "big"), frame[6], frame[_HEADER:])

    def _serve(self, transaction_id: int, unit_id: int, request: bytes) -> None:
        if self._faults.active(Fault.MUTE):
            return
        if self._faults.active(Fault.DROP):
            self.abort()
            return
        answer = self._device.answer(request, busy=self._faults.active(Fault.BUSY))
        if self._faults.active(Fault.SHORT):
            answer = _without_last_word(answer)
        if self._faults.active(Fault.TID):
            transaction_id = (transaction_id + 1) & 0xFFFF
        frame = _FRAMER.encode(answer, unit_id, transaction_id)
        if self._faults.active(Fault.DOUBLE):
            frame += frame
        if self._faults.active(Fault.PARTIAL):
            frame = frame[: len(frame) // 2]
        if self._faults.active(Fault.DELAY):
            delay_s = float(self._faults.argument(Fault.DELAY)) * 1e-3
            asyncio.get_running_loop().call_later(delay_s, self._send, frame)
        else:
            self._send(frame)

    def _send(self, frame: bytes) -> None:
        if self._transport is not None and not self._transport.is_closing():
            self._transport.write(frame)

    def _watch_idle(self) -> None:
        self._heard = False
        loop = asyncio.get_running_loop()
        self._idle = loop.call_later(self._idle_timeout_s, self._judge_idle)

    def _judge_idle(self) -> None:
        if self._heard:
            self._watch_idle()
        else:
            self.abort()


def _without_last_word(answer: bytes) -> bytes:
    """Return the answer two bytes shorter, with a byte count that agrees where there is one."""
    if answer[0] in {3, 23}:
        return bytes([answer[0], answer[1] - 2]) + answer[2:-2]
    return answer[:-2]
