"""pymodbus' own servers, each in a thread of its own."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from typing import Any, Self

from pymodbus.simulator import DataType, SimData, SimDevice


class StrangeServer:
    """Holding registers 0..199 behind a server of pymodbus.

    Parameters
    ----------
    make : gives the server, TCP or UDP, of a device on a port of its own.
    values : of the registers at first.
    """

    def __init__(self, make: Callable[[SimDevice], Any], values: list[int]) -> None:
        self.port = 0
        self._make, self._values = make, values
        self._loop = asyncio.new_event_loop()
        self._ready = threading.Event()
        self._thread = threading.Thread(target=self._loop.run_until_complete, args=(self._run(),))

    async def act(self, *said: Any) -> None:
        """Take what a client asks: function, start, address, count, registers, what is written."""
        raise NotImplementedError

    def port_of(self, transport: Any) -> int:
        """Return where the server listens, over UDP or over TCP."""
        sockets = getattr(transport, "sockets", None)
        name = sockets[0].getsockname() if sockets else transport.get_extra_info("sockname")
        return int(name[1])

    async def _run(self) -> None:
        data = SimData(address=0, values=self._values, datatype=DataType.REGISTERS)
        server = self._make(SimDevice(id=1, simdata=[data], action=self.act))
        await server.serve_forever(background=True)
        self.port = self.port_of(server.transport)
        self._stop = asyncio.Event()
        self._ready.set()
        await self._stop.wait()
        await server.shutdown()

    def __enter__(self) -> Self:
        self._thread.start()
        assert self._ready.wait(10.0)
        return self

    def __exit__(self, *_error: object) -> None:
        self._loop.call_soon_threadsafe(self._stop.set)
        self._thread.join(10.0)
        self._loop.close()
