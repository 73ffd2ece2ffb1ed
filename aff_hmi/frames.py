"""What goes to a browser: whole frames, ten a second; nothing is merged, nothing left over."""

from __future__ import annotations

import json
import math
from dataclasses import fields
from typing import Any

from aff_hmi.view import View

MAX_SAID_BYTES = 256


def encode(
    view: View, *, number: int, boot: str, utc_s: float = 0.0, is_loud: bool = False
) -> str:
    """Return a frame without the part that is each browser's own; begin it with ``opened``.

    Parameters
    ----------
    utc_s : wall time here, s since 1970: a page has one clock, and a browser's may be wrong.
    is_loud : whether an alarm stands for which a screen that may makes itself heard.
    """
    head = {"q": number, "boot": boot, "utc_s": round(utc_s, 1), "loud": is_loud}
    return _TEXT.encode({**head, **_plain(view)})[1:]


def _plain(one: Any) -> Any:
    """Return the fields of a dataclass; ``asdict`` would copy all that is in them, too."""
    return {field.name: getattr(one, field.name) for field in fields(one)}


_TEXT = json.JSONEncoder(
    ensure_ascii=False, allow_nan=False, separators=(",", ":"), default=_plain
)


def with_part(frame: str, part: str) -> str:
    """Return a frame of ``encode`` with what its page shows beside the head, as JSON."""
    return f'{frame[:-1]},"page":{part}}}'


def opened(frame: str, echo_ms: float, own: str = "") -> str:
    """Return a frame for one browser, with the newest of its own stamps that it answers.

    The age of that stamp bounds the age of the frame, whatever held it up on its way, and needs
    no common clock. ``own`` : what is of its session alone, as JSON.
    """
    session = f'"own":{own},' if own else ""
    return f'{{"echo":{json.dumps(echo_ms)},{session}{frame}'


def said_by(text: str) -> tuple[int, float] | None:
    """Return (number of the frame shown, the browser's stamp in ms); None for anything else."""
    if len(text) > MAX_SAID_BYTES:
        return None
    try:
        said = json.loads(text)
        number, stamp_ms = said["a"], said["t"]
    except (ValueError, KeyError, TypeError, RecursionError):
        return None
    is_number = isinstance(number, int) and not isinstance(number, bool) and 0 <= number < 2**53
    is_stamp = isinstance(stamp_ms, int | float) and not isinstance(stamp_ms, bool)
    if not (is_number and is_stamp and abs(stamp_ms) < 2**53 and math.isfinite(stamp_ms)):
        return None
    return number, float(stamp_ms)
