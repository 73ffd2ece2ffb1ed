"""Many trivial cases in one test: each is looked at, and each that fails is named.

A parametrised case costs some 4 ms of the suite besides what it does: it is collected in every
worker, set up, reported and taken down. What takes microseconds a case is a loop.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from functools import wraps
from typing import Any


def each_case(
    names: str | tuple[str, ...], cases: Iterable[Any], *, ids: Callable[[Any], object] = str
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Have a test run for every case, all of them even where some fail.

    Parameters
    ----------
    names : of the test's argument that takes a case, or of those that take the parts of one;
        what else it takes is a fixture's, or of another ``each_case``: every case of the one
        with every case of the other.
    ids : the name of a case in the report.
    """
    all_of_them = list(cases)
    taken = (names,) if isinstance(names, str) else names

    def of(test: Callable[..., None]) -> Callable[..., None]:
        @wraps(test)
        def over_all(**more: Any) -> None:
            failed = []
            for case in all_of_them:
                try:
                    parts = (case,) if isinstance(names, str) else case
                    test(**dict(zip(taken, parts, strict=True)), **more)
                except Exception as error:
                    error.add_note(f"case: {ids(case)}")
                    failed.append(error)
            assert all_of_them, f"no case of {names}"
            if failed:
                raise ExceptionGroup(f"{len(failed)} of {len(all_of_them)} cases", failed)

        signature = inspect.signature(test)
        others = [one for one in signature.parameters.values() if one.name not in taken]
        over_all.__signature__ = signature.replace(parameters=others)  # type: ignore[attr-defined]
        return over_all

    return of
