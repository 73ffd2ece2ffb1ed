"""Who may press what on a screen with a hand: every route, role and login from one table."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("starlette")

from starlette.requests import HTTPConnection
from starlette.routing import Route

from aff_hmi.gate import BURST, MAX_BODY_BYTES
from aff_hmi.hand_routes import TABLE, place_of
from aff_hmi.pages import ASSETS
from aff_hmi.sessions import HAND_NS, IDLE_NS, LASTS_NS
from aff_runtime.app.hand.may import Code, Place, Reason, Role
from aff_runtime.app.hand.messages import VALID_NS, Answer, Welcome
from aff_runtime.base.signals import State
from tests.aff_hmi.asgi import HOST, scope
from tests.aff_hmi.pressed import NAMES, ORIGIN, PASSWORD, Browser, Pressed, quick

BY_ROLE = {None: "", Role.VIEW: "vera", Role.OPERATE: "anna", Role.COMMISSION: "carl"}
GOOD: dict[str, dict[str, Any]] = {
    "/login": {"name": "anna", "password": PASSWORD},
    "/logout": {},
    "/hand": {"do": "take"},
    "/act": {"action": "bypass", "id": "a" * 32, "seen": "READY", "frame": 1},
}
# what a logged-in role, or nobody, gets: the status of a press that is right in everything else
MATRIX = {
    "/login": {None: 200, Role.VIEW: 200, Role.OPERATE: 200, Role.COMMISSION: 200},
    "/logout": {None: 401, Role.VIEW: 200, Role.OPERATE: 200, Role.COMMISSION: 200},
    "/hand": {None: 401, Role.VIEW: 403, Role.OPERATE: 200, Role.COMMISSION: 200},
    "/act": {None: 401, Role.VIEW: 200, Role.OPERATE: 200, Role.COMMISSION: 200},
}
CELLS = [(path, role) for path in MATRIX for role in BY_ROLE]


@pytest.fixture
def at(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Pressed:
    quick(monkeypatch)
    return Pressed(tmp_path)


def armed(at: Pressed, name: str = "anna") -> Browser:
    """Return a browser whose session has the hand."""
    found = at.browser(name)
    assert found.take().status == 200
    return found


def test_every_route_is_in_the_table_and_only_looking_is_without_it(at: Pressed) -> None:
    routes = [one for one in at.pages.app().routes if isinstance(one, Route)]
    pressed = {one.path for one in routes if "POST" in (one.methods or ())}
    assert pressed == set(TABLE) == set(MATRIX) == set(GOOD)
    looked = {one.path for one in routes if "GET" in (one.methods or ())}
    assert looked == {"/", "/login", "/metrics", "/static/{name}"}


@pytest.mark.parametrize(("path", "role"), CELLS, ids=str)
def test_a_press_gets_what_the_table_says(at: Pressed, path: str, role: Role | None) -> None:
    browser = at.browser(BY_ROLE[role])
    before = len(at.service.commands)
    assert browser.post(path, GOOD[path]).status == MATRIX[path][role]
    is_done = path == "/act" and role is not None
    assert len(at.service.commands) - before == is_done


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
    "too much": ({"content_length": str(MAX_BODY_BYTES + 1)}, 413),
    "another host": ({"host": "evil.example"}, 421),
}


@pytest.mark.parametrize(("headers", "status"), SPOILT.values(), ids=SPOILT)
@pytest.mark.parametrize("path", TABLE)
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
    assert browser.act("arm").status == 403
    assert at.service.said == before
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
    shown_ns = at.clock.ns
    at.clock.ns += VALID_NS // 2
    assert browser.act().status == 200
    (command,) = at.service.commands
    assert (command.account, command.role, command.place) == ("anna", Role.OPERATE, Place.PANEL)
    assert (command.seen, command.valid_until_ns) == ("READY", shown_ns + VALID_NS)


REFUSED: dict[str, tuple[Callable[[Pressed], dict[str, Any]], Code]] = {
    "an old frame": (lambda at: _later(at, VALID_NS + 1), Code.LATE),
    "a frame that never was": (lambda at: {"frame": at.frame + 5}, Code.LATE),
    "another state than the frame's": (lambda at: {"seen": "BYPASS"}, Code.LATE),
    "no state": (lambda at: {"seen": ""}, Code.LATE),
}


def _later(at: Pressed, by_ns: int) -> dict[str, Any]:
    frame = at.frame
    at.clock.ns += by_ns
    at.show(State.READY)
    return {"frame": frame}


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


# --- two technicians ---------------------------------------------------------------------------


def own(at: Pressed, browser: Browser, language: str = "en") -> dict[str, Any]:
    """Return what a frame says to this browser alone."""
    from aff_hmi.words import say_in

    token = browser.cookie.partition("=")[2]
    place = Place.PANEL if browser.client == "127.0.0.1" else Place.NETWORK
    found: dict[str, Any] = json.loads(at.hand.own(token, place, say_in(language)))
    return found


def test_one_has_the_hand_the_other_is_told_and_takes_it_over_knowingly(at: Pressed) -> None:
    anna, bert = armed(at), at.browser("bert")
    assert own(at, anna)["has_hand"]
    assert own(at, bert)["why"]["arm"] == ["anna has the hand"]
    assert own(at, bert, "de")["why"]["arm"] == ["anna hat die Hand"]
    assert bert.act().code == Code.OTHER_HAND
    reply = bert.take()
    assert (reply.status, reply.code) == (409, "other hand")
    assert own(at, anna)["has_hand"]
    assert bert.take("take over").status == 200
    assert own(at, anna)["lost_to"] == "bert"
    assert not own(at, anna)["has_hand"]
    assert anna.act().code == Code.OTHER_HAND
    assert bert.act().status == 200
    assert anna.act("bypass").status == 200
    assert at.service.notices[-1] == "hand taken over bert"


def test_only_its_owner_releases_the_hand(at: Pressed) -> None:
    anna, bert = armed(at), at.browser("bert")
    bert.take("release")
    assert own(at, anna)["has_hand"]
    anna.take("release")
    assert not own(at, anna)["hand_of"]
    assert anna.act().code == Code.NO_HAND


def test_the_hand_ends_when_nothing_is_pressed(at: Pressed) -> None:
    anna = armed(at)
    at.clock.ns += HAND_NS + 1
    at.show(State.READY)
    assert own(at, anna)["hand_of"] == ""
    assert anna.act().code == Code.NO_HAND


# --- sessions ----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["anna", "carl"])
def test_an_idle_session_looks_and_bypasses_until_it_logs_in_again(at: Pressed, name: str) -> None:
    browser = armed(at, name)
    at.clock.ns += IDLE_NS[NAMES[name]] + 1
    at.show(State.READY)
    assert browser.act().code == Code.IDLE
    assert browser.act("bypass").status == 200
    assert browser.act().code == Code.IDLE
    assert browser.take().code == Code.IDLE
    browser.post("/login", {"name": name, "password": PASSWORD})
    assert browser.take().status == 200
    assert browser.act().status == 200


def test_a_session_ends_after_twelve_hours_however_busy_it_is(at: Pressed) -> None:
    browser = at.browser("anna")
    for _ in range(24):
        at.clock.ns += LASTS_NS // 24
        assert browser.act("bypass").status == 200
    at.clock.ns += 1
    assert browser.act("bypass").status == 401


def test_a_cookie_that_was_stolen_is_worth_nothing_elsewhere_or_after_the_logout(
    at: Pressed,
) -> None:
    anna = armed(at)
    thief = Browser(at, "192.168.7.66")
    thief.cookie, thief.token = anna.cookie, anna.token
    assert thief.act("bypass").status == 401
    before, token = anna.cookie, anna.token
    assert anna.post("/logout", {}).status == 200
    at_panel = Browser(at, "127.0.0.1")
    at_panel.cookie, at_panel.token = before, token
    assert at_panel.act().status == 401
    assert at.hand.sessions.holder() is None


def test_a_login_makes_a_new_session_and_ends_the_one_before(at: Pressed) -> None:
    browser = at.browser("anna")
    before = browser.cookie
    browser.post("/login", {"name": "anna", "password": PASSWORD})
    assert browser.cookie != before
    old = Browser(at, "127.0.0.1")
    old.cookie = before
    assert old.act("bypass").status == 401


@pytest.mark.parametrize("spoil", ["removed", "another role", "another password", "unreadable"])
def test_an_account_that_changes_ends_its_sessions(at: Pressed, spoil: str) -> None:
    anna = armed(at)
    lines = at.file.read_text().splitlines()
    changed = {
        "removed": [line for line in lines if not line.startswith("anna")],
        "another role": [line.replace("anna:operate", "anna:view") for line in lines],
        "another password": [
            line[:-8] + "AAAAAAA=" if line.startswith("anna") else line for line in lines
        ],
        "unreadable": ["rubbish"],
    }[spoil]
    at.file.write_text("\n".join(changed) + "\n")
    assert anna.act().status == 401
    assert at.hand.sessions.holder() is None
    if spoil != "unreadable":
        assert at.browser("bert").act("bypass").status == 200


ENDED: dict[str, Callable[[Pressed, Browser], object]] = {
    "nothing pressed": lambda at, _: _later(at, HAND_NS + 1),
    "twelve hours": lambda at, _: _later(at, LASTS_NS + 1),
    "account gone": lambda at, _: (at.file.write_text(""), at.show(State.READY)),
    "another login": lambda at, anna: anna.post("/login", GOOD["/login"]),
    "logout": lambda at, anna: anna.post("/logout", {}),
}


@pytest.mark.parametrize("how", ENDED)
def test_a_hand_that_ends_without_a_press_is_put_on_record_once(at: Pressed, how: str) -> None:
    anna = armed(at)
    before = len(at.service.notices)
    ENDED[how](at, anna)
    at.show(State.READY)
    said = at.service.notices[before:]
    assert said.count("hand ended anna") == 1
    assert said.count("session ended anna") == (how in ("twelve hours", "account gone"))


@pytest.mark.parametrize("is_tls", [False, True])
def test_the_cookie_is_for_this_screen_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_tls: bool
) -> None:
    quick(monkeypatch)
    at = Pressed(tmp_path, is_tls=is_tls)
    reply = at.browser().post("/login", {"name": "anna", "password": PASSWORD})
    name, *parts = (part.strip() for part in reply.headers["set-cookie"].split(";"))
    said = {part.lower() for part in parts}
    assert {"httponly", "samesite=strict", "path=/"} <= said
    assert ("secure" in said) is is_tls
    assert name.startswith("__Host-aff-8480=" if is_tls else "aff-8480=")
    assert not any(part.startswith(("domain", "max-age", "expires")) for part in said)
    assert len(name.partition("=")[2]) >= 43  # 256 bits


def test_no_secret_is_shown_in_page_or_frame(at: Pressed) -> None:
    anna = at.browser("anna")
    token = anna.cookie.partition("=")[2]
    page = anna.get().said["text"]
    assert anna.token in page
    assert token not in page
    assert token not in json.dumps(own(at, anna))
    assert anna.token not in json.dumps(own(at, anna))
    assert anna.token not in at.browser().get().said["text"]
    assert token not in repr(at.hand.sessions._sessions)


# --- logins ------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["anna", "nobody-here", "a\nb", "", "x" * 3000])
def test_a_wrong_login_says_nothing_of_what_was_wrong(at: Pressed, name: str) -> None:
    reply = at.browser().post("/login", {"name": name, "password": "wrong password"})
    assert (reply.status, reply.said["text"]) == (401, "name or password is wrong")
    assert "set-cookie" not in reply.headers
    shown = name if name in ("anna", "nobody-here") else "nobody"
    assert at.service.notices == [f"login refused {shown}"]


def test_logins_are_slowed_down_and_never_shut_out(at: Pressed) -> None:
    wrong = {"name": "anna", "password": "wrong password"}
    thief = at.browser(client="192.168.7.66")
    assert [thief.post("/login", wrong).status for _ in range(7)] == [401] * 5 + [429] * 2
    at.browser("anna")  # from elsewhere
    at.clock.ns += 12 * 10**9
    assert thief.post("/login", wrong).status == 401
    others = [
        thief.post("/login", {"name": f"n{n}", "password": "wrong password"}).status
        for n in range(30)
    ]
    assert others.count(401) < 20
    assert others[-1] == 429


def test_the_pages_show_what_can_be_pressed(at: Pressed) -> None:
    for browser, word in ((at.browser(), "Log in"), (at.browser("anna"), "anna (operate)")):
        page = browser.get().said["text"]
        assert word in page
        assert 'id="bypass"' in page
    page = at.browser().get("/login?lang=de").said["text"]
    assert "Passwort" in page
    assert "default-src 'none'" in at.browser().get("/login").headers["content-security-policy"]
    assert {"hand.js", "login.js", "hand.css"} <= set(ASSETS)


def test_presses_logins_and_sessions_are_counted_without_a_name(at: Pressed) -> None:
    anna = armed(at)
    anna.act()
    anna.act(seen="OFF")
    anna.act("bypass")
    at.service.rules = None
    anna.act("bypass")
    at.browser().post("/login", {"name": "anna", "password": "wrong password"})
    text = at.browser().get("/metrics").said["text"]
    for line in (
        'aff_hmi_presses_total{action="arm",result="done"} 1.0',
        'aff_hmi_presses_total{action="arm",result="refused"} 1.0',
        'aff_hmi_presses_total{action="bypass",result="done"} 1.0',
        'aff_hmi_presses_total{action="bypass",result="failed"} 1.0',
        'aff_hmi_logins_total{result="done"} 1.0',
        'aff_hmi_logins_total{result="refused"} 1.0',
        'aff_hmi_sessions{role="operate"} 1.0',
        "aff_hmi_sockets 0.0",
    ):
        assert line in text
    assert "anna" not in text
