"""Ends the process when a call of the user's library does not come back.

Nothing else could: no signal is obeyed inside the call. A thread tells and ends. The kernel's
alarm clock would tell nothing, and would go on while a debugger holds the library.
"""

from __future__ import annotations

import os
import sys
import threading
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable

THREAD = "watch of PLC code"
LOOK_S = 0.5
LOOKS = 5
"""A call that as many looks find is lost: 2 s, some hundred scans of a PLC."""


class CodeWatch:
    """Looks at the calls of one library from a thread of its own, as long as it is kept.

    Parameters
    ----------
    name : what the words at the end call the library.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._calls = 0
        self._inside = ""
        self._seen, self._times = 0, 0
        over = threading.Event()
        weakref.finalize(self, over.set)
        look = weakref.WeakMethod(self.look)
        threading.Thread(target=_watch, args=(look, over), name=THREAD, daemon=True).start()

    @contextmanager
    def call(self, function: str) -> Iterator[None]:
        """Watch the call of a function of the library."""
        self._calls += 1
        self._inside = function
        try:
            yield
        finally:
            self._inside = ""

    def look(self) -> None:
        """Look once; end the process where the same call was found ``LOOKS`` times in a row."""
        inside, calls = self._inside, self._calls
        again = bool(inside) and calls == self._seen
        self._times = self._times + 1 if again else bool(inside)
        self._seen = calls
        if self._times >= LOOKS:
            text = (
                f"sim-plant: {self._name}: {inside} has not returned for "
                f"{(LOOKS - 1) * LOOK_S:g} s, call {calls} of the library; the plant ends"
            )
            sys.stderr.write(f"{printable(text)}\n")
            sys.stderr.flush()
            os._exit(PlantError.exit_code)


def _watch(look: weakref.WeakMethod[Callable[[], None]], over: threading.Event) -> None:
    while not over.wait(LOOK_S):
        kept = look()
        if kept is not None:
            kept()
        del kept  # while it waits the library may go
