"""CAN frames over a unix socket, for benches: SocketCAN's own 16 bytes, no kernel driver needed.

A serial line through a pty is delivered by kernel workers of normal priority, which shows as
milliseconds on a busy machine; a unix socket is delivered by the sender.
"""

from __future__ import annotations

import contextlib
import select
import socket
import struct
from typing import Any, Final

from aff_runtime.base.python_can import can

_FRAME: Final = struct.Struct("=IB3x8s")
_SO_TIMESTAMPNS: Final = 35  # of linux/socket.h; Python names it not
_TIMESPEC: Final = struct.Struct("@ll")
_ROOM: Final = socket.CMSG_SPACE(_TIMESPEC.size)
_EXTENDED: Final = 0x8000_0000
_REMOTE: Final = 0x4000_0000
_ERROR: Final = 0x2000_0000


class FrameSocketBus(can.BusABC):
    """python-can bus over a unix SEQPACKET socket that a simulated plant listens on.

    Parameters
    ----------
    channel : path of the socket.

    Raises
    ------
    OSError
        Nobody listens there.
    """

    def __init__(self, channel: str, **kwargs: Any) -> None:
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        try:
            self._socket.setblocking(False)
            self._socket.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 1)
            self._socket.connect(channel)
        except OSError:
            self._socket.close()
            raise
        self.channel_info = f"frames {channel}"
        super().__init__(channel=channel, **kwargs)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Send one frame; a full socket is a dead bus."""
        del timeout
        can_id = msg.arbitration_id | (_EXTENDED if msg.is_extended_id else 0)
        self._socket.send(_FRAME.pack(can_id, msg.dlc, bytes(msg.data)))

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        try:
            if timeout:
                select.select((self._socket,), (), (), timeout)
            packet, beside, _, _ = self._socket.recvmsg(_FRAME.size, _ROOM)
        except BlockingIOError:
            return None, False
        if len(packet) != _FRAME.size:
            raise OSError("the bus went away")
        can_id, length, data = _FRAME.unpack(packet)
        extended = bool(can_id & _EXTENDED)
        message = can.Message(
            timestamp=_stamp_s(beside),
            arbitration_id=can_id & (0x1FFF_FFFF if extended or can_id & _ERROR else 0x7FF),
            is_extended_id=extended,
            is_remote_frame=bool(can_id & _REMOTE),
            is_error_frame=bool(can_id & _ERROR),
            data=data[: min(length, 8)],
        )
        return message, False

    def fileno(self) -> int:
        """Return the descriptor to wait for."""
        return self._socket.fileno()

    def shutdown(self) -> None:
        """Hang up."""
        super().shutdown()
        with contextlib.suppress(OSError):
            self._socket.close()


def _stamp_s(beside: list[tuple[int, int, bytes]]) -> float:
    """Return the kernel's receive stamp, wall time in s; 0 without one."""
    for level, kind, data in beside:
        if level == socket.SOL_SOCKET and kind == _SO_TIMESTAMPNS:
            seconds, nanoseconds = _TIMESPEC.unpack(data)
            return float(seconds + nanoseconds * 1e-9)
    return 0.0
