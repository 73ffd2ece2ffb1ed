"""A CAN bus on a unix socket: every frame reaches every other party, as on a wire."""

from __future__ import annotations

import asyncio
import socket
import struct
from pathlib import Path

from aff_runtime.base.errors import RefusedError, WireError
from aff_runtime.base.socket_file import identity, listens, make_room, remove_own
from sim_plant.servers.can_frames import CanFrame, Take

FRAME = struct.Struct("=IB3x8s")
"""One frame as SocketCAN lays it out: identifier with flags, length, data."""
EXTENDED, REMOTE, ERROR = 0x8000_0000, 0x4000_0000, 0x2000_0000
"""Flags of the identifier."""
_BUS_OFF = 0x40
_BUS_ERROR = 0x80
_ANOTHER = "name another --channel"


class FrameHub:
    """Listens at a path; the plant is one party, every connection another."""

    tells_errors = True

    def __init__(self, path: Path) -> None:
        self._path = path
        self._listener: socket.socket | None = None
        self._made = (0, 0)
        self._parties: dict[int, socket.socket] = {}
        self._take: Take = lambda _: None

    def open(self, take: Take) -> None:
        """Listen; a socket left behind is replaced.

        Raises
        ------
        WireError
            The path cannot be used, or another plant listens there.
        """
        self._take = take
        if listens(self._path, socket.SOCK_SEQPACKET):
            raise WireError(
                f"{self._path}: another plant listens there. Stop it, or name another --channel"
            )
        listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        listener.setblocking(False)
        try:
            make_room(self._path, _ANOTHER)
            listener.bind(str(self._path))
            self._path.chmod(0o600)
            listener.listen(8)
            self._made = identity(self._path)
        except RefusedError as error:
            listener.close()
            raise WireError(str(error)) from None
        except OSError as error:
            listener.close()
            raise WireError(f"{self._path}: cannot listen there ({error})") from error
        self._listener = listener
        asyncio.get_running_loop().add_reader(listener.fileno(), self._on_party)

    def send(self, frame: CanFrame) -> None:
        """Send one frame to every party."""
        can_id = frame.can_id | (EXTENDED if frame.extended else 0)
        self._spread(FRAME.pack(can_id, len(frame.data), frame.data), None)

    def report(self, *, bus_off: bool, error: bool = False) -> None:
        """Send an error frame: bus-off, or a bus error; the end of bus-off is silent."""
        if error or bus_off:
            kind = _BUS_ERROR if error else _BUS_OFF
            self._spread(FRAME.pack(ERROR | kind, 8, b""), None)

    def close(self) -> None:
        """Hang up on everybody."""
        loop = asyncio.get_running_loop()
        if self._listener is not None:
            loop.remove_reader(self._listener.fileno())
            self._listener.close()
            self._listener = None
            remove_own(self._path, self._made)
        for descriptor in tuple(self._parties):
            self._forget(descriptor)

    def _on_party(self) -> None:
        if self._listener is None:
            return
        try:
            party, _ = self._listener.accept()
        except OSError:
            return
        party.setblocking(False)
        self._parties[party.fileno()] = party
        asyncio.get_running_loop().add_reader(party.fileno(), self._on_frames, party)

    def _on_frames(self, party: socket.socket) -> None:
        while True:
            try:
                packet = party.recv(FRAME.size)
            except BlockingIOError:
                return
            except OSError:
                packet = b""
            if len(packet) != FRAME.size:
                self._forget(party.fileno())
                return
            self._spread(packet, party)
            can_id, length, data = FRAME.unpack(packet)
            if not can_id & (ERROR | REMOTE):
                extended = bool(can_id & EXTENDED)
                self._take(CanFrame(can_id & 0x1FFF_FFFF, extended, data[: min(length, 8)]))

    def _spread(self, packet: bytes, sender: socket.socket | None) -> None:
        for party in tuple(self._parties.values()):
            if party is sender:
                continue
            try:
                party.send(packet)
            except BlockingIOError:  # its queue is full: a frame lost to this party
                continue
            except OSError:
                self._forget(party.fileno())

    def _forget(self, descriptor: int) -> None:
        party = self._parties.pop(descriptor, None)
        if party is not None:
            asyncio.get_running_loop().remove_reader(descriptor)
            party.close()
