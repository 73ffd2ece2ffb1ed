"""What the supervisor sends to the control process, in order; a bypass overtakes what waits."""

from __future__ import annotations

from collections import deque
from typing import Any

from aff_runtime.app.link.packets import Link, LinkClosedError

OPENING = ("ARM", "PROBE")
MAX_WAITING = 1024


class Commands:
    """The control process's end of the link, for reading.

    Parameters
    ----------
    link : to the supervisor.
    """

    def __init__(self, link: Link) -> None:
        self._link = link
        self._kept: deque[dict[str, Any]] = deque()

    def next(self) -> dict[str, Any] | None:
        """Return the next command or None when there is none.

        Raises
        ------
        LinkClosedError
            When the supervisor is gone and all it said is taken.
        """
        return self._kept.popleft() if self._kept else self._link.receive()

    def overtake(self) -> list[dict[str, Any]]:
        """Return the requests that a bypass by signal has overtaken; the rest stays in line.

        Whatever would open the output and was said before the bypass must not undo it; what was
        said after it, counts.
        """
        try:
            while len(self._kept) < MAX_WAITING and (said := self._link.receive()) is not None:
                self._kept.append(said)
        except LinkClosedError:
            pass  # ``next`` meets it again
        waiting = list(self._kept)
        bypasses = [i for i, said in enumerate(waiting) if said.get("do") == "BYPASS"]
        end = bypasses[-1] if bypasses else len(waiting)
        overtaken = [said for said in waiting[:end] if said.get("do") in OPENING]
        self._kept = deque(said for said in waiting if not any(said is x for x in overtaken))
        return overtaken
