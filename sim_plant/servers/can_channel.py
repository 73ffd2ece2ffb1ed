"""How the plant's frames reach another process: an slcan adapter on a pty, or a python-can bus."""

from __future__ import annotations

import asyncio
import contextlib
import os
import tty
from pathlib import Path
from typing import Protocol

from aff_runtime.base.errors import WireError
from aff_runtime.base.python_can import can
from sim_plant.servers.can_frames import CanFrame, Take
from sim_plant.servers.frame_hub import FrameHub

_HEX = frozenset(b"0123456789ABCDEFabcdef")


class CanChannel(Protocol):
    """One bus as the plant's event loop sees it."""

    tells_errors: bool
    """Whether ``report`` reaches the other side."""

    def open(self, take: Take) -> None:
        """Begin; ``take`` gets every frame of the runtime."""
        ...

    def send(self, frame: CanFrame) -> None:
        """Send a frame; it is lost when nobody takes it."""
        ...

    def report(self, *, bus_off: bool, error: bool = False) -> None:
        """Tell the other side of bus-off, its end, or an error frame, where the bus can."""
        ...

    def close(self) -> None:
        """Hang up."""
        ...


class PtyChannel:
    """A simulated slcan adapter: a pty, its other end linked at ``path``.

    The link is replaced at every ``open``, so a runtime that reopens its tty by name finds the
    new adapter, as it would find one that was plugged in again.
    """

    tells_errors = True

    def __init__(self, path: Path) -> None:
        self._path = path
        self._master = self._slave = -1
        self._rest = b""
        self._take: Take = lambda _: None

    def open(self, take: Take) -> None:
        """Make the pty and its link.

        Raises
        ------
        WireError
            The link cannot be made.
        """
        self._take = take
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        try:
            fresh = self._path.with_name(f".{self._path.name}.{os.getpid()}")
            fresh.unlink(missing_ok=True)
            fresh.symlink_to(os.ttyname(self._slave))
            fresh.replace(self._path)
        except OSError as error:
            self.close()
            raise WireError(f"{self._path}: cannot link a serial line there ({error})") from error
        asyncio.get_running_loop().add_reader(self._master, self._on_bytes)

    def send(self, frame: CanFrame) -> None:
        """Write one slcan line."""
        head = f"T{frame.can_id:08X}" if frame.extended else f"t{frame.can_id:03X}"
        self._write(f"{head}{len(frame.data):X}{frame.data.hex().upper()}\r")

    def report(self, *, bus_off: bool, error: bool = False) -> None:
        """Write the adapter's state report; an error frame is garbage on the line."""
        self._write("e1b1\r" if error else "sb128255\r" if bus_off else "sa000000\r")

    def close(self) -> None:
        """Hang up; the other end sees the line die."""
        if self._master < 0:
            return
        asyncio.get_running_loop().remove_reader(self._master)
        os.close(self._slave)
        os.close(self._master)
        self._master = self._slave = -1
        with contextlib.suppress(OSError):
            self._path.unlink(missing_ok=True)

    def _write(self, text: str) -> None:
        if self._master < 0:
            return
        with contextlib.suppress(OSError):  # nobody reads
            os.write(self._master, text.encode("ascii"))

    def _on_bytes(self) -> None:
        try:
            chunk = os.read(self._master, 65536)
        except OSError:
            return
        *lines, self._rest = (self._rest + chunk).split(b"\r")
        for line in lines:
            frame = _frame_of(line)
            if frame is not None:
                self._take(frame)


class BusChannel:
    """Any python-can bus with a descriptor: SocketCAN, multicast."""

    tells_errors = False

    def __init__(self, interface: str, channel: str) -> None:
        self._interface, self._channel = interface, channel
        self._bus: can.BusABC | None = None
        self._take: Take = lambda _: None

    def open(self, take: Take) -> None:
        """Open the bus.

        Raises
        ------
        WireError
            It cannot be opened.
        """
        self._take = take
        try:
            self._bus = can.Bus(interface=self._interface, channel=self._channel)
        except (can.CanError, OSError, ValueError) as error:
            raise WireError(f"{self._interface} {self._channel}: {error}") from error
        asyncio.get_running_loop().add_reader(self._bus.fileno(), self._on_frames)

    def send(self, frame: CanFrame) -> None:
        """Send one frame."""
        if self._bus is None:
            return
        message = can.Message(
            arbitration_id=frame.can_id, is_extended_id=frame.extended, data=frame.data
        )
        with contextlib.suppress(can.CanError):  # nobody takes it
            self._bus.send(message, timeout=0)

    def report(self, *, bus_off: bool, error: bool = False) -> None:
        """Do nothing: only a controller can report its state."""

    def close(self) -> None:
        """Leave the bus."""
        if self._bus is not None:
            asyncio.get_running_loop().remove_reader(self._bus.fileno())
            self._bus.shutdown()
            self._bus = None

    def _on_frames(self) -> None:
        while self._bus is not None:
            message = self._bus.recv(0)
            if message is None:
                return
            if not (message.is_error_frame or message.is_remote_frame):
                self._take(
                    CanFrame(message.arbitration_id, message.is_extended_id, bytes(message.data))
                )


def channel_of(interface: str, channel: str) -> CanChannel:
    """Return the channel for ``--can-interface`` and ``--channel``."""
    if interface == "slcan_pty":
        return PtyChannel(Path(channel))
    if interface == "frame_socket":
        return FrameHub(Path(channel))
    return BusChannel(interface, channel)


def _frame_of(line: bytes) -> CanFrame | None:
    """Return the frame of one slcan line; None for the adapter's own commands."""
    digits = {b"t": 3, b"T": 8}.get(line[:1])
    if digits is None or not set(line[1:]) <= _HEX:
        return None
    try:
        length = int(line[1 + digits : 2 + digits], 16)
        data = bytes.fromhex(line[2 + digits :].decode("ascii"))
        can_id = int(line[1 : 1 + digits], 16)
    except ValueError:
        return None
    return CanFrame(can_id, digits == 8, data) if len(data) == length <= 8 else None
