"""Every route, for every role, at every place, in local and in remote: one table says the answer.

The table is written by hand from what a person may do; no line of it is taken from the product.
"""

from __future__ import annotations

import asyncio
from itertools import product
from typing import Any

import pytest

pytest.importorskip("starlette")

from starlette.routing import Route, WebSocketRoute

from aff_hmi.pages import Pages
from aff_runtime.app.hand.may import Role
from aff_runtime.base.signals import State, Status
from tests.aff_hmi.asgi import HOST, scope
from tests.aff_hmi.pressed import PASSWORD, Browser, Pressed

NAMES = {None: "", Role.VIEW: "vera", Role.OPERATE: "anna", Role.COMMISSION: "carl"}
PLACES = {"panel": "127.0.0.1", "network": "192.168.7.31"}
REMOTE = {"local": "", "remote": "REMOTE=1: the PLC arms, by its reset"}
IN_REMOTE = {"local": Status(0), "remote": Status.REMOTE}
SEEN = ("/alarms", "/rolls", "/trends", "/scope", "/timing")
DATA = ("/events", "/events.csv", "/recent", "/scope", "/scope.csv", "/support.zip", "/windows")
# looked at by everybody everywhere; a trend of no group is no request of ours
LOOKED = {
    **dict.fromkeys(("/", "/login", "/metrics", "/static/screen.css", *SEEN), 200),
    **{f"/data{name}": 200 for name in DATA},
    "/data/trend": 400,
}
LOGGED_OUT, MAY_NOT = 401, 403
EDIT = {"base": "0" * 64, "edits": "a: 1", "text": ""}
WINDOWS = {"windows": "run", "holdout": "", "without": ""}
# what nobody, view, operate and commission get, where place and REMOTE change nothing
PRESSED: dict[str, tuple[dict[str, Any], tuple[int, int, int, int]]] = {
    "/login": ({"name": "bert", "password": PASSWORD}, (200, 200, 200, 200)),
    "/logout": ({}, (LOGGED_OUT, 200, 200, 200)),
    "/sessions": ({}, (LOGGED_OUT, 200, 200, 200)),
    "/sessions/end": ({"number": 10**6}, (LOGGED_OUT, 409, 409, 409)),
    "/hand": ({"do": "take", "of": ""}, (LOGGED_OUT, MAY_NOT, 200, 200)),
    "/acknowledge": ({"key": "none stands"}, (LOGGED_OUT, MAY_NOT, 409, 409)),
    "/shelve": (
        {"key": "none stands", "minutes": 30, "reason": "known"},
        (LOGGED_OUT, MAY_NOT, 409, 409),
    ),
    "/keep": (
        {"first": 1, "last": 9, "ring": "", "name": "no such ticks", "note": ""},
        (LOGGED_OUT, MAY_NOT, 409, 409),
    ),
    "/let-go": ({"number": 1}, (LOGGED_OUT, MAY_NOT, 409, 409)),
    "/commission/open": (
        {"password": PASSWORD, "over": False},
        (LOGGED_OUT, MAY_NOT, MAY_NOT, 409),
    ),
    "/commission/do": ({"do": "begin", "again": ""}, (LOGGED_OUT, MAY_NOT, MAY_NOT, 409)),
    "/commission/answer": ({"number": 1, "text": "yes"}, (LOGGED_OUT, MAY_NOT, MAY_NOT, 409)),
    "/card/settings": (
        {"do": "keep", "step": 9, "measured": "", "seconds": 0, "reason": "better"},
        (LOGGED_OUT, MAY_NOT, MAY_NOT, 409),
    ),
    "/card/step": (
        {"step": 4, "typed": "", "plc": "", "leave_out": ""},
        (LOGGED_OUT, MAY_NOT, MAY_NOT, 409),
    ),
    "/card/sign": (
        {"step": 4, "measured": "0" * 64, "reason": "seen there", "password": PASSWORD},
        (LOGGED_OUT, MAY_NOT, MAY_NOT, 409),
    ),
    "/settings/diff": (EDIT, (LOGGED_OUT, MAY_NOT, MAY_NOT, 409)),
    "/settings/text": (EDIT | {"former": ""}, (LOGGED_OUT, MAY_NOT, MAY_NOT, 409)),
    "/settings/try": (
        EDIT | {"measured": "0" * 64, "seconds": 60, "reason": "it is better"},
        (LOGGED_OUT, MAY_NOT, MAY_NOT, 409),
    ),
    "/settings/save": (
        EDIT | {"measured": "0" * 64, "reason": "the PLC is slow"},
        (LOGGED_OUT, MAY_NOT, MAY_NOT, 409),
    ),
    "/settings/back": (
        {"number": 1, "base": "0" * 64, "measured": "0" * 64, "reason": "it was better"},
        (LOGGED_OUT, MAY_NOT, MAY_NOT, 409),
    ),
    "/refine/lacks": (WINDOWS, (LOGGED_OUT, MAY_NOT, MAY_NOT, 409)),
    "/refine/start": (WINDOWS, (LOGGED_OUT, MAY_NOT, MAY_NOT, 409)),
    "/refine/try": (
        {"number": 1, "measured": "0" * 64, "seconds": 60, "reason": "it is better"},
        (LOGGED_OUT, MAY_NOT, MAY_NOT, 409),
    ),
    "/refine/stop": ({}, (LOGGED_OUT, MAY_NOT, MAY_NOT, 409)),
    "/maintenance/read": ({}, (LOGGED_OUT, MAY_NOT, MAY_NOT, 409)),
    "/maintenance/exchange": (
        {"roll": "r6", "on": "2026-03-02", "reason": "bearing"},
        (LOGGED_OUT, MAY_NOT, MAY_NOT, 409),
    ),
}
ROLES = tuple(NAMES)
WHERE = list(product(ROLES, PLACES, REMOTE))


