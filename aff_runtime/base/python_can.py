"""python-can without the files that it can also write: a bus needs none of them.

``import can`` alone loads asammdf wherever that is installed (extra ``records``), and with it
pandas and pyarrow: 0.75 s of a core at every start and 98 MB in the control process, for a kind
of log that nobody writes this way. Every module that speaks CAN takes ``can`` from here.

Raises
------
ModuleNotFoundError
    The extra ``can`` is not installed.
"""

from __future__ import annotations

import sys

_FILES = "asammdf"
_masked = _FILES not in sys.modules
if _masked:
    sys.modules[_FILES] = None  # type: ignore[assignment]  # an import of it fails, as documented
try:
    import can
finally:
    if _masked:
        del sys.modules[_FILES]

__all__ = ["can"]
