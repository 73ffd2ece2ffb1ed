"""uvicorn, told what it is not to do."""

from __future__ import annotations

import asyncio
import socket
import ssl
from collections.abc import Callable

import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from aff_hmi.commission.link import Commission
from aff_hmi.count_middleware import CountMiddleware
from aff_hmi.entrance import MAX_CONNECTIONS, Entrance, bound
from aff_hmi.gate import Gate, Rates
from aff_hmi.hand import Hand
from aff_hmi.hub import Hub
from aff_hmi.listening import Listening
from aff_hmi.machine import Machine
from aff_hmi.pages import Pages
from aff_hmi.see.kept import Kept
from aff_hmi.watch import Watch
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import ConfigError

HEADER_PATIENCE_S = 5.0
READY_LOOK_S = 0.02
END_LOOK_S = 0.5
MAX_HEADER_BYTES = 16_384
MAX_SOCKET_BYTES = 1024
MAX_UNHEARD = 4


class PatientOnce(H11Protocol):
    """HTTP/1.1 that waits for the head of a request for a while, and not for ever."""

    _late: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait."""
        super().connection_made(transport)
        self._wait()

    def data_received(self, data: bytes) -> None:
        """Take what came. What makes no request does not make us wait for longer.

        uvicorn lets its own timer go with the first byte after an answer.
        """
        super().data_received(data)
        is_asked = not getattr(self.cycle, "response_complete", True)  # no cycle: nothing yet
        if is_asked or self.transport.get_protocol() is not self:
            self._stop_waiting()
        elif self._late is None:
            self._wait()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget it."""
        self._stop_waiting()
        super().connection_lost(exc)

    def _wait(self) -> None:
        self._late = self.loop.call_later(HEADER_PATIENCE_S, self.transport.close)

    def _stop_waiting(self) -> None:
        if self._late is not None:
            self._late.cancel()
            self._late = None


class Receipts(WebSocketsSansIOProtocol):
    """A WebSocket that goes on reading while a receipt or two wait to be heard.

    They are short and few: uvicorn's own stops and starts reading for each, at two calls of the
    kernel. Who says more than those is not read on.
    """

    def send_receive_event_to_app(self) -> None:
        """Hand over a message."""
        was_paused, self.read_paused = self.read_paused, True  # or it would be paused for this one
        super().send_receive_event_to_app()
        self.read_paused = was_paused
        if not was_paused and self.queue.qsize() > MAX_UNHEARD:
            self.read_paused = True
            self.transport.pause_reading()


class Unhurried(uvicorn.Server):
    """A server that counts who comes before TLS is spoken, at all addresses together.

    It looks twice a second whether it is to end, where uvicorn does ten times.
    """

    def __init__(self, config: uvicorn.Config, listening: Listening) -> None:
        super().__init__(config)
        self._listening = listening

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Listen at every address.

        Raises
        ------
        WireError
            When one cannot be had.
        """
        await self.lifespan.startup()
        own = sockets or [bound(*one) for one in self._listening.bound_to]
        inside = self.server_state.connections
        self.servers = [Entrance(own, inside, self._protocol, self._tls_at)]  # type: ignore[list-item]
        self.started = True

    def _protocol(self, has_place: bool) -> PatientOnce:
        """Return what hears who has come.

        Who has a place is heard: uvicorn's own bound counts requests whose browsers are gone, too.
        """
        made = PatientOnce(self.config, self.server_state, self.lifespan.state)
        if has_place:
            made.limit_concurrency = None
        return made

    def _tls_at(self, address: str) -> ssl.SSLContext | None:
        return self.config.ssl if self._listening.is_tls_at(address) else None

    async def main_loop(self) -> None:
        """Run until a signal."""
        while not await self.on_tick(0):
            await asyncio.sleep(END_LOOK_S)


def config_of(listening: Listening, hub: Hub, language: str) -> uvicorn.Config:
    """Return uvicorn's settings.

    Raises
    ------
    ConfigError
        When certificate or key cannot be used.
    """
    clock, authority = MonotonicClock(), listening.client_ca
    pages = Pages(hub, language, clock)
    app = Gate(
        pages.app(),
        listening.hosts,
        Rates(clock),
        is_logged_in=pages.presses.is_logged_in if pages.presses is not None else None,
    )
    config = uvicorn.Config(
        CountMiddleware(app, hub.counts, clock),
        http=PatientOnce,
        ws=Receipts,
        loop="asyncio",
        lifespan="off",
        log_level="warning",
        access_log=False,
        server_header=False,
        proxy_headers=False,
        limit_concurrency=MAX_CONNECTIONS,
        timeout_keep_alive=5,
        timeout_graceful_shutdown=1,
        h11_max_incomplete_event_size=MAX_HEADER_BYTES,
        ws_max_size=MAX_SOCKET_BYTES,
        ws_per_message_deflate=False,
        ssl_certfile=listening.certificate,
        ssl_keyfile=listening.private_key,
        ssl_ca_certs=None if authority is None else str(authority),
        ssl_cert_reqs=ssl.CERT_NONE if authority is None else ssl.CERT_REQUIRED,
    )
    try:
        config.load()
    except (OSError, ssl.SSLError) as error:
        raise ConfigError(f"{listening.certificate}: cannot be used for TLS ({error})") from None
    if config.ssl is not None:
        config.ssl.minimum_version = ssl.TLSVersion.TLSv1_2
    return config


async def serve(
    watch: Watch,
    hand: Hand | None,
    kept: Kept,
    commission: Commission | None,
    listening: Listening,
    language: str,
    ready: Callable[[], None],
    alive: Callable[[], None],
) -> None:
    """Poll and serve until a signal.

    ``ready`` is called once browsers are heard, ``alive`` with every frame.
    """
    clock = MonotonicClock()
    files = tuple(one for one in (listening.certificate, listening.client_ca) if one is not None)
    machine = Machine(clock, kept.wall, files)
    if hand is not None:
        hand.desk.told = kept.person
    hub = Hub(watch, clock, hand, kept, commission, machine)
    server = Unhurried(config_of(listening, hub, language), listening)
    polling = asyncio.create_task(hub.run(alive))
    serving = asyncio.create_task(server.serve())
    while not (server.started or serving.done()):
        await asyncio.sleep(READY_LOOK_S)
    if server.started:
        ready()
    done, _ = await asyncio.wait({polling, serving}, return_when=asyncio.FIRST_COMPLETED)
    if polling in done:  # it never ends by itself: whatever ended it is the error
        server.should_exit = True
    polling.cancel()
    await serving
    await asyncio.gather(polling, return_exceptions=serving in done)
