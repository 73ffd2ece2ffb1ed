"""numba with one setting, apart from the product's.

numba's disk cache looks only at the file of the cached function; the folder is therefore named
after a hash of all compiled sources.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar, cast

from sim_plant.base.cache_folder import own_cache_folder
from sim_plant.base.numba_alone import numba

F = TypeVar("F", bound=Callable[..., Any])


def compiler(cache_name: str, folder: Path, sources: Sequence[str]) -> Callable[[F], F]:
    """Return what compiles the functions of these files of a folder, under one name of the cache.

    They are cached on disk, and may not allocate (no reference counts).
    """

    @functools.cache
    def kept_in() -> Path | None:
        digest = hashlib.sha256(numba.__version__.encode())
        for name in sources:
            digest.update((folder / name).read_bytes())
        return own_cache_folder(cache_name, digest.hexdigest()[:16])

    def compile_one(function: F) -> F:
        place = kept_in()
        options: dict[str, Any] = {
            "cache": place is not None,
            "error_model": "numpy",
            "_nrt": False,
        }
        before = getattr(numba.config, "CACHE_DIR")  # noqa: B009
        setattr(numba.config, "CACHE_DIR", str(place or ""))  # noqa: B010 - numba types it read-only
        try:
            return cast(F, numba.njit(**options)(function))
        finally:
            setattr(numba.config, "CACHE_DIR", before)  # noqa: B010

    return compile_one


compiled = compiler(
    "aff-campaign",
    Path(__file__).parent,
    ("contact.py", "motion.py", "sensing.py", "state.py", "web.py"),
)
"""Compiles a function of this package."""
