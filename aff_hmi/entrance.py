"""Where connections come in: who has a place is heard, within seconds; others go before TLS.

asyncio's own server makes what TLS needs (a third of a megabyte) for everybody who connects, waits
a minute for a first word, and tells its protocol who it is only after that.
"""

from __future__ import annotations

import asyncio
import socket
import ssl
from collections.abc import Callable, Collection

from aff_hmi.admission import admits
from aff_runtime.base.errors import WireError

MAX_CONNECTIONS = 64
MAX_TOLD = 16  # beyond those: of so many at a time it is said that every place is taken
HANDSHAKE_S = 5.0
GOODBYE_S = 1.0  # for the last word of TLS, which who has gone does not say
RETRY_S = 1.0
BACKLOG = 128


class Entrance:
    """Lets connections of listening sockets in, by address, while there are places.

    A connection has its place from the moment it comes: TLS that is not agreed on yet counts.

    Parameters
    ----------
    sockets : bound, and closed with this.
    inside : protocols of who is in; each has its ``client``, address and port.
    protocol : makes that of a connection; told whether it has a place.
    tls_at : what is spoken with who has come to an address of this machine; None is plain.
    """

    def __init__(
        self,
        sockets: Collection[socket.socket],
        inside: Collection[object],
        protocol: Callable[[bool], asyncio.Protocol],
        tls_at: Callable[[str], ssl.SSLContext | None],
    ) -> None:
        self._sockets = sockets
        self._inside = inside
        self._protocol = protocol
        self._tls_at = tls_at
        self._coming: dict[asyncio.Protocol, str] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        self._loop = asyncio.get_running_loop()
        for one in sockets:
            one.listen(BACKLOG)
            self._hear(one)

    def close(self) -> None:
        """Let nobody in any more; whose TLS is not agreed on goes."""
        for one in self._sockets:
            self._loop.remove_reader(one)
            one.close()
        for task in self._tasks:
            task.cancel()

    async def wait_closed(self) -> None:
        """Wait for those who were sent away."""
        await asyncio.gather(*self._tasks, return_exceptions=True)

    def _hear(self, listener: socket.socket) -> None:
        if listener.fileno() >= 0:
            self._loop.add_reader(listener, self._accept, listener)

    def _accept(self, listener: socket.socket) -> None:
        """Let one in, or send it away; the next one comes in the loop's next round."""
        try:
            connection, (address, *_) = listener.accept()
        except (BlockingIOError, InterruptedError, ConnectionAbortedError):
            return
        except OSError:  # no descriptor is left: until one is, the kernel would ask without end
            self._loop.remove_reader(listener)
            self._loop.call_later(RETRY_S, self._hear, listener)
            return
        connection.setblocking(False)
        there = [self._coming[one] for one in self._coming if one not in self._inside]
        there += [address_of(one) for one in self._inside]
        has_place = admits(address, there, MAX_CONNECTIONS)
        if not (has_place or MAX_CONNECTIONS <= len(there) < MAX_CONNECTIONS + MAX_TOLD):
            connection.close()
            return
        protocol = self._protocol(has_place)
        self._coming[protocol] = address
        task = self._loop.create_task(self._let_in(connection, protocol))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _let_in(self, connection: socket.socket, protocol: asyncio.Protocol) -> None:
        tls = self._tls_at(connection.getsockname()[0])
        try:
            await self._loop.connect_accepted_socket(
                lambda: protocol,
                connection,
                ssl=tls,
                ssl_handshake_timeout=HANDSHAKE_S if tls is not None else None,
                ssl_shutdown_timeout=GOODBYE_S if tls is not None else None,
            )
        except OSError:  # no TLS, or too late: asyncio has closed the connection
            return
        finally:
            del self._coming[protocol]


def bound(address: str, port: int) -> socket.socket:
    """Return a socket that has an address.

    Raises
    ------
    WireError
        When it cannot be had.
    """
    family = socket.AF_INET6 if ":" in address else socket.AF_INET
    found = socket.socket(family)
    try:
        found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if family is socket.AF_INET6:
            found.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
        found.bind((address, port))
    except OSError as error:
        found.close()
        raise WireError(
            f"--listen: {address}:{port}: {error.strerror}; name another one"
        ) from None
    found.setblocking(False)
    return found


def address_of(protocol: object) -> str:
    """Return the address of who speaks through a protocol, empty where it has none."""
    client: tuple[str, int] | None = getattr(protocol, "client", None)
    return client[0] if client else ""
