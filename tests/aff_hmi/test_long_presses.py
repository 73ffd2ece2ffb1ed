"""Presses with texts of site files in them: who may send one, before any of it is read."""

from __future__ import annotations

import asyncio
import json
from typing import Any

import pytest

pytest.importorskip("starlette")

from starlette.types import Message

from aff_hmi import hand_routes, press_request
from aff_hmi.gate import MAX_BODY_BYTES, MAX_TEXTS_BYTES
from aff_hmi.press_request import TABLE
from aff_runtime.app.hand.may import Code
from aff_runtime.config.yaml_marks import MAX_BYTES
from tests.aff_hmi.asgi import scope
from tests.aff_hmi.pressed import Browser, Pressed, armed
from tests.aff_hmi.test_hand_routes import GOOD

TEXTS = ("/settings/diff", "/settings/text", "/settings/try", "/settings/save")
LONG = {"content_length": str(MAX_BODY_BYTES + 1)}


@pytest.mark.parametrize("path", TABLE)
def test_only_what_holds_a_site_file_is_long_and_only_from_a_session(
    at: Pressed, path: str
) -> None:
    browser = armed(at)
    before = list(at.service.said)
    assert (browser.post(path, GOOD[path], **LONG).status == 413) is (path not in TEXTS)
    assert at.browser("").post(path, GOOD[path], **LONG).status == 413
    assert path in TEXTS or at.service.said == before


@pytest.mark.parametrize("path", TEXTS)
@pytest.mark.parametrize(
    ("name", "token", "code"),
    [
        ("vera", None, Code.ROLE),
        ("anna", None, Code.ROLE),
        ("carl", "x", Code.TOKEN),
        ("carl", "", Code.TOKEN),
    ],
)
def test_nothing_long_is_read_from_who_may_not_send_it(
    at: Pressed, monkeypatch: pytest.MonkeyPatch, path: str, name: str, token: str, code: Code
) -> None:
    browser = at.browser(name)
    browser.token = browser.token if token is None else token
    monkeypatch.setattr(hand_routes, "body", None)  # a call of it fails
    reply = browser.post(path, GOOD[path], **LONG)
    assert (reply.status, reply.code) == (403, code)


def test_a_long_press_counts_once_and_is_not_read_when_there_were_too_many(
    at: Pressed, monkeypatch: pytest.MonkeyPatch
) -> None:
    browser = at.browser("carl")
    allowed = int(browser.session().presses._left)
    for _ in range(allowed):
        assert browser.post("/settings/diff", GOOD["/settings/diff"], **LONG).status == 409
    monkeypatch.setattr(hand_routes, "body", None)
    assert browser.post("/settings/diff", GOOD["/settings/diff"], **LONG).status == 429


@pytest.mark.parametrize("text", ['"', "\\", "\n", "é", '[{"\\', "\U0001f3ed"])
def test_two_site_files_of_the_most_bytes_fit(at: Pressed, text: str) -> None:
    most = text * (MAX_BYTES // len(text.encode()))
    said = {**GOOD["/settings/text"], "text": most, "former": most, "edits": "a: 1\n" * 1000}
    raw = json.dumps(said, ensure_ascii=False).encode()  # as JSON.stringify of a browser
    assert len(raw) <= MAX_TEXTS_BYTES
    reply = at.browser("carl").post("/settings/text", raw)
    assert reply.status == 409  # nobody commissions here: it was read


@pytest.mark.parametrize(
    "raw",
    [
        b"[%s0]" % (b"[0]," * 200_000),
        b'{"a":%s0}' % (b"[" * 200_000),
        b'{"base":"","edits":"","text":"\\\\",%s"a":1}' % (b'"b":1,' * 100_000),
        b'{"base":"","edits":"","text":[%s0]}' % (b"0," * 200_000),
        b'{"base":"\\"","edits":"\\\\","text":[%s0]}' % (b'"",' * 200_000),
        '{"base":"\u2201","text":['.encode("utf-16") + "[0],".encode("utf-16-le") * 100_000,
        b" " * 500_000 + json.dumps(GOOD["/settings/diff"]).encode(),
    ],
    ids=lambda raw: str(raw[:40]),
)
def test_what_is_no_flat_object_is_not_even_parsed(
    at: Pressed, monkeypatch: pytest.MonkeyPatch, raw: bytes
) -> None:
    browser = at.browser("carl")

    def loads(said: Any) -> Any:
        raise AssertionError("it was parsed")

    monkeypatch.setattr(press_request.json, "loads", loads)
    headers = browser.headers(raw)
    status: list[int] = []
    asyncio.run(_posted(browser, headers, [raw], status))
    assert status == [400]


async def _posted(
    browser: Browser, headers: list[tuple[str, str]], parts: list[Any], status: list[int]
) -> None:
    """Post a body; a part that is an event is waited for."""

    async def receive() -> Message:
        part = parts.pop(0)
        if isinstance(part, asyncio.Event):
            await part.wait()
            part = parts.pop(0)
        return {"type": "http.request", "body": part, "more_body": bool(parts)}

    async def send(message: Message) -> None:
        if "status" in message:
            status.append(message["status"])

    made = scope("/settings/diff", headers, "http", "POST") | {"client": (browser.client, 5000)}
    await browser.at.gate(made, receive, send)


def test_one_long_body_is_read_at_a_time_and_a_session_that_ended_meanwhile_gets_nothing(
    at: Pressed,
) -> None:
    first, second = at.browser("carl"), at.browser("carl")
    raw = json.dumps({**GOOD["/settings/diff"], "text": "a" * MAX_BODY_BYTES}).encode()

    async def both() -> tuple[list[int], list[int]]:
        more = asyncio.Event()
        parts: tuple[list[Any], list[Any]] = ([raw[:100], more, raw[100:]], [raw])
        status: tuple[list[int], list[int]] = ([], [])
        tasks = []
        for n, browser in enumerate((first, second)):
            asked = _posted(browser, browser.headers(raw), parts[n], status[n])
            tasks.append(asyncio.create_task(asked))
        for _ in range(50):
            await asyncio.sleep(0)
        assert len(parts[1]) == 1  # not read yet
        at.hand.sessions.end_session(first.session())
        more.set()
        await asyncio.gather(*tasks)
        return status

    assert asyncio.run(both()) == ([401], [409])


def test_who_waits_long_for_the_body_of_another_is_told_so(
    at: Pressed, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = at.browser("carl"), at.browser("carl")
    raw = json.dumps({**GOOD["/settings/diff"], "text": "a" * MAX_BODY_BYTES}).encode()

    async def both() -> tuple[list[int], list[int]]:
        more = asyncio.Event()
        one, other = list[int](), list[int]()
        asked = _posted(first, first.headers(raw), [raw[:100], more, raw[100:]], one)
        reads = asyncio.create_task(asked)
        for _ in range(50):
            await asyncio.sleep(0)
        monkeypatch.setattr(hand_routes, "BODY_PATIENCE_S", 0.0)
        await _posted(second, second.headers(raw), [raw], other)
        more.set()
        await reads
        return one, other

    assert asyncio.run(both()) == ([409], [429])
