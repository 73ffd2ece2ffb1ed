"""What takes seconds to make and several workers of a suite need: made by the first of them."""

from __future__ import annotations

import fcntl
from collections.abc import Callable
from pathlib import Path

import pytest


def made_once(
    factory: pytest.TempPathFactory, worker_id: str, name: str, make: Callable[[Path], object]
) -> Path:
    """Return a folder that ``make`` has filled, in this worker or in another one; read it only.

    Parameters
    ----------
    worker_id : fixture of xdist; ``master`` without workers.
    name : of the folder, one in the suite.
    """
    own = factory.getbasetemp()
    folder = (own if worker_id == "master" else own.parent) / name
    folder.mkdir(exist_ok=True)
    whole = folder / "whole"
    with (folder / "lock").open("w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not whole.exists():
            make(folder)
            whole.touch()
    return folder
