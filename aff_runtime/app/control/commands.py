"""What the supervisor sends to the control process, in order; a bypass overtakes what waits."""

from __future__ import annotations

from collections import deque

from aff_runtime.app.link.messages import Arm, Bypass, MeasureResponse, Message, MessageError
from aff_runtime.app.link.packets import Link, LinkClosedError

OPENING = (Arm, MeasureResponse)
MAX_WAITING = 1024


class Commands:
    """The control process's end of the link, for reading.

    Parameters
    ----------
    link : to the supervisor.
    """

    def __init__(self, link: Link) -> None:
        self._link = link
        self._kept: deque[Message] = deque()

    def next(self) -> Message | None:
        """Return the next command or None when there is none.

        Raises
        ------
        LinkClosedError
            When the supervisor has ended and all its messages are taken.
        """
        return self._kept.popleft() if self._kept else self._receive()

    def overtake(self) -> list[Arm | MeasureResponse]:
        """Return the requests that a bypass by signal has overtaken; the rest stays in line.

        Whatever would open the output and was said before the bypass must not undo it; what was
        said after it, counts.
        """
        try:
            while len(self._kept) < MAX_WAITING and (said := self._receive()) is not None:
                self._kept.append(said)
        except LinkClosedError:
            pass  # ``next`` meets it again
        waiting = list(self._kept)
        bypasses = [i for i, said in enumerate(waiting) if isinstance(said, Bypass)]
        end = bypasses[-1] if bypasses else len(waiting)
        overtaken = [said for said in waiting[:end] if isinstance(said, OPENING)]
        self._kept = deque(said for said in waiting if not any(said is x for x in overtaken))
        return overtaken

    def _receive(self) -> Message | None:
        """Return the next message of the link; what is none is passed over, the tick goes on."""
        while True:
            try:
                return self._link.receive()
            except MessageError:
                continue