def browser_of(at: Pressed, role: Role | None, place: str, remote: str) -> Browser:
    """Return a browser of a role at a place that has just seen the line."""
    found = at.browser(NAMES[role], client=PLACES[place])
    at.show(State.READY, blocked=REMOTE[remote])
    return found


def test_the_table_has_every_route_and_no_other(keeping: Pressed) -> None:
    routes = keeping.pages.app().routes
    posts = {r.path for r in routes if isinstance(r, Route) and "POST" in (r.methods or ())}
    gets = {r.path for r in routes if isinstance(r, Route) and "GET" in (r.methods or ())}
    assert posts == {*PRESSED, "/act"}
    assert gets == {path.replace("screen.css", "{name}") for path in LOOKED}
    assert [r.path for r in routes if isinstance(r, WebSocketRoute)] == ["/live"]
    assert len(routes) == len(posts) + len(gets) + 1


@pytest.mark.parametrize(("role", "place", "remote"), WHERE, ids=str)
@pytest.mark.sweep(every=3)
def test_everybody_looks_at_everything(
    keeping: Pressed, role: Role | None, place: str, remote: str
) -> None:
    browser = browser_of(keeping, role, place, remote)
    for path, status in LOOKED.items():
        said = [("host", HOST), ("cookie", browser.cookie)]
        assert status_of(keeping, scope(path, said, "http", "GET"), PLACES[place]) == status, path


@pytest.mark.parametrize(("role", "place", "remote"), WHERE, ids=str)
def test_a_press_gets_what_role_place_and_remote_say(
    keeping: Pressed, role: Role | None, place: str, remote: str
) -> None:
    for path, (said, statuses) in PRESSED.items():
        browser = browser_of(keeping, role, place, remote)
        assert browser.post(path, said).status == statuses[ROLES.index(role)], path
        keeping.clock.advance_ns(120 * 10**9)  # logins are slowed down
        browser.take("release")


@pytest.mark.parametrize(("role", "place", "remote"), WHERE, ids=str)
def test_a_bypass_needs_a_login_on_the_network_and_nothing_else(
    keeping: Pressed, role: Role | None, place: str, remote: str
) -> None:
    browser = browser_of(keeping, role, place, remote)
    reply = browser.act("bypass", x_aff_token=None)
    is_free = role is not None or place == "panel"
    assert reply.status == (200 if is_free else LOGGED_OUT)
    assert [one.account for one in keeping.service.commands] == [NAMES[role] or "nobody"] * is_free


