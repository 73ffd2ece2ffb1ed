"""A plant service in a thread of its own, and a bare socket client, for tests on the wire."""

from __future__ import annotations

import asyncio
import contextlib
import socket
import threading
import time
from collections.abc import Iterator
from typing import Any

from sim_plant.base.ports import SteppedLine
from sim_plant.servers.answers import to_json
from sim_plant.servers.control import ControlSocket
from sim_plant.servers.plc_map import PlcMap
from sim_plant.servers.serve import PlantService, ServeOptions
from tests.sim_plant.servers.fake_line import FakeLine, default_map

SAMPLE_TIME_s = 0.01
PATIENCE_s = 10.0


class Served:
    """A running service; commands go the way of the control socket, in the service's thread."""

    def __init__(self, service: PlantService, loop: asyncio.AbstractEventLoop) -> None:
        self.service = service
        self.loop = loop
        self.port = getattr(service.server, "port", 0)  # a CAN bus has none
        self._control = ControlSocket(None, service.plant, service.status)

    def command(self, line: str) -> dict[str, Any]:
        async def answer() -> dict[str, Any]:
            return to_json(await self._control.answer(line))

        return asyncio.run_coroutine_threadsafe(answer(), self.loop).result(PATIENCE_s)

    def fault(self, spec: str) -> None:
        """Inject a fault and return when it acts."""
        assert self.command(f"fault {spec}")["ok"]
        wait_until(lambda: self.command("status")["faults"])

    def client(self) -> socket.socket:
        return socket.create_connection(("127.0.0.1", self.port), timeout=PATIENCE_s)


def answered(control: ControlSocket, line: str) -> dict[str, Any]:
    """Return what a command without a socket is answered."""
    return to_json(asyncio.run(control.answer(line)))


@contextlib.contextmanager
def served(
    line: SteppedLine | None = None,
    said: list[str] | None = None,
    plc: PlcMap | None = None,
    **options: Any,
) -> Iterator[Served]:
    """Serve a line (a fake one) by a map, and let ``said`` have what the log gets."""
    heard: list[str] = [] if said is None else said
    ready = threading.Event()
    box: dict[str, Any] = {}

    async def main() -> None:
        chosen = ServeOptions(port=0, realtime=False, **options)
        box["service"] = PlantService(
            line or FakeLine(SAMPLE_TIME_s), plc or default_map(), chosen
        )
        box["loop"] = asyncio.get_running_loop()
        await box["service"].run(lambda text: (heard.append(text), ready.set()))

    thread = threading.Thread(target=asyncio.run, args=(main(),))
    thread.start()
    assert ready.wait(PATIENCE_s)
    try:
        yield Served(box["service"], box["loop"])
    finally:
        box["loop"].call_soon_threadsafe(box["service"].stop)
        thread.join(PATIENCE_s)
    assert not thread.is_alive()


def wait_until(condition, what: str = "condition") -> None:
    give_up = time.monotonic() + PATIENCE_s
    while not condition():
        assert time.monotonic() < give_up, f"{what} never came true"
        time.sleep(0.005)


def receive(client: socket.socket, count: int) -> bytes:
    data = b""
    while len(data) < count and (part := client.recv(count - len(data))):
        data += part
    return data


def ask(client: socket.socket, request: str, count: int) -> bytes:
    client.sendall(bytes.fromhex(request))
    return receive(client, count)


def closed(client: socket.socket) -> bool:
    """Whether the server ends this connection."""
    with contextlib.suppress(ConnectionError):
        return client.recv(1) == b""
    return True


def silent(client: socket.socket, for_s: float = 0.1) -> bool:
    """Whether nothing comes for a while."""
    client.settimeout(for_s)
    try:
        client.recv(1)
    except TimeoutError:
        return True
    finally:
        client.settimeout(PATIENCE_s)
    return False
