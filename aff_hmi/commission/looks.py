"""How a page looks at the commissioner by GET: for who has logged in, in his language."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from starlette.requests import HTTPConnection, Request
from starlette.responses import JSONResponse, Response

from aff_hmi.commission.in_language import refusal_in
from aff_hmi.commission.link import Commission
from aff_hmi.sessions import Session
from aff_hmi.words import Say
from aff_runtime.app.commission.link.answers import Good
from aff_runtime.app.commission.link.messages import Refusal
from aff_runtime.app.commission.link.messages import Request as Asked
from aff_runtime.app.hand.may import WORDS, Code

MOST_DIGITS = 9
Shown = TypeVar("Shown", bound=Good)


class Looks:
    """Looks at the commissioner for a request.

    Parameters
    ----------
    session_of : the session of a request, None without one. ``say_of`` : its language.
    """

    def __init__(
        self,
        commission: Commission,
        session_of: Callable[[HTTPConnection], Session | None],
        say_of: Callable[[HTTPConnection], Say],
    ) -> None:
        self.commission = commission
        self.session_of = session_of
        self.say_of = say_of

    async def looked(
        self, request: Request, asked: Asked, kind: type[Shown], status: int = 200
    ) -> Shown | Response:
        """Return what the commissioner shows, or the answer that says why not."""
        say = self.say_of(request)
        if self.session_of(request) is None:
            return stranger(say)
        found = await self.commission.look(asked, kind)
        if isinstance(found, Refusal):
            return JSONResponse({"ok": False, "text": refusal_in(found, say)}, status)
        return found


def stranger(say: Say) -> Response:
    """Return the answer to who has not logged in."""
    return JSONResponse({"ok": False, "text": say(WORDS[Code.LOGGED_OUT])}, 401)


def number_in(request: Request) -> int:
    """Return the number that is asked for; 0, which nothing has, for no number."""
    said = request.query_params.get("number", "")
    is_one = said.isascii() and said.isdecimal() and len(said) <= MOST_DIGITS
    return int(said) if is_one else 0


def saved(html: str, name: str) -> Response:
    """Return a page as a file: it has a style of its own."""
    head = {"content-disposition": f'attachment; filename="{name}"'}
    return Response(html, media_type="text/html; charset=utf-8", headers=head)
