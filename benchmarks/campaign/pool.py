"""The campaign's worker processes."""

from __future__ import annotations

import multiprocessing
import os
import threading
from concurrent.futures import ProcessPoolExecutor

from sim_plant.base.worker_context import spawn_context


def pool_of(workers: int) -> ProcessPoolExecutor:
    """Return processes that end with this one, killed too: a case takes minutes."""
    return ProcessPoolExecutor(workers, spawn_context(), _watch_parent)


def _watch_parent() -> None:
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
