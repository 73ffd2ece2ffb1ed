"""The Modbus UDP server of the simulated PLC: one frame in one datagram, either way."""

from __future__ import annotations

import asyncio
import random
from functools import partial
from typing import Any

from aff_runtime.base.errors import WireError
from sim_plant.servers.faults import Fault, FaultBoard, FaultEdge
from sim_plant.servers.later import Later, in_real_time
from sim_plant.servers.modbus_answer import HEADER, answer_to, request_length
from sim_plant.servers.modbus_device import ModbusDevice
from sim_plant.servers.wire_faults import Medium, WireFaults

EXCEPTION = 0x80
"""Function codes from here on are of answers: two servers would answer each other for ever."""
_DEAF = frozenset({Fault.REFUSE, Fault.RESTART, Fault.DROP})


class ModbusUdpServer(asyncio.DatagramProtocol):
    """Answers datagrams on one address; it keeps nothing of a client.

    A datagram that is no whole request gets no answer. While the PLC refuses or restarts it hears
    nothing; ``lose`` drops datagrams at random, both ways.

    Attributes
    ----------
    host, port : where it listens; a port of 0 is replaced by the one the system gave.
    wire_faults : which faults it has.
    trouble : always empty: the socket stays open.
    refused, lost : datagrams that were no request, and that the fault ``lose`` took.
    """

    def __init__(
        self,
        device: ModbusDevice,
        faults: FaultBoard,
        *,
        host: str,
        port: int,
        seed: int = 0,
        later: Later = in_real_time,
    ) -> None:
        self.trouble = ""
        self.wire_faults = WireFaults(medium=Medium.UDP)
        self.host = host
        self.port = port
        self.refused = 0
        self.lost = 0
        self._device = device
        self._faults = faults
        self._dice = random.Random(seed)
        self._later = later
        self._transport: asyncio.DatagramTransport | None = None

    @property
    def address(self) -> str:
        """Return what the ready line says."""
        return f"modbus udp {self.host}:{self.port}"

    def counts(self) -> dict[str, int]:
        """Return what the status shows of the wire."""
        return {
            "requests": self._device.requests,
            "exceptions": self._device.exceptions,
            "refused": self.refused,
            "lost": self.lost,
        }

    async def open(self) -> None:
        """Listen.

        Raises
        ------
        WireError
            The address cannot be had.
        """
        loop = asyncio.get_running_loop()
        try:
            self._transport, _ = await loop.create_datagram_endpoint(
                lambda: self, local_addr=(self.host, self.port)
            )
        except OSError as error:
            raise WireError(f"cannot listen on {self.host}:{self.port}/udp: {error}") from error
        self.port = self._transport.get_extra_info("sockname")[1]

    async def close(self) -> None:
        """End."""
        if self._transport is not None:
            self._transport.abort()
            self._transport = None
        await asyncio.sleep(0)

    async def settled(self) -> None:
        """Return at once: nothing is left to be done."""

    def take_edge(self, edge: FaultEdge) -> None:
        """Follow a fault that begins or ends: nothing is held that could end with it."""

    def datagram_received(self, data: bytes, addr: tuple[Any, ...]) -> None:
        """Answer one request."""
        is_answer = len(data) > HEADER and data[HEADER] >= EXCEPTION
        if len(data) <= HEADER or request_length(data) != len(data) or is_answer:
            self.refused += 1
            return
        if self._faults.any_of(_DEAF) or self._is_lost():
            return
        answer = answer_to(data, self._device, self._faults)
        for frame in answer.frames:
            if self._is_lost():
                continue
            if answer.delay_s:
                self._later(answer.delay_s, partial(self._send, frame, addr))
            else:
                self._send(frame, addr)

    def error_received(self, exc: Exception) -> None:
        """Go on: a client that has gone is no matter of the server's."""

    def _send(self, frame: bytes, addr: tuple[Any, ...]) -> None:
        if self._transport is not None:
            self._transport.sendto(frame, addr)

    def _is_lost(self) -> bool:
        if not self._faults.active(Fault.LOSE):
            return False
        lost = self._dice.random() * 100.0 < float(self._faults.argument(Fault.LOSE))
        self.lost += lost
        return lost
