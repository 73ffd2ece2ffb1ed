"""A kernel timer that a selector can wait for: periodic, absolute, microseconds exact.

asyncio rounds its own timers up to a millisecond; Python 3.11 has no ``os.timerfd_create``.
"""

from __future__ import annotations

import ctypes
import os
import struct

_CLOCK_MONOTONIC = 1
_NS_PER_S = 1_000_000_000


class _TimeSpec(ctypes.Structure):
    _fields_ = (("seconds", ctypes.c_long), ("nanoseconds", ctypes.c_long))


class _TimerSpec(ctypes.Structure):
    _fields_ = (("interval", _TimeSpec), ("first", _TimeSpec))


class PeriodicTimer:
    """Becomes readable every ``period_s``, first one period from now; a late reader loses none.

    Raises
    ------
    OSError
        The kernel refuses (not Linux, no descriptors).
    """

    def __init__(self, period_s: float) -> None:
        libc = ctypes.CDLL(None, use_errno=True)
        flags = os.O_NONBLOCK | os.O_CLOEXEC
        self._descriptor = int(libc.timerfd_create(_CLOCK_MONOTONIC, flags))
        if self._descriptor < 0:
            raise OSError(ctypes.get_errno(), "timerfd_create")
        period = _TimeSpec(*divmod(round(period_s * _NS_PER_S), _NS_PER_S))
        spec = _TimerSpec(interval=period, first=period)
        if libc.timerfd_settime(self._descriptor, 0, ctypes.byref(spec), None) != 0:
            self.close()
            raise OSError(ctypes.get_errno(), "timerfd_settime")

    def fileno(self) -> int:
        """Return the descriptor to wait for."""
        return self._descriptor

    def expirations(self) -> int:
        """Return how many periods ended since the last call; 0 when none did."""
        try:
            return int(struct.unpack("Q", os.read(self._descriptor, 8))[0])
        except BlockingIOError:
            return 0

    def close(self) -> None:
        """Release the descriptor."""
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1
