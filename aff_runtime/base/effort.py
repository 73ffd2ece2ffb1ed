"""What the reading of a foreign file may cost a command that somebody runs by hand.

The service has files checked by a process of its own. A command reads them itself: its readers
are not ours, and a line of 60 bytes can ask one of them for gigabytes or minutes.
"""

from __future__ import annotations

import contextlib
import gc
import resource
import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from types import FrameType

from aff_runtime.base.errors import AffError

SECONDS = 10.0
MEMORY_BYTES = 1 << 30
AGAIN_S = 0.25
"""Period of the alarm once the time is over, s: one that comes during a garbage collection or a
``__del__``, where Python would drop the exception, raises nothing; the next one does."""


class _TooLong(BaseException):
    """The time is over: no error of a file, so nothing on the way takes it for one."""


@contextlib.contextmanager
def bounded_effort(
    shown: str,
    refusal: type[AffError],
    *,
    seconds: float = SECONDS,
    memory_bytes: int = MEMORY_BYTES,
) -> Iterator[None]:
    """Bound time and further memory of what is done inside; in the main thread alone.

    Parameters
    ----------
    shown : name of the file, as an error may say it.
    refusal : what is raised when it takes more.
    seconds : of the wall clock. ``memory_bytes`` : beyond what this process has reserved.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    limit = _reserved_bytes() + memory_bytes
    known = [bound for bound in (soft, hard) if bound != resource.RLIM_INFINITY]
    resource.setrlimit(resource.RLIMIT_AS, (min([limit, *known]), hard))
    working = True
    collection = _Collection()

    def time_is_over(_: int, frame: FrameType | None) -> None:
        if working and not collection.runs and not _finalises(frame):
            raise _TooLong

    collection.begin_to_watch()
    before = signal.signal(signal.SIGALRM, time_is_over)
    signal.setitimer(signal.ITIMER_REAL, seconds, AGAIN_S)
    what_to_do = "A file that it names is too large or too tangled: look at the newest first."
    try:
        try:
            yield
        finally:
            working = False
    except _TooLong:
        text = f"{shown}: takes more than {seconds:g} s to read. {what_to_do}"
        raise refusal(text) from None
    except MemoryError:
        text = f"{shown}: takes more than {memory_bytes >> 20} MB to read. {what_to_do}"
        raise refusal(text) from None
    finally:
        working = False
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
        collection.end_to_watch()
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


class _Collection:
    """Whether a garbage collection runs: from before all other ``gc.callbacks`` to after them."""

    def __init__(self) -> None:
        self.runs = False

    def begin_to_watch(self) -> None:
        gc.callbacks.insert(0, self._on_start)
        gc.callbacks.append(self._on_stop)

    def end_to_watch(self) -> None:
        gc.callbacks.remove(self._on_start)
        gc.callbacks.remove(self._on_stop)

    def _on_start(self, phase: str, _: object) -> None:
        self.runs = self.runs or phase == "start"

    def _on_stop(self, phase: str, _: object) -> None:
        self.runs = self.runs and phase != "stop"


def _finalises(frame: FrameType | None) -> bool:
    """Return whether ``frame`` runs within a ``__del__``, or within one of ``gc.callbacks``."""
    callbacks = {getattr(callback, "__code__", None) for callback in gc.callbacks}
    while frame is not None:
        if frame.f_code.co_name == "__del__" or frame.f_code in callbacks:
            return True
        frame = frame.f_back
    return False


def _reserved_bytes() -> int:
    """Return the address space of this process."""
    pages = Path("/proc/self/statm").read_text(encoding="ascii").split()[0]
    return int(pages) * resource.getpagesize()
