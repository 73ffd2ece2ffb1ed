"""One Modbus TCP connection: cuts the stream into frames, answers each, lies when told to."""

from __future__ import annotations

import asyncio
import socket
from typing import Protocol

from sim_plant.servers.faults import Fault, FaultBoard
from sim_plant.servers.later import Appointment, Later, in_real_time
from sim_plant.servers.modbus_answer import HEADER, answer_to, request_length
from sim_plant.servers.modbus_device import ModbusDevice


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
        later: Later = in_real_time,
    ) -> None:
        self._keeper = keeper
        self._device = device
        self._faults = faults
        self._idle_timeout_s = idle_timeout_s
        self._later = later
        self._buffer = bytearray()
        self._transport: asyncio.Transport | None = None
        self._idle: Appointment | None = None
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
        while len(self._buffer) >= HEADER:
            length = request_length(self._buffer)
            if length == 0:
                self.abort()
                return
            if len(self._buffer) < length:
                return
            frame = bytes(self._buffer[:length])
            del self._buffer[:length]
            self._serve(frame)

    def _serve(self, frame: bytes) -> None:
        if self._faults.active(Fault.DROP) and not self._faults.active(Fault.MUTE):
            self.abort()
            return
        answer = answer_to(frame, self._device, self._faults)
        if answer.delay_s:
            self._later(answer.delay_s, lambda: self._send(b"".join(answer.frames)))
        else:
            self._send(b"".join(answer.frames))

    def _send(self, frame: bytes) -> None:
        if self._transport is not None and not self._transport.is_closing():
            self._transport.write(frame)

    def _watch_idle(self) -> None:
        self._heard = False
        self._idle = self._later(self._idle_timeout_s, self._judge_idle)

    def _judge_idle(self) -> None:
        if self._heard:
            self._watch_idle()
        else:
            self.abort()
