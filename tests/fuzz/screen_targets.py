"""What a browser, or who is none, says to the screen under any bytes: an answer of ours."""

from __future__ import annotations

import json
import tempfile
from functools import cache
from http import HTTPStatus
from pathlib import Path
from typing import Any
from unittest.mock import patch

from aff_hmi.frames import said_by
from aff_hmi.press_request import TABLE
from aff_runtime.app.hand import accounts
from aff_runtime.base.signals import State
from tests.aff_hmi.pressed import Browser, Pressed
from tests.fuzz.source import Source

METHODS = ("GET", "POST", "HEAD", "PUT", "OPTIONS")
FRAMES_NS = 10**8
QUERIES = (
    b"lang=de",
    b"kind=state&roll=unwind&before=17",
    b"group=tension&window=10min",
    b"signals=unwind_tension_N,tick_us&seconds=5&roll=unwind&end=40&on=rise&of=tick_us&level=1.5&pre=20",
    b"kept=1&seconds=20",
)
WORDS: dict[type, Any] = {str: "take", int: 1, bool: False}
ANSWERS = {
    HTTPStatus.OK,
    HTTPStatus.BAD_REQUEST,
    HTTPStatus.UNAUTHORIZED,
    HTTPStatus.FORBIDDEN,
    HTTPStatus.NOT_FOUND,
    HTTPStatus.METHOD_NOT_ALLOWED,
    HTTPStatus.CONFLICT,
    HTTPStatus.LENGTH_REQUIRED,
    HTTPStatus.REQUEST_ENTITY_TOO_LARGE,
    HTTPStatus.UNSUPPORTED_MEDIA_TYPE,
    HTTPStatus.MISDIRECTED_REQUEST,
    HTTPStatus.TOO_MANY_REQUESTS,
}


@cache
def screen() -> tuple[Pressed, Browser, list[str]]:
    """Return a screen with a hand, somebody who has logged in, and every path of it."""
    with tempfile.TemporaryDirectory(prefix="aff-fuzz-screen-") as folder:
        at = Pressed(Path(folder), keeps=True)
        browser = at.browser("carl")
    paths = [route.path.replace("{name}", "overview.js") for route in at.pages.app().routes]  # type: ignore[attr-defined]
    return at, browser, paths


def request(data: bytes) -> str:
    """One request, right but for what the bytes spoil of path, query, headers and body."""
    with patch.object(accounts, "_N", 2):  # a password costs nothing here
        return _request(Source(data))


def _request(source: Source) -> str:
    at, browser, paths = screen()
    at.clock.advance_ns(FRAMES_NS)
    at.show(State.READY)
    method = METHODS[source.below(len(METHODS))]
    path = source.pick(paths)
    kinds = TABLE[path].keys if path in TABLE else {}
    body = json.dumps({key: WORDS[kind] for key, kind in kinds.items()}).encode()
    query = source.pick(QUERIES)
    body, query = source.spoilt(body), source.spoilt(query)
    path = _text(source.spoilt(path.encode())) if source.byte() & 1 else path
    headers = [(name, _text(value)) for name, value in _headers(source, browser, body)]
    reply = browser.ask(method, f"{path}?{_text(query)}", headers, body)
    text = json.dumps(reply.said)
    assert reply.status in ANSWERS, reply.status
    assert "Traceback" not in text
    assert ".py" not in text
    assert "content-security-policy" in reply.headers
    return "ok" if reply.status == HTTPStatus.OK else "refused"


def _headers(source: Source, browser: Browser, body: bytes) -> list[tuple[str, bytes]]:
    """Return the headers of our own page; one of four requests has them spoilt."""
    given = [(name, value.encode()) for name, value in browser.headers(body)]
    if source.byte() & 3:
        return given
    at = source.below(len(given))
    name, value = given[at]
    kind = source.below(3)
    if kind == 0:
        del given[at]
    elif kind == 1:
        given.append((name, value))
    else:
        given[at] = (name, source.spoilt(value))
    return given


def receipt(data: bytes) -> str:
    """What a page says on its socket, spoilt or made of the bytes themselves."""
    source = Source(data)
    good = json.dumps({"a": source.word(), "t": 1234.5}).encode()
    said = source.take(400) if source.byte() & 1 else source.spoilt(good)
    found = said_by(_text(said))
    if found is None:
        return "refused"
    number, stamp_ms = found
    assert 0 <= number < 2**53
    assert abs(stamp_ms) < 2**53
    return "ok"


def _text(data: bytes) -> str:
    return data.decode("latin-1")


REQUESTS = [
    bytes([kind, path, query, 0, 0, 0, spoil, 0])
    for kind in (0, 1)
    for path in range(0, 32, 3)
    for query in (0, 3)
    for spoil in (0, 1)
]
RECEIPTS = [bytes(8), b"\x01\x02\x00\x02\x05\x00x", b"\x00\x00\x01{}", bytes(range(1, 40))]
