"""The Modbus TCP server of the simulated PLC: listener, bounded connections, coming and going."""

from __future__ import annotations

import asyncio

from aff_runtime.base.errors import WireError
from sim_plant.servers.faults import Fault, FaultBoard, FaultEdge
from sim_plant.servers.later import Later, in_real_time
from sim_plant.servers.modbus_connection import ModbusConnection
from sim_plant.servers.modbus_device import ModbusDevice
from sim_plant.servers.wire_faults import Medium, WireFaults

_ABSENT = (Fault.REFUSE, Fault.RESTART)
_REOPEN_PERIOD_S = 0.05
_REOPEN_PATIENCE_S = 1.0
_STILL_PATIENCE_S = 2.0 * _REOPEN_PERIOD_S  # of who asks when it has been told


class ModbusServer:
    """Listens on one address and keeps at most ``max_connections`` clients.

    Attributes
    ----------
    host, port : where it listens; a port of 0 is replaced by the one the system gave.
    wire_faults : which faults it has.
    trouble : why it does not listen though no fault forbids it; else empty.
    accepted, turned_away : connections taken, and refused because there were too many.

    Parameters
    ----------
    idle_timeout_s : a client silent for this long (at most twice) is cut off.
    later : by whose clock late answers and silent clients are timed.
    """

    def __init__(
        self,
        device: ModbusDevice,
        faults: FaultBoard,
        *,
        host: str = "127.0.0.1",
        port: int = 5020,
        max_connections: int = 4,
        idle_timeout_s: float = 60.0,
        later: Later = in_real_time,
    ) -> None:
        self.trouble = ""
        self._told = False
        self.wire_faults = WireFaults(medium=Medium.TCP)
        self.host = host
        self.port = port
        self.accepted = 0
        self.turned_away = 0
        self._device = device
        self._faults = faults
        self._max_connections = max_connections
        self._idle_timeout_s = idle_timeout_s
        self._later = later
        self._connections: set[ModbusConnection] = set()
        self._listener: asyncio.Server | None = None
        self._reopening: asyncio.Task[None] | None = None

    @property
    def address(self) -> str:
        """Return what the ready line says."""
        return f"modbus {self.host}:{self.port}"

    def counts(self) -> dict[str, int]:
        """Return what the status shows of the wire."""
        return {
            "requests": self._device.requests,
            "exceptions": self._device.exceptions,
            "connections": self.connections,
            "accepted": self.accepted,
            "turned_away": self.turned_away,
        }

    @property
    def connections(self) -> int:
        """Return the number of open connections."""
        return len(self._connections)

    async def open(self) -> None:
        """Listen.

        Raises
        ------
        WireError
            The address cannot be had.
        """
        loop = asyncio.get_running_loop()
        try:
            self._listener = await loop.create_server(
                self._connection, self.host, self.port, reuse_address=True
            )
        except OSError as error:
            raise WireError(f"cannot listen on {self.host}:{self.port}: {error}") from error
        self.port = self._listener.sockets[0].getsockname()[1]

    async def close(self) -> None:
        """Stop listening and abort every connection."""
        if self._reopening is not None:
            self._reopening.cancel()
        self._leave()
        await asyncio.sleep(0)

    def take_edge(self, edge: FaultEdge) -> None:
        """Follow a fault that begins or ends."""
        fault = edge.spec.fault
        if edge.began and fault in _ABSENT:
            self._leave()
        elif edge.began and fault is Fault.DROP:
            self._abort_all()
        elif not edge.began and fault in _ABSENT and self._reopening is None:
            self._reopening = asyncio.get_running_loop().create_task(self._reopen())

    def admit(self, connection: ModbusConnection) -> bool:
        """Return whether one more connection may live."""
        if len(self._connections) >= self._max_connections:
            self.turned_away += 1
            return False
        self.accepted += 1
        self._connections.add(connection)
        return True

    def forget(self, connection: ModbusConnection) -> None:
        """Note that a connection is gone."""
        self._connections.discard(connection)

    def _connection(self) -> ModbusConnection:
        return ModbusConnection(
            self, self._device, self._faults, self._idle_timeout_s, self._later
        )

    async def settled(self) -> None:
        """Wait until a server that may listen again does, at most a second, then no longer."""
        if self._reopening is not None:
            patience_s = _STILL_PATIENCE_S if self._told else _REOPEN_PATIENCE_S
            await asyncio.wait({self._reopening}, timeout=patience_s)
            self._told = bool(self.trouble)

    async def _reopen(self) -> None:
        """Listen again once no fault forbids it; the port may be busy for a moment."""
        while self._listener is None and not self._absent():
            try:
                await self.open()
                self.trouble, self._told = "", False
            except WireError as error:
                self.trouble = str(error)
                await asyncio.sleep(_REOPEN_PERIOD_S)
        if self._absent():
            self._leave()
        self._reopening = None

    def _absent(self) -> bool:
        return any(self._faults.active(fault) for fault in _ABSENT)

    def _leave(self) -> None:
        self.trouble, self._told = "", False
        if self._listener is not None:
            self._listener.close()
            self._listener = None
        self._abort_all()

    def _abort_all(self) -> None:
        for connection in tuple(self._connections):
            connection.abort()
