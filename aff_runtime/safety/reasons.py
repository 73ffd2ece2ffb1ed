"""What stands against an armed output: every reason, the first to be cleared first."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from aff_runtime.base.events import BY_CODE
from aff_runtime.safety.causes import FADING, LATCHING, bit, first_code

REMOTE = "REMOTE=1: the PLC arms, by its reset"
SHADOW = "SHADOW=1"
_PERMISSIVE_LOST = bit("PERMISSIVE_LOST")


def reasons(
    causes: int,
    *,
    detail: Callable[[int], str],
    missing: Sequence[str],
    objections: Sequence[str],
    shadow: bool,
    by_plc: bool,
) -> Iterator[str]:
    """Yield all that stands against an armed output; nothing when nothing does. Pure.

    Who needs one reason takes the first: there is no other order anywhere.

    Parameters
    ----------
    causes : present in this tick, as a mask of event codes.
    detail : what a cause of this code is about, a channel or numbers; empty when nothing is known.
    missing : permissives, as ``WEB_INTACT=0``. ``objections`` : of the law.
    shadow : shadow operation is wanted. ``by_plc`` : the PLC alone arms.
    """
    for code in _codes(causes & LATCHING):
        name, about = BY_CODE[code].name, detail(code)
        yield f"{name} ({about})" if about else name
    if causes & _PERMISSIVE_LOST:
        yield from missing
    for code in _codes(causes & FADING & ~_PERMISSIVE_LOST):
        yield BY_CODE[code].name
    yield from objections
    if shadow:
        yield SHADOW
    if by_plc:
        yield REMOTE


def _codes(causes: int) -> Iterator[int]:
    while causes:
        yield first_code(causes)
        causes &= causes - 1
