"""What the supervisor sends to the control process, in order; a bypass overtakes what opens."""

from __future__ import annotations

from collections import deque

from aff_runtime.app.link.messages import Arm, Bypass, MeasureResponse, Message, MessageError
from aff_runtime.app.link.packets import Link, LinkClosedError

OPENING = (Arm, MeasureResponse)
"""Requests after which a correction or an excitation may go out."""
MAX_WAITING = 1024
"""Messages that ``overtake`` reads ahead at most."""


class CommandQueue:
    """The control process's end of the link, for reading.

    Parameters
    ----------
    link : to the supervisor.
    """

    def __init__(self, link: Link) -> None:
        self._link = link
        self._read_ahead: deque[Message] = deque()

    def next(self) -> Message | None:
        """Return the next command or None when there is none.

        Raises
        ------
        LinkClosedError
            When the supervisor has ended and all its messages are taken.
        """
        return self._read_ahead.popleft() if self._read_ahead else self._receive()

    def overtake(self) -> list[Arm | MeasureResponse]:
        """Return the requests that a bypass by SIGUSR1 has overtaken; the rest stays queued.

        Whatever would open the output and was sent before the bypass must not undo it. SIGUSR1
        has no place among the messages: the last ``Bypass`` that waits stands for it, and without
        one all that waits was sent before. What was sent after it counts.
        """
        try:
            while len(self._read_ahead) < MAX_WAITING and (message := self._receive()) is not None:
                self._read_ahead.append(message)
        except LinkClosedError:
            pass  # ``next`` meets it again
        waiting = list(self._read_ahead)
        bypasses = [i for i, message in enumerate(waiting) if isinstance(message, Bypass)]
        end = bypasses[-1] if bypasses else len(waiting)
        overtaken = [message for message in waiting[:end] if isinstance(message, OPENING)]
        self._read_ahead = deque(m for m in waiting if not any(m is x for x in overtaken))
        return overtaken

    def _receive(self) -> Message | None:
        """Return the next message of the link; a packet that is none is skipped."""
        while True:
            try:
                return self._link.receive()
            except MessageError:
                continue
