"""A python-can bus that never raises in the tick: its faults become a reconnect in steps."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from aff_runtime.base.clock import wall_time_s
from aff_runtime.base.ports import Clock
from aff_runtime.base.python_can import can
from aff_runtime.fieldbus.can.frames import Frame

_ERROR_BUS_OFF: Final = 0x40  # CAN_ERR_BUSOFF of linux/can/error.h, in the identifier
_FAULTS: Final = (can.CanError, OSError, ValueError)


class PythonCanLink:
    """``FrameLink`` over any python-can bus that opens at once (SocketCAN, ``slcan_tty``).

    A bus-off error frame, or any error of the driver, closes the bus; it is opened again after a
    pause that doubles from ``backoff_min_s`` to ``backoff_max_s`` until a frame arrives. A bus
    that has brought frames for ``backoff_max_s`` or longer is opened again at once, as a Modbus
    connection is, but for bus-off: while a controller is bus-off nothing is sent, and the pause
    is the quiet time that it needs.

    Parameters
    ----------
    open_bus : makes the bus; called by ticks, so it must return within a millisecond or so.
    clock : monotonic time.
    wall_s : the clock of the drivers' receive stamps.

    Attributes
    ----------
    bus_offs, error_frames, opens, refused : counts since construction.
    why_closed : the driver's own words when the bus last could not be opened; empty before.
    """

    def __init__(
        self,
        open_bus: Callable[[], can.BusABC],
        clock: Clock,
        *,
        backoff_min_s: float = 0.1,
        backoff_max_s: float = 2.0,
        wall_s: Callable[[], float] = wall_time_s,
    ) -> None:
        self._open = open_bus
        self._wall_s = wall_s
        self._stamp_s = 0.0
        self._clock = clock
        self._backoff_min_ns = round(backoff_min_s * 1e9)
        self._backoff_max_ns = round(backoff_max_s * 1e9)
        self._backoff_ns = self._backoff_min_ns
        self._act_at_ns = self._up_at_ns = clock.now_ns()
        self._served = False  # a frame on this bus
        self._bus: can.BusABC | None = None
        self.bus_offs = 0
        self.error_frames = 0
        self.opens = 0
        self.refused = 0
        self.why_closed = ""

    @property
    def carries(self) -> bool:
        """Whether the bus is open."""
        return self._bus is not None

    @property
    def troubles(self) -> tuple[str, ...]:
        """What the driver says about a bus that does not open."""
        if self._bus is not None or not self.why_closed:
            return ()
        return (f"the CAN bus does not open: {self.why_closed}",)

    @property
    def arrived_ns(self) -> int:
        """When the last frame was here by its driver's stamp, monotonic; -1 without a stamp.

        Stamps are wall time: across a step of that clock the answer is any number.
        """
        if self._stamp_s <= 0.0:
            return -1
        return self._clock.now_ns() - round((self._wall_s() - self._stamp_s) * 1e9)

    def ready(self) -> bool:
        """Open the bus when it is time to; True when frames can be exchanged."""
        if self._bus is not None:
            return True
        if self._clock.now_ns() >= self._act_at_ns:
            try:
                self._bus = self._open()
                self.opens += 1
                self._up_at_ns, self._served = self._clock.now_ns(), False
            except _FAULTS as error:
                self.why_closed = str(error)
                self._drop()
        return False

    def send(self, frame: Frame) -> bool:
        """Hand one frame to the driver; False when it does not take it."""
        bus = self._bus
        if bus is None:
            return False
        try:
            bus.send(
                can.Message(
                    arbitration_id=frame.can_id,
                    is_extended_id=frame.extended,
                    data=frame.data,
                    check=False,
                ),
                timeout=0,
            )
        except _FAULTS:
            self.refused += 1
            self._drop()
            return False
        return True

    def sync(self) -> bool:
        """Return whether the bus still carries frames; it has no SYNC."""
        return self._bus is not None

    def receive(self, wait_ns: int) -> Frame | None:
        """Return the next data frame, waiting at most ``wait_ns``."""
        bus = self._bus
        if bus is None:
            return None
        try:
            message = bus.recv(wait_ns * 1e-9)
        except _FAULTS:
            self._drop()
            return None
        if message is None:
            return None
        if message.is_error_frame:
            return self._judge_error(message.arbitration_id)
        if message.is_remote_frame or message.is_fd:
            return Frame(-1, False, b"")
        self._backoff_ns = self._backoff_min_ns
        self._served = True
        self._stamp_s = message.timestamp
        return Frame(message.arbitration_id, message.is_extended_id, bytes(message.data))

    def close(self) -> None:
        """Release the bus."""
        self._shut()
        self._act_at_ns = self._clock.now_ns()

    def _judge_error(self, error: int) -> Frame | None:
        self.error_frames += 1
        if error & _ERROR_BUS_OFF:
            self.bus_offs += 1
            self._served = False
            self._drop()
            return None
        return Frame(-1, False, b"")

    def _drop(self) -> None:
        self._shut()
        now_ns = self._clock.now_ns()
        proven = self._served and now_ns - self._up_at_ns >= self._backoff_max_ns
        self._served = False
        self._act_at_ns = now_ns if proven else now_ns + self._backoff_ns
        if proven:
            return
        self._backoff_ns = min(2 * self._backoff_ns, self._backoff_max_ns)

    def _shut(self) -> None:
        bus, self._bus = self._bus, None
        if bus is not None:
            try:
                bus.shutdown()
            except _FAULTS:
                self.refused += 1
