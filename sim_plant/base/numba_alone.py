"""numba without the configuration file of the working folder: whoever sent what lies there.

numba takes ``.numba_config.yaml`` of the folder a user stands in, at its import and before each
compilation. It can have any module imported, change the arithmetic, or end the start with a
traceback. The environment's NUMBA_ variables are the user's own and stay.

And numba without what it would only look for: its first call imports scipy.linalg to see whether a
BLAS is there, which takes longer than everything that the kernel needs of it, and coverage where
that is installed. Who multiplies matrices in compiled code still gets the BLAS.
"""

from __future__ import annotations

import os
import sys
from importlib import import_module

_covered = "coverage" in sys.modules or "NUMBA_JIT_COVERAGE" in os.environ
_here = os.open(".", os.O_PATH | os.O_DIRECTORY | os.O_CLOEXEC)
try:
    os.chdir("/")  # only root could put one there
    if not _covered:
        sys.modules["coverage"] = None  # type: ignore[assignment]  # "not there"
    import numba
finally:
    if not _covered:
        del sys.modules["coverage"]
    os.fchdir(_here)
    os.close(_here)

setattr(numba.config, "_config_fname", "")  # noqa: B010  a name that is in no folder
numba.config.reload_config()  # type: ignore[no-untyped-call]


def _without_blas() -> None:
    """Import numba's array functions, and let them find no BLAS: one of them then needs none."""

    def absent() -> None:
        raise ImportError("not looked for")

    algebra = import_module("numba.np.linalg")
    look = algebra.ensure_blas
    setattr(algebra, "ensure_blas", absent)  # noqa: B010  numba types it read-only
    try:
        import_module("numba.np.arraymath")
    finally:
        setattr(algebra, "ensure_blas", look)  # noqa: B010


_without_blas()

__all__ = ["numba"]
