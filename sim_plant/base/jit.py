"""One compiler setting for every compiled function of the plant.

numba's disk cache looks only at the file of the cached function, so a change in a callee would go
unseen. The cache folder is therefore named after a hash of all compiled sources.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

from sim_plant.base.cache_folder import own_cache_folder
from sim_plant.base.numba_alone import numba

F = TypeVar("F", bound=Callable[..., Any])


def _source_hash() -> str:
    root = Path(__file__).resolve().parent.parent
    digest = hashlib.sha256(numba.__version__.encode())
    for room in ("base", "geometry", "elements", "line"):
        for path in sorted((root / room).glob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


_FOLDER = own_cache_folder("sim_plant", _source_hash())
if _FOLDER is not None:
    setattr(numba.config, "CACHE_DIR", str(_FOLDER))  # noqa: B010 - numba types it read-only


def compiled(function: F) -> F:
    """Compile ``function`` with numba, cached on disk, IEEE arithmetic, nothing allocated.

    Array reference counts are left out (``_nrt``): they took two thirds of the kernel's time.
    Compiled code works on arrays of its caller only; an allocation in it does not compile.
    Calls are inlined: a call hands over every array of the line word by word, which took a
    third of the step; the arithmetic and its order stay.
    """
    return _made(function, inlined=True)


def compiled_inside(function: F) -> F:
    """Compile a part of the kernel that compiled functions alone call: as ``compiled``.

    Python gets a TypeError. The code that takes a line's arrays out of Python objects is not
    made: for each such function it took longer to compile than the function.
    """
    return _without_python(_made(function, inlined=True, no_cpython_wrapper=True))


def compiled_apart(function: F) -> F:
    """Compile what most lines never enter: as ``compiled_inside``, not inlined.

    What stands in a loop that they run costs them time though they never enter it.
    """
    return _without_python(_made(function, inlined=False, no_cpython_wrapper=True))


def nothing_kept() -> bool:
    """Return whether no compiled code of these sources is kept: then the next call compiles."""
    return _FOLDER is None or next(_FOLDER.rglob("*.nbc"), None) is None


def _made(function: F, *, inlined: bool, **more: bool) -> F:
    options: dict[str, Any] = {
        "cache": _FOLDER is not None,
        "fastmath": False,
        "error_model": "numpy",
        "_nrt": False,
        "forceinline": inlined,
        "no_cfunc_wrapper": True,  # nothing takes a function as a value
        **more,
    }
    return cast(F, numba.njit(**options)(function))


def _without_python(function: F) -> F:
    """Have a call from Python refused: there is no code that would take its arguments."""

    def keep(made: Any) -> None:
        dispatcher.overloads[tuple(made.signature.args)] = made

    def refuse(*_arguments: Any, **_named: Any) -> None:
        raise TypeError(f"{dispatcher.__name__}: compiled functions alone can call it")

    dispatcher = cast(Any, function)
    dispatcher.add_overload, dispatcher._compile_for_args = keep, refuse  # noqa: SLF001
    return function