# arming: who is not logged in, may not by role, is not at the panel, or in remote, is told so
ARM = {
    (None, "panel", "local"): (401, "logged out"),
    (None, "panel", "remote"): (401, "logged out"),
    (None, "network", "local"): (401, "logged out"),
    (None, "network", "remote"): (401, "logged out"),
    (Role.VIEW, "panel", "local"): (409, "role"),
    (Role.VIEW, "panel", "remote"): (409, "role"),
    (Role.VIEW, "network", "local"): (409, "place"),
    (Role.VIEW, "network", "remote"): (409, "place"),
    (Role.OPERATE, "panel", "local"): (200, ""),
    (Role.OPERATE, "panel", "remote"): (409, "guard"),
    (Role.OPERATE, "network", "local"): (409, "place"),
    (Role.OPERATE, "network", "remote"): (409, "place"),
    (Role.COMMISSION, "panel", "local"): (200, ""),
    (Role.COMMISSION, "panel", "remote"): (409, "guard"),
    (Role.COMMISSION, "network", "local"): (409, "place"),
    (Role.COMMISSION, "network", "remote"): (409, "place"),
}


@pytest.mark.parametrize(("role", "place", "remote"), WHERE, ids=str)
def test_arming_needs_role_place_local_and_the_hand(
    keeping: Pressed, role: Role | None, place: str, remote: str
) -> None:
    browser = browser_of(keeping, role, place, remote)
    browser.take()
    keeping.show(State.READY, blocked=REMOTE[remote])
    reply = browser.act("arm")
    assert (reply.status, reply.code) == ARM[role, place, remote]
    assert len(keeping.service.commands) == (reply.status == 200)


@pytest.mark.parametrize("action", ["shadow", "forget"])
@pytest.mark.parametrize(("role", "place", "remote"), WHERE, ids=str)
def test_shadow_and_forgetting_need_what_arming_needs(
    keeping: Pressed, role: Role | None, place: str, remote: str, action: str
) -> None:
    browser = browser_of(keeping, role, place, remote)
    browser.take()
    keeping.show(State.READY, blocked=REMOTE[remote], status=float(IN_REMOTE[remote]))
    reply = browser.act(action)
    status, code = ARM[role, place, remote]
    assert (reply.status, reply.code) == (status, "remote" if code == "guard" else code)
    assert len(keeping.service.commands) == (status == 200)


@pytest.mark.parametrize(
    "path", ["/debug", "/docs", "/openapi.json", "/data", "/arm", "/act/", "/alarms/", "//"]
)
def test_what_is_in_no_table_is_not_there(keeping: Pressed, path: str) -> None:
    browser = keeping.browser("carl")
    assert browser.get(path).status == 404
    assert browser.post(path, {}).status == 404


def test_an_error_of_ours_tells_a_browser_nothing_of_the_code(
    keeping: Pressed, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object, **__: object) -> None:
        raise RuntimeError("secret of the code")

    monkeypatch.setattr(Pages, "_page", fails)
    told: list[Any] = []
    with pytest.raises(RuntimeError):
        answer_to(keeping, scope("/", [("host", HOST)], "http", "GET"), told)
    start, *rest = told
    body = b"".join(one.get("body", b"") for one in rest)
    assert start["status"] == 500
    assert body == b"Internal Server Error"
    assert b"content-security-policy" in dict(start["headers"])


def status_of(at: Pressed, asked: dict[str, object], client: str) -> int:
    told: list[Any] = []
    answer_to(at, asked | {"client": (client, 5000)}, told)
    return int(told[0]["status"])


def answer_to(at: Pressed, asked: dict[str, object], told: list[Any]) -> None:

    async def receive() -> Any:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Any) -> None:
        told.append(message)

    asyncio.run(at.gate(asked, receive, send))
