"""The visitor's end of the door: hears how the service stands, says nothing."""

from __future__ import annotations

import contextlib
import os
import socket
import struct
from collections.abc import Sequence
from pathlib import Path

from aff_runtime.app.door.messages import (
    MAX_PACKET_BYTES,
    DoorMessage,
    DoorMessageError,
    RingPassed,
    decode,
)
from aff_runtime.app.link.packet_client import connected
from aff_runtime.base.errors import WireError

NOBODY = (
    "no service opens this door ({error}); start it with `aff-runtime run SITE.yaml`, or name "
    "its --door"
)
_DESCRIPTOR = struct.Struct("i")


class DoorClient:
    """A connection to the door of a service.

    Parameters
    ----------
    path : of the socket, ``door.sock`` in the runtime directory or in the one of ``--door-dir``.

    Raises
    ------
    WireError
        When nobody opens there, or it does not let this user in.
    RefusedError
        When folder or listener belong to somebody whose service this cannot be.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._socket = connected(path, NOBODY)

    def receive(self) -> DoorMessage | None:
        """Return the next message, None while there is none.

        Raises
        ------
        WireError
            When the service has hung up, or says what this release does not understand.
        """
        try:
            packet, passed, _, _ = self._socket.recvmsg(
                MAX_PACKET_BYTES, socket.CMSG_SPACE(_DESCRIPTOR.size), socket.MSG_CMSG_CLOEXEC
            )
        except BlockingIOError:
            return None
        except OSError as error:
            raise WireError(f"{self._path}: {error.strerror or error}") from None
        descriptor = _first(passed)
        try:
            if not packet:
                raise WireError(f"{self._path}: the service has closed the door")
            message = decode(packet)
        except (WireError, DoorMessageError) as error:
            _close(descriptor)
            raise WireError(str(error)) from None
        if isinstance(message, RingPassed):
            if descriptor is None:
                raise WireError(f"{self._path}: a ring was told and none came")
            return RingPassed(descriptor=descriptor)
        _close(descriptor)
        return message

    def close(self) -> None:
        """Leave."""
        self._socket.close()


def _first(passed: Sequence[tuple[int, int, bytes]]) -> int | None:
    """Return the first descriptor that came with a packet; any other is closed."""
    descriptors: list[int] = []
    for _, _, data in passed:
        whole = data[: len(data) // _DESCRIPTOR.size * _DESCRIPTOR.size]
        descriptors += [one for (one,) in _DESCRIPTOR.iter_unpack(whole)]
    for other in descriptors[1:]:
        _close(other)
    return descriptors[0] if descriptors else None


def _close(descriptor: int | None) -> None:
    if descriptor is not None:
        with contextlib.suppress(OSError):
            os.close(descriptor)
