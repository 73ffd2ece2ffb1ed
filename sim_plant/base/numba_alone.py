"""numba without the configuration file of the working folder: whoever sent what lies there.

numba takes ``.numba_config.yaml`` of the folder a user stands in, at its import and before each
compilation. It can have any module imported, change the arithmetic, or end the start with a
traceback. The environment's NUMBA_ variables are the user's own and stay.
"""

from __future__ import annotations

import os

_here = os.open(".", os.O_PATH | os.O_DIRECTORY | os.O_CLOEXEC)
try:
    os.chdir("/")  # only root could put one there
    import numba
finally:
    os.fchdir(_here)
    os.close(_here)

setattr(numba.config, "_config_fname", "")  # noqa: B010  a name that is in no folder
numba.config.reload_config()  # type: ignore[no-untyped-call]

__all__ = ["numba"]
