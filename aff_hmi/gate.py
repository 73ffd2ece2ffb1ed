"""What every request passes before a route sees it: rate, name of the host, method, origin.

The gate looks at headers and addresses only, never at a path: which route there is, the routes
say, and what is none is 404.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterable

from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from aff_runtime.base.ports import Clock

PER_SECOND, BURST = 50.0, 100.0
"""Requests of one address: so many go on and on, and so many at once after a rest."""
MAX_ADDRESSES = 1024
METHODS = ("GET", "HEAD")
MAX_BODY_BYTES = 4096
MAX_TEXTS_BYTES = 1088 * 1024
"""Of a press with texts of site files in it, from a session: two of 256 kB (one typed, and the one
that it was begun on) with two bytes for each of theirs, as JSON has a quote, backslash, tab or end
of a line (YAML takes no other control character), and 64 kB for the rest."""
REFUSED_SOCKET = 1008
"""Code with which a websocket is closed against a rule of the server [RFC 6455, 7.4.1]."""
HEADERS = {
    "content-security-policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; "
        "connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'; "
        "require-trusted-types-for 'script'; trusted-types 'none'"
    ),
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "permissions-policy": "camera=(), microphone=(), geolocation=(), usb=(), serial=()",
    "cache-control": "no-store",
}
HSTS = "max-age=31536000"
"""For a year a browser comes by https alone, where it once did."""


class Rates:
    """A bucket of requests per address; the oldest address is forgotten when there are many."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._buckets: OrderedDict[str, tuple[float, int]] = OrderedDict()

    def allows(self, address: str) -> bool:
        """Return whether one more request of an address is answered."""
        now_ns = self._clock.now_ns()
        left, since_ns = self._buckets.pop(address, (BURST, now_ns))
        left = min(BURST, left + PER_SECOND * (now_ns - since_ns) * 1e-9)
        allowed = left >= 1.0
        self._buckets[address] = (left - 1.0 if allowed else left, now_ns)
        if len(self._buckets) > MAX_ADDRESSES:
            self._buckets.popitem(last=False)
        return allowed


class Gate:
    """Stands in front of all routes.

    Parameters
    ----------
    hosts : ``name:port`` that a browser may have in its address line, lower case.
    is_logged_in : whether a request comes from a session, whose presses no flood of others holds
        up; None where nothing can be pressed.
    """

    def __init__(
        self,
        app: ASGIApp,
        hosts: Iterable[str],
        rates: Rates,
        *,
        is_logged_in: Callable[[Scope], bool] | None = None,
    ) -> None:
        self._app = app
        self._hosts = frozenset(host.lower() for host in hosts)
        self._rates = rates
        self._is_logged_in = is_logged_in
        self._headers = [(k.encode(), v.encode()) for k, v in HEADERS.items()]
        self._over_tls = [*self._headers, (b"strict-transport-security", HSTS.encode())]

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Refuse, or pass on with the headers that every answer has."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return

        async def with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                own = [one for one in message["headers"] if one[0].lower() != b"cache-control"]
                always = self._over_tls if is_by_tls(scope) else self._headers
                message = {**message, "headers": [*own, *always]}
            await send(message)

        refusal = self._refusal(scope)
        if refusal is None:
            await self._app(scope, receive, with_headers)
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": REFUSED_SOCKET})
        else:
            status, words = refusal
            await PlainTextResponse(words + "\n", status)(scope, receive, with_headers)

    def _refusal(self, scope: Scope) -> tuple[int, str] | None:
        """Return why a request is not answered; None when it is."""
        client = scope.get("client")
        is_press = scope["type"] == "http" and scope["method"] == "POST"
        spared = is_press and self._is_logged_in is not None and self._is_logged_in(scope)
        if not (spared or self._rates.allows(client[0] if client else "")):
            return 429, "too many requests; wait a second"
        host = _one(scope, b"host").lower()
        if host not in self._hosts:
            return (
                421,
                "this screen is not known by that name; start aff-hmi with --host NAME:PORT",
            )
        if scope["type"] == "websocket":
            return None if _is_own(scope, host) else (403, "a page of somebody else")
        if is_press and self._is_logged_in is not None:
            return self._not_pressed_here(
                scope, host, MAX_TEXTS_BYTES if spared else MAX_BODY_BYTES
            )
        if scope["method"] not in METHODS:
            return 405, "this screen is for looking"
        return None

    def _not_pressed_here(
        self, scope: Scope, host: str, most_bytes: int
    ) -> tuple[int, str] | None:
        """Return why a press is not one of our own page; None when it is."""
        site = _one(scope, b"sec-fetch-site")
        if not _is_own(scope, host) or (_has(scope, b"sec-fetch-site") and site != "same-origin"):
            return 403, "a page of somebody else"
        if _one(scope, b"content-type").lower() != "application/json":
            return 415, "JSON is needed"
        length = _one(scope, b"content-length")
        is_length = length.isascii() and length.isdigit() and len(length) <= 8
        if not is_length or _has(scope, b"transfer-encoding"):
            return 411, "the length of what is said is needed"
        return None if int(length) <= most_bytes else (413, "that is too much")


def is_by_tls(scope: Scope) -> bool:
    """Return whether a request came by https; at loopback beside a network it did not."""
    return scope["scheme"] in ("https", "wss")


def _is_own(scope: Scope, host: str) -> bool:
    """Return whether a request is of a page that we have served by this name and scheme."""
    scheme = "https" if is_by_tls(scope) else "http"
    return _one(scope, b"origin").lower() == f"{scheme}://{host}"


def _has(scope: Scope, name: bytes) -> bool:
    return any(key.lower() == name for key, _ in scope["headers"])


def _one(scope: Scope, name: bytes) -> str:
    """Return the one header of a name; empty when there is none, or more than one."""
    found = [value for key, value in scope["headers"] if key.lower() == name]
    return found[0].decode("latin-1") if len(found) == 1 else ""
