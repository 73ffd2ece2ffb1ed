"""A press on its way: what a request must be, what is known of who sends it, and its answers."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import TypeAlias

from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, Response

from aff_hmi.gate import MAX_BODY_BYTES, MAX_TEXTS_BYTES
from aff_hmi.hand import said_in
from aff_hmi.sessions import Session
from aff_hmi.words import N_, Say
from aff_runtime.app.hand.may import Place, Reason, Role

BODY_PATIENCE_S = 10.0
DONE = N_("done")
MOST_OUTSIDE = 64  # characters of JSON outside of its strings for each key: a number has 16
SECURE_COOKIE = "__Host-"  # a browser takes a cookie of such a name by https alone
Said: TypeAlias = dict[str, str | int | bool]


@dataclass(frozen=True, slots=True, kw_only=True)
class PressRequest:
    """One request past the gate; ``session`` is there wherever the table asks for it.

    Attributes
    ----------
    token : of the session, in the cookie of the name ``cookie``.
    """

    said: Said
    session: Session | None
    token: str
    cookie: str
    place: Place
    address: str
    say: Say

    @property
    def is_secure(self) -> bool:
        """Whether this came by https, and its cookie goes no other way."""
        return self.cookie.startswith(SECURE_COOKIE)


Answering: TypeAlias = Callable[[PressRequest], Awaitable[Response]]


@dataclass(frozen=True, slots=True, kw_only=True)
class PressRule:
    """One row of the table.

    Attributes
    ----------
    role : the least that the account must be for; None needs no login.
    most_bytes : of its JSON body.
    keys : of its JSON body, with their kinds. ``needs_token`` : None leaves it to the entry.
    """

    role: Role | None
    keys: dict[str, type]
    needs_token: bool | None = True
    most_bytes: int = MAX_BODY_BYTES


EDITS: dict[str, type] = {"base": str, "edits": str, "text": str}
WINDOWS: dict[str, type] = {"windows": str, "holdout": str, "without": str}
TABLE = {
    "/login": PressRule(role=None, keys={"name": str, "password": str}, needs_token=False),
    "/logout": PressRule(role=Role.VIEW, keys={}),
    "/sessions": PressRule(role=Role.VIEW, keys={}),
    "/sessions/end": PressRule(role=Role.VIEW, keys={"number": int}),
    "/hand": PressRule(role=Role.OPERATE, keys={"do": str, "of": str}),
    "/act": PressRule(
        role=Role.VIEW,
        keys={"action": str, "id": str, "seen": str, "frame": int},
        needs_token=None,
    ),
    "/acknowledge": PressRule(role=Role.OPERATE, keys={"key": str}),
    "/shelve": PressRule(role=Role.OPERATE, keys={"key": str, "minutes": int, "reason": str}),
    "/keep": PressRule(
        role=Role.OPERATE, keys={"first": int, "last": int, "ring": str, "name": str, "note": str}
    ),
    "/let-go": PressRule(role=Role.OPERATE, keys={"number": int}),
    "/commission/open": PressRule(role=Role.COMMISSION, keys={"password": str, "over": bool}),
    "/commission/do": PressRule(role=Role.COMMISSION, keys={"do": str, "again": str}),
    "/commission/answer": PressRule(role=Role.COMMISSION, keys={"number": int, "text": str}),
    "/card/settings": PressRule(
        role=Role.COMMISSION,
        keys={"do": str, "step": int, "measured": str, "seconds": int, "reason": str},
    ),
    "/card/step": PressRule(
        role=Role.COMMISSION, keys={"step": int, "typed": str, "plc": str, "leave_out": str}
    ),
    "/card/sign": PressRule(
        role=Role.COMMISSION, keys={"step": int, "measured": str, "reason": str, "password": str}
    ),
    "/settings/diff": PressRule(role=Role.COMMISSION, keys=EDITS, most_bytes=MAX_TEXTS_BYTES),
    "/settings/text": PressRule(
        role=Role.COMMISSION, keys={**EDITS, "former": str}, most_bytes=MAX_TEXTS_BYTES
    ),
    "/settings/try": PressRule(
        role=Role.COMMISSION,
        keys={**EDITS, "measured": str, "seconds": int, "reason": str},
        most_bytes=MAX_TEXTS_BYTES,
    ),
    "/settings/save": PressRule(
        role=Role.COMMISSION,
        keys={**EDITS, "measured": str, "reason": str},
        most_bytes=MAX_TEXTS_BYTES,
    ),
    "/settings/back": PressRule(
        role=Role.COMMISSION, keys={"number": int, "base": str, "measured": str, "reason": str}
    ),
    "/refine/lacks": PressRule(role=Role.COMMISSION, keys=WINDOWS),
    "/refine/start": PressRule(role=Role.COMMISSION, keys=WINDOWS),
    "/refine/try": PressRule(
        role=Role.COMMISSION, keys={"number": int, "measured": str, "seconds": int, "reason": str}
    ),
    "/refine/stop": PressRule(role=Role.COMMISSION, keys={}),
    "/maintenance/read": PressRule(role=Role.COMMISSION, keys={}),
    "/maintenance/exchange": PressRule(
        role=Role.COMMISSION, keys={"roll": str, "on": str, "reason": str}
    ),
}


async def body(request: Request, entry: PressRule) -> Said | None:
    """Return the body: the keys of its entry, of their kinds; None for anything else."""
    try:
        raw = await asyncio.wait_for(request.body(), BODY_PATIENCE_S)
        said = json.loads(raw.decode()) if _is_flat(raw, len(entry.keys)) else None
    except (ValueError, RecursionError, TimeoutError, ClientDisconnect):
        return None
    if not isinstance(said, dict) or set(said) != set(entry.keys):
        return None
    is_right = all(_is(said[key], kind) for key, kind in entry.keys.items())
    return said if is_right else None


def _is_flat(raw: bytes, count: int) -> bool:
    """Return whether a body can be an object of ``count`` keys without a list in it.

    ``[0],`` over and over takes 25 times its size when it is parsed; strings take theirs. So what
    stands outside of strings is counted first.
    """
    parts = raw.replace(rb"\\", b"").replace(rb"\"", b"").split(b'"', 4 * count + 1)
    is_few = len(parts) <= 4 * count + 1  # a key and a string have two quotes each
    return is_few and sum(map(len, parts[::2])) <= MOST_OUTSIDE * (count + 1)


def _is(value: object, kind: type) -> bool:
    """Return whether a value is of a kind; whole numbers are no larger than JavaScript's."""
    return type(value) is kind and (kind is not int or abs(value) < 2**53)  # type: ignore[arg-type]


def done(text: str) -> Response:
    """Return the answer to what was done."""
    return JSONResponse({"ok": True, "text": text})


def because(status: int, reason: Reason, say: Say) -> Response:
    """Return a refusal in the words of ``may``."""
    return refusal(status, said_in(reason, say), reason.code)


def refusal(status: int, text: str, code: str = "", name: str = "") -> Response:
    """Return why something was not done; ``name`` : the account that it is of."""
    return JSONResponse({"ok": False, "text": text, "code": code, "name": name}, status)
