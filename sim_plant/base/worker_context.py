"""What starts the worker processes of a pool: never with modules of the working folder.

multiprocessing starts its processes by ``python -c``, which puts the working folder first on the
module path. Its command line is its own, so the environment tells Python to leave the folder out.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from multiprocessing import resource_tracker
from multiprocessing.context import SpawnContext, SpawnProcess

SAFE_PATH = "PYTHONSAFEPATH"


def spawn_context() -> SpawnContext:
    """Return the context of a pool; it also starts the process that tidies up after workers."""
    with _folder_kept_out():
        resource_tracker.ensure_running()
    return _SafeContext()


class _SafeProcess(SpawnProcess):
    """A worker."""

    def start(self) -> None:
        """Start it."""
        with _folder_kept_out():
            super().start()


class _SafeContext(SpawnContext):
    Process = _SafeProcess


@contextlib.contextmanager
def _folder_kept_out() -> Iterator[None]:
    """Have every Python process started inside leave the working folder out."""
    before = os.environ.get(SAFE_PATH)
    os.environ[SAFE_PATH] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ[SAFE_PATH]
        else:
            os.environ[SAFE_PATH] = before
