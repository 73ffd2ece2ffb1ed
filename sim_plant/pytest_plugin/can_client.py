"""A python-can bus to the frame socket of a served line; needs the extra `can`."""

from __future__ import annotations

import contextlib
import select
import socket
from pathlib import Path
from typing import Any

from aff_runtime.base.python_can import can
from sim_plant.servers.frame_hub import ERROR, EXTENDED, FRAME, REMOTE


class WebLineBus(can.BusABC):
    """Sends and receives classic frames.

    Raises
    ------
    OSError
        Nobody listens at ``channel``.
    """

    def __init__(self, channel: Path, **settings: Any) -> None:
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        try:
            self._socket.connect(str(channel))
        except OSError:
            self._socket.close()
            raise
        self._socket.setblocking(False)
        self.channel_info = f"web line {channel}"
        super().__init__(channel=str(channel), **settings)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Send one frame; it never waits."""
        del timeout
        can_id = msg.arbitration_id | (EXTENDED if msg.is_extended_id else 0)
        self._socket.send(FRAME.pack(can_id, msg.dlc, bytes(msg.data)))

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        if not select.select((self._socket,), (), (), timeout)[0]:
            return None, False
        packet = self._socket.recv(FRAME.size)
        if len(packet) != FRAME.size:
            raise can.CanOperationError(f"{self.channel_info}: the line hung up")
        can_id, length, data = FRAME.unpack(packet)
        message = can.Message(
            arbitration_id=can_id & 0x1FFF_FFFF,
            is_extended_id=bool(can_id & EXTENDED),
            is_remote_frame=bool(can_id & REMOTE),
            is_error_frame=bool(can_id & ERROR),
            data=data[: min(length, 8)],
        )
        return message, False

    def fileno(self) -> int:
        """Return the descriptor to wait for."""
        return self._socket.fileno()

    def shutdown(self) -> None:
        """Hang up; a second time does nothing."""
        super().shutdown()
        with contextlib.suppress(OSError):
            self._socket.close()
