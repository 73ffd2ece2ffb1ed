"""numba for this package, cached on disk under a hash of the compiled sources."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

from sim_plant.base.cache_folder import own_cache_folder
from sim_plant.base.numba_alone import numba

F = TypeVar("F", bound=Callable[..., Any])


@functools.cache
def _folder() -> Path | None:
    digest = hashlib.sha256(numba.__version__.encode())
    for name in ("plant.py", "run.py"):
        digest.update((Path(__file__).parent / name).read_bytes())
    return own_cache_folder("aff-blind", digest.hexdigest()[:16])


def compiled(function: F) -> F:
    """Compile ``function``, cached on disk; it may not allocate (no reference counts)."""
    folder = _folder()
    options: dict[str, Any] = {"cache": folder is not None, "error_model": "numpy", "_nrt": False}
    before = getattr(numba.config, "CACHE_DIR")  # noqa: B009
    setattr(numba.config, "CACHE_DIR", str(folder or ""))  # noqa: B010 - numba types it read-only
    try:
        return cast(F, numba.njit(**options)(function))
    finally:
        setattr(numba.config, "CACHE_DIR", before)  # noqa: B010
