"""Real processes in real time, from outside: wait for them, look after them, ask and kill them."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar

from aff_runtime.app.link.request_client import ServiceClient
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import AffError

CLOCK = MonotonicClock()
PATIENCE_S = 30.0
FIRST_REST_S, LONGEST_REST_S = 0.03, 0.15


def pause(seconds: float) -> None:
    """Wait in real time."""
    CLOCK.sleep_until_ns(CLOCK.now_ns() + int(seconds * 1e9))


def until(what: str, condition: Callable[[], bool], patience_s: float = PATIENCE_S) -> None:
    """Wait for ``condition``: look soon at first, then less often.

    To ask a service for its status takes 5 ms of a core on its side.
    """
    end_ns = CLOCK.now_ns() + int(patience_s * 1e9)
    rest_s = FIRST_REST_S
    while not condition():
        assert CLOCK.now_ns() < end_ns, f"not within {patience_s} s: {what}"
        pause(rest_s)
        rest_s = min(1.2 * rest_s, LONGEST_REST_S)


def forked(deed: Callable[[], object]) -> int:
    """Run a deed in a process of its own, which imports nothing anew; return its number.

    It ends with 0, or with 1 where the deed raised.
    """
    child = os.fork()
    if child:
        return child
    try:
        deed()
        os._exit(0)
    finally:
        os._exit(1)


def is_running(pid: int) -> bool:
    """Return whether a process exists and is no zombie."""
    try:
        return "\nState:\tZ" not in Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return False


def kill(pid: int) -> None:
    """Kill one process of ours the hard way."""
    os.kill(pid, 9)


class Operator:
    """Who asks the service of a runtime directory.

    Parameters
    ----------
    runtime_dir : where the service has its socket.
    """

    ANSWER_WITHIN_S: ClassVar[float] = 40.0

    def __init__(self, runtime_dir: Path) -> None:
        self.runtime_dir = runtime_dir

    def ask(self, do: str, **arguments: Any) -> dict[str, Any]:
        """Return the answer to one request."""
        client = ServiceClient(self.runtime_dir / "control.sock", timeout_s=self.ANSWER_WITHIN_S)
        try:
            return client.ask(do, **arguments)
        finally:
            client.close()

    def status(self) -> dict[str, Any]:
        """Return the service's status, empty while there is none."""
        with contextlib.suppress(AffError):
            return self.ask("status")
        return {}
