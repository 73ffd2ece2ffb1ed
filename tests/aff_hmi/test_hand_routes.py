"""Who may press what on a screen with a hand: every route, role and login from one table."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from typing import Any

import pytest

pytest.importorskip("starlette")

from starlette.requests import HTTPConnection
from starlette.routing import Route

from aff_hmi.gate import BURST, MAX_TEXTS_BYTES
from aff_hmi.hand_routes import place_of
from aff_hmi.press_request import TABLE
from aff_runtime.app.hand.accounts import Account, secret_of, with_pin, write_accounts
from aff_runtime.app.hand.may import Code, Place, Reason, Role
from aff_runtime.app.hand.messages import VALID_NS, Answer, Welcome
from aff_runtime.base.signals import State
from tests.aff_hmi.asgi import HOST, scope
from tests.aff_hmi.pressed import LOGIN, ORIGIN, PASSWORD, Browser, Pressed, armed, later

BY_ROLE = {None: "", Role.VIEW: "vera", Role.OPERATE: "anna", Role.COMMISSION: "carl"}
EDIT = {"base": "0" * 64, "edits": "a: 1", "text": ""}
GOOD: dict[str, dict[str, Any]] = {
    "/login": LOGIN,
    "/logout": {},
    "/sessions": {},
    "/sessions/end": {"number": 10**6},
    "/hand": {"do": "take", "of": ""},
    "/act": {"action": "bypass", "id": "a" * 32, "seen": "READY", "frame": 1},
    "/acknowledge": {"key": "PLC_STALE"},
    "/shelve": {"key": "PLC_STALE", "minutes": 30, "reason": "known"},
    "/keep": {"first": 1, "last": 9, "ring": "0" * 12, "name": "a splice", "note": ""},
    "/let-go": {"number": 1},
    "/commission/open": {"password": PASSWORD, "over": False},
    "/commission/do": {"do": "begin", "again": ""},
    "/commission/answer": {"number": 1, "text": "yes"},
    "/card/settings": {"do": "keep", "step": 9, "measured": "", "seconds": 0, "reason": "good"},
    "/card/step": {"step": 4, "typed": "", "plc": "", "leave_out": ""},
    "/card/sign": {"step": 4, "measured": "0" * 64, "reason": "seen", "password": PASSWORD},
    "/settings/diff": EDIT,
    "/settings/text": {**EDIT, "former": ""},
    "/settings/try": {**EDIT, "measured": "0" * 64, "seconds": 60, "reason": "it is better"},
    "/settings/save": {**EDIT, "measured": "0" * 64, "reason": "the PLC is slow"},
    "/settings/back": {
        "number": 1,
        "base": "0" * 64,
        "measured": "0" * 64,
        "reason": "as in spring",
    },
    "/refine/lacks": {"windows": "run", "holdout": "", "without": ""},
    "/refine/start": {"windows": "run", "holdout": "", "without": ""},
    "/refine/try": {"number": 1, "measured": "0" * 64, "seconds": 60, "reason": "it is better"},
    "/refine/stop": {},
    "/maintenance/read": {},
    "/maintenance/exchange": {"roll": "r6", "on": "2026-03-02", "reason": "bearing"},
}
# what a logged-in role, or nobody, gets: the status of a press that is right in everything else
MATRIX = {
    "/login": {None: 200, Role.VIEW: 200, Role.OPERATE: 200, Role.COMMISSION: 200},
    "/logout": {None: 401, Role.VIEW: 200, Role.OPERATE: 200, Role.COMMISSION: 200},
    "/sessions": {None: 401, Role.VIEW: 200, Role.OPERATE: 200, Role.COMMISSION: 200},
    # no such session
    "/sessions/end": {None: 401, Role.VIEW: 409, Role.OPERATE: 409, Role.COMMISSION: 409},
    "/hand": {None: 401, Role.VIEW: 403, Role.OPERATE: 200, Role.COMMISSION: 200},
    "/act": {None: 200, Role.VIEW: 200, Role.OPERATE: 200, Role.COMMISSION: 200},
    # no such alarm stands here: 409 is what those get who may
    "/acknowledge": {None: 401, Role.VIEW: 403, Role.OPERATE: 409, Role.COMMISSION: 409},
    "/shelve": {None: 401, Role.VIEW: 403, Role.OPERATE: 409, Role.COMMISSION: 409},
    # no such ticks, no such window
    "/keep": {None: 401, Role.VIEW: 403, Role.OPERATE: 409, Role.COMMISSION: 409},
    "/let-go": {None: 401, Role.VIEW: 403, Role.OPERATE: 409, Role.COMMISSION: 409},
    **{
        path: {None: 401, Role.VIEW: 403, Role.OPERATE: 403, Role.COMMISSION: 409}
        for path in TABLE
        if path.startswith(("/commission/", "/card/", "/refine/", "/maintenance/", "/settings/"))
    },
}
CELLS = [(path, role) for path in MATRIX for role in BY_ROLE]


def test_every_route_is_in_the_table_and_only_looking_is_without_it(at: Pressed) -> None:
    routes = [one for one in at.pages.app().routes if isinstance(one, Route)]
    pressed = {one.path for one in routes if "POST" in (one.methods or ())}
    assert pressed == set(TABLE) == set(MATRIX) == set(GOOD)
    looked = {one.path for one in routes if "GET" in (one.methods or ())}
    assert looked == {"/", "/login", "/metrics", "/static/{name}"}


def test_the_page_of_the_login_has_a_bypass_and_arms_nothing(at: Pressed) -> None:
    text = at.browser().ask("GET", "/login", [("host", HOST)]).said["text"]
    assert re.search(r'<button id="bypass" type="button" +aria', text)  # not disabled
    assert 'id="arm"' not in text
    assert 'data-node="plc"' in text  # with the chain and the state, as every page


@pytest.mark.parametrize(
    ("wanted", "back"),
    [
        ("/alarms", "/alarms"),
        ("/card", "/"),  # no commissioner here
        ("//evil.example", "/"),
        ("https://evil.example/alarms", "/"),
        ("/alarms%0d%0aX:1", "/"),
        ("", "/"),
    ],
)
def test_a_login_leads_back_to_a_page_of_ours_alone(
    keeping: Pressed, wanted: str, back: str
) -> None:
    found = keeping.browser().ask("GET", f"/login?from={wanted}", [("host", HOST)])
    assert f'data-back="{back}"' in found.said["text"]
    came = keeping.browser().ask("GET", "/alarms", [("host", HOST)])
    assert "&amp;from=/alarms" in came.said["text"]


@pytest.mark.parametrize(("path", "role"), CELLS, ids=str)
def test_a_press_gets_what_the_table_says(at: Pressed, path: str, role: Role | None) -> None:
    browser = at.browser(BY_ROLE[role])
    before = len(at.service.commands)
    assert browser.post(path, GOOD[path]).status == MATRIX[path][role]
    assert len(at.service.commands) - before == (path == "/act")


SPOILT: dict[str, tuple[dict[str, str | None], int]] = {
    "a foreign origin": ({"origin": "http://evil.example"}, 403),
    "no origin": ({"origin": None}, 403),
    "the null origin": ({"origin": "null"}, 403),
    "our name at another port": ({"origin": "http://127.0.0.1:1"}, 403),
    "our name as a part": ({"origin": f"{ORIGIN}.evil.example"}, 403),
    "the other scheme": ({"origin": f"https://{HOST}"}, 403),
    "another site": ({"sec_fetch_site": "cross-site"}, 403),
    "another port of this name": ({"sec_fetch_site": "same-site"}, 403),
    "typed by hand": ({"sec_fetch_site": "none"}, 403),
    "a form": ({"content_type": "application/x-www-form-urlencoded"}, 415),
    "plain text": ({"content_type": "text/plain"}, 415),
    "no length": ({"content_length": None}, 411),
    "in pieces": ({"transfer_encoding": "chunked"}, 411),
    "too much": ({"content_length": str(MAX_TEXTS_BYTES + 1)}, 413),
    "another host": ({"host": "evil.example"}, 421),
}


@pytest.mark.parametrize(("headers", "status"), SPOILT.values(), ids=SPOILT)
@pytest.mark.parametrize("path", TABLE)
@pytest.mark.sweep(every=7)
def test_a_page_of_somebody_else_presses_nothing(
    at: Pressed, path: str, headers: dict[str, str | None], status: int
) -> None:
    browser = armed(at)
    before = list(at.service.said)
    assert browser.post(path, GOOD[path], **headers).status == status
    assert at.service.said == before


@pytest.mark.parametrize("token", ["", "x", "token of another"])
def test_without_the_sessions_token_nothing_but_a_bypass_is_done(at: Pressed, token: str) -> None:
    browser, other = armed(at), at.browser("bert")
    browser.token = other.token if token == "token of another" else token
    before = list(at.service.said)
    for path in ("/logout", "/hand"):
        assert browser.post(path, GOOD[path]).status == 403
    assert at.service.said == before
    assert browser.act("arm").status == 403
    assert not at.service.commands
    assert browser.act("bypass").status == 200


@pytest.mark.parametrize("path", ["/", "/login", "/metrics", "/logout", "/hand", "/act"])
@pytest.mark.parametrize("query", ["", "?do=take", "?action=bypass&id=" + "a" * 32])
def test_looking_changes_nothing(at: Pressed, path: str, query: str) -> None:
    browser = armed(at)
    before, held = list(at.service.said), at.hand.sessions.holder()
    status = browser.get(path + query).status
    assert status in ((405,) if path in TABLE and path != "/login" else (200,))
    assert at.service.said == before
    assert at.hand.sessions.holder() is held


BODIES: list[Any] = [
    b"",
    b"{",
    b"[]",
    b"null",
    b"\xff",
    b"[" * 4000,
    {"action": "bypass"},
    {**GOOD["/act"], "more": 1},
    {**GOOD["/act"], "frame": "1"},
    {**GOOD["/act"], "frame": True},
    {**GOOD["/act"], "frame": 1.5},
    {**GOOD["/act"], "id": "short"},
    {**GOOD["/act"], "id": ["a" * 32]},
    {**GOOD["/act"], "action": "stop"},
    {**GOOD["/act"], "seen": "RUNNING"},
    {**GOOD["/act"], "seen": "<img src=x onerror=alert(1)>"},
]


@pytest.mark.parametrize("body", BODIES, ids=lambda one: str(one)[:50])
def test_what_makes_no_sense_is_refused_without_a_trace_of_it(at: Pressed, body: Any) -> None:
    browser = armed(at)
    reply = browser.post("/act", body)
    assert reply.status == 400
    assert not at.service.commands
    assert "img" not in json.dumps(reply.said)
    assert "Traceback" not in json.dumps(reply.said)


def test_who_leaves_in_the_middle_of_a_press_presses_nothing(at: Pressed) -> None:
    browser = armed(at)
    body = json.dumps(GOOD["/act"]).encode()
    reply = browser.ask("POST", "/act", browser.headers(body), body, leaves=True)
    assert reply.status == 400
    assert not at.service.commands


# --- arming ------------------------------------------------------------------------------------


def test_arming_needs_the_hand_and_says_what_the_person_saw(at: Pressed) -> None:
    browser = at.browser("anna")
    assert browser.act().code == Code.NO_HAND
    browser.take()
    shown_ns = at.clock.now_ns()
    at.clock.advance_ns(VALID_NS // 2)
    assert browser.act().status == 200
    (command,) = at.service.commands
    assert (command.account, command.role, command.place) == ("anna", Role.OPERATE, Place.PANEL)
    assert (command.seen, command.valid_until_ns) == ("READY", shown_ns + VALID_NS)


REFUSED: dict[str, tuple[Callable[[Pressed], dict[str, Any]], Code]] = {
    "an old frame": (lambda at: later(at, VALID_NS + 1), Code.LATE),
    "a frame that never was": (lambda at: {"frame": at.frame + 5}, Code.LATE),
    "another state than the frame's": (lambda at: {"seen": "BYPASS"}, Code.LATE),
    "no state": (lambda at: {"seen": ""}, Code.LATE),
}


@pytest.mark.parametrize(("spoil", "why"), REFUSED.values(), ids=REFUSED)
def test_what_was_not_just_seen_does_not_arm(
    at: Pressed, spoil: Callable[[Pressed], dict[str, Any]], why: Code
) -> None:
    browser = armed(at)
    reply = browser.act(**spoil(at))
    assert (reply.status, reply.code) == (409, why)
    assert not at.service.commands


def test_a_step_of_the_wall_clock_changes_nothing(
    at: Pressed, monkeypatch: pytest.MonkeyPatch
) -> None:
    browser = armed(at)
    monkeypatch.setattr("time.time", lambda: 0.0)
    assert browser.act().status == 200
    assert browser.session() is not None


def test_what_the_guard_refuses_is_refused_before_the_press_in_the_readers_words(
    at: Pressed,
) -> None:
    browser = armed(at)
    at.show(State.OFF, "WEB_INTACT=0")
    reply = browser.post(
        "/act?lang=de", {"action": "arm", "id": "a" * 32, "seen": "OFF", "frame": at.frame}
    )
    assert (reply.status, reply.code) == (409, Code.GUARD)
    assert reply.said["text"].startswith("gesperrt durch WEB_INTACT=0: ")
    assert not at.service.commands


def test_a_refusal_of_the_service_is_passed_on(at: Pressed) -> None:
    browser = armed(at)
    why = Reason(code=Code.CHANGED, name="FAULT")
    at.service.answer = Answer(id="a", ok=False, reason=why, audit=2)
    reply = browser.act()
    assert (reply.status, reply.said["text"]) == (409, why.text)


def test_a_service_that_does_not_hear_is_said_with_what_to_do(at: Pressed) -> None:
    browser = armed(at)
    at.service.rules = None
    assert browser.act("bypass").status == 503
    assert "switch at the line" in browser.act("bypass").said["text"]
    assert browser.act().code == Code.SILENT


@pytest.mark.parametrize("arms_from", Place)
def test_from_the_network_one_arms_only_where_the_service_says_so(
    at: Pressed, arms_from: Place
) -> None:
    at.service.rules = Welcome(version="1", ceiling=Role.OPERATE, arms_from=arms_from)
    far = at.browser("anna", client="192.168.7.9")
    far.take()
    reply = far.act()
    assert reply.status == (200 if arms_from is Place.NETWORK else 409)
    assert far.act("bypass").status == 200


def test_somebody_passed_on_by_a_proxy_is_not_at_the_panel(at: Pressed) -> None:
    browser = Browser(at, "127.0.0.1")
    said = {"name": "anna", "password": PASSWORD}
    assert browser.post("/login", said, x_forwarded_for="10.0.0.1").status == 200
    assert browser.session() is None  # it began elsewhere


PLACES: dict[str, tuple[dict[str, str], Place]] = {
    "the gateway itself": ({"host": HOST}, Place.PANEL),
    "its name": ({"host": "LocalHost:8480"}, Place.PANEL),
    "IPv6": ({"host": "[::1]:8480"}, Place.PANEL),
    "port 80, which no browser says": ({"host": "127.0.0.1"}, Place.PANEL),
    "IPv6 at port 80": ({"host": "[::1]"}, Place.PANEL),
    "a tunnel to another port": ({"host": "127.0.0.1:9000"}, Place.PANEL),
    "a proxy that keeps the name": ({"host": "aff-line1:8480"}, Place.NETWORK),
    "a name that begins alike": ({"host": "127.0.0.1.evil.example:8480"}, Place.NETWORK),
    "no name": ({}, Place.NETWORK),
    "X-Real-IP": ({"host": HOST, "x-real-ip": "10.0.0.1"}, Place.NETWORK),
    "X-Forwarded-Host": ({"host": HOST, "x-forwarded-host": "aff-line1"}, Place.NETWORK),
    "Via": ({"host": HOST, "via": "1.1 edge"}, Place.NETWORK),
}


@pytest.mark.parametrize(("heads", "place"), PLACES.values(), ids=PLACES)
def test_only_who_calls_the_gateway_itself_is_at_the_panel(
    heads: dict[str, str], place: Place
) -> None:
    assert place_of(HTTPConnection(scope("/", list(heads.items()), "http", "GET"))) is place


def test_a_session_presses_so_often_and_a_bypass_is_not_counted(at: Pressed) -> None:
    browser = armed(at)
    codes = [browser.act(seen="OFF").status for _ in range(30)]
    assert codes.count(429) == 21  # ten at once, of which taking the hand was one
    assert {browser.act("bypass").status for _ in range(20)} == {200}


def test_a_flood_from_the_same_address_does_not_hold_up_a_bypass(at: Pressed) -> None:
    browser, stranger = at.browser("vera"), at.browser()
    codes = [stranger.act("bypass").status for _ in range(int(BURST) + 20)]
    assert codes[-1] == 429
    assert browser.act("bypass").status == 200


def test_a_bypass_without_a_login_is_still_one_of_our_own_page(at: Pressed) -> None:
    nobody = at.browser()
    for origin in ("http://evil.example", "null", None):
        assert nobody.act("bypass", origin=origin).status == 403
    assert at.service.commands == []
    assert nobody.act("bypass").status == 200
    assert nobody.act("arm").status == 401
    (command,) = at.service.commands
    assert (command.account, command.role, command.place) == ("nobody", Role.VIEW, Place.PANEL)


def test_a_pin_lets_in_at_the_panel_and_is_guessed_five_times(at: Pressed) -> None:
    pinned = Account(name="pia", role=Role.OPERATE, secret=with_pin(secret_of(PASSWORD), "204816"))
    write_accounts(at.file, [pinned])
    far, near = at.browser(client="192.168.7.31"), at.browser()
    assert far.post("/login", {"name": "pia", "password": "204816"}).status == 401
    for guess in range(4):
        said = {"name": "pia", "password": f"10000{guess}"}
        assert near.post("/login", said).status == 401
    assert near.post("/login", {"name": "pia", "password": "204816"}).status == 200
    assert near.take().status == 200
    at.clock.advance_ns(250 * 10**9)  # more than a minute: not the five tries of an account
    other = at.browser()
    assert other.post("/login", {"name": "pia", "password": "100009"}).status == 401
    assert other.post("/login", {"name": "pia", "password": "204816"}).status == 429
    assert other.post("/login", {"name": "pia", "password": PASSWORD}).status == 200
    at.clock.advance_ns(60 * 10**9)
    assert other.post("/login", {"name": "pia", "password": "204816"}).status == 200


@pytest.mark.parametrize("password", ["204816", PASSWORD])
def test_who_knows_the_word_is_never_taken_to_guess(at: Pressed, password: str) -> None:
    pinned = Account(name="pia", role=Role.OPERATE, secret=with_pin(secret_of(PASSWORD), "204816"))
    write_accounts(at.file, [pinned])
    said = {"name": "pia", "password": password}
    assert [at.browser().post("/login", said).status for _ in range(21)] == [200] * 21
