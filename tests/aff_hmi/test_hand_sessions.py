"""Whose hand it is and how long: two technicians, sessions, logins, and what the pages show."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("starlette")

from starlette.requests import HTTPConnection

from aff_hmi.bundles import served
from aff_hmi.sessions import HAND_NS, IDLE_NS, LASTS_NS
from aff_runtime.app.hand.may import Code, Place
from aff_runtime.app.hand.messages import Notice
from aff_runtime.base.signals import State
from tests.aff_hmi.asgi import scope
from tests.aff_hmi.pressed import LOGIN, NAMES, PASSWORD, Browser, Pressed, armed, later, quick

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
    assert (reply.status, reply.code, reply.said["name"]) == (409, "other hand", "anna")
    assert own(at, anna)["has_hand"]
    assert bert.take("take over", of="anna").status == 200
    assert own(at, anna)["lost_to"] == "bert"
    assert not own(at, anna)["has_hand"]
    assert anna.act().code == Code.OTHER_HAND
    assert bert.act().status == 200
    assert anna.act("bypass").status == 200
    assert said_of_hand(at) == ["hand taken anna ", "hand taken over bert anna"]


def said_of_hand(at: Pressed) -> list[str]:
    """Return what the audit is told of the hand: what, who, from whom."""
    notices = [one for one in at.service.said if isinstance(one, Notice)]
    return [f"{n.what} {n.account} {n.other}" for n in notices if n.what.startswith("hand")]


def test_the_hand_is_taken_over_from_the_one_who_was_asked_about_and_nobody_else(
    at: Pressed,
) -> None:
    anna, bert, carl = armed(at), at.browser("bert"), at.browser("carl")
    assert bert.take().said["name"] == "anna"
    assert carl.take("take over", of="anna").status == 200  # meanwhile
    reply = bert.take("take over", of="anna")
    assert (reply.status, reply.code, reply.said["name"]) == (409, "other hand", "carl")
    assert "carl" in reply.said["text"]
    assert own(at, carl)["has_hand"]
    assert bert.take("take over", of="").status == 409
    carl.take("release")
    assert bert.take("take over", of="carl").status == 200  # it was free by then
    assert anna.take("take over", of="bert").status == 200
    assert said_of_hand(at) == [
        "hand taken anna ",
        "hand taken over carl anna",
        "hand released carl ",
        "hand taken bert ",
        "hand taken over anna bert",
    ]


def test_who_has_the_hand_and_takes_it_again_is_not_put_on_record_again(at: Pressed) -> None:
    anna = armed(at)
    for do, of in (("take", ""), ("take over", "anna"), ("take", "")):
        assert anna.take(do, of).status == 200
    assert said_of_hand(at) == ["hand taken anna "]


def test_everybody_sees_who_has_the_hand_since_when_and_from_where(at: Pressed) -> None:
    anna = at.browser("anna")
    nobody = at.browser()
    assert (own(at, nobody)["hand_of"], own(at, nobody)["hand_since_s"]) == ("", 0.0)
    at.wall_s = 1.8e9 + 77.0
    anna.take()
    at.wall_s += 600.0
    at.clock.advance_ns(600_000_000_000)
    anna.take()  # once more changes nothing
    at.show(State.READY)
    for browser in (anna, nobody):
        shown = own(at, browser)
        assert (shown["hand_of"], shown["hand_from"]) == ("anna", "panel")
        assert shown["hand_since_s"] == 1.8e9 + 77.0


def test_only_its_owner_releases_the_hand(at: Pressed) -> None:
    anna, bert = armed(at), at.browser("bert")
    bert.take("release")
    assert own(at, anna)["has_hand"]
    anna.take("release")
    assert not own(at, anna)["hand_of"]
    assert anna.act().code == Code.NO_HAND


def test_the_hand_ends_when_nothing_is_pressed(at: Pressed) -> None:
    anna = armed(at)
    at.clock.advance_ns(HAND_NS + 1)
    at.show(State.READY)
    assert own(at, anna)["hand_of"] == ""
    assert anna.act().code == Code.NO_HAND


# --- sessions ----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["anna", "carl"])
def test_an_idle_session_looks_and_bypasses_until_it_logs_in_again(at: Pressed, name: str) -> None:
    browser = armed(at, name)
    at.clock.advance_ns(IDLE_NS[NAMES[name]] + 1)
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
        at.clock.advance_ns(LASTS_NS // 24)
        assert browser.act("bypass").status == 200
    at.clock.advance_ns(1)
    assert browser.take().status == 401


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
    assert old.take().status == 401


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
    "nothing pressed": lambda at, _: later(at, HAND_NS + 1),
    "twelve hours": lambda at, _: later(at, LASTS_NS + 1),
    "account gone": lambda at, _: (at.file.write_text(""), at.show(State.READY)),
    "another login": lambda at, anna: anna.post("/login", LOGIN),
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


@pytest.mark.parametrize(
    ("host", "is_tls", "name"),
    [
        ("127.0.0.1:8480", False, "aff-8480"),
        ("aff-line1:8480", True, "__Host-aff-8480"),
        ("aff-line1", True, "__Host-aff-443"),
        ("[::1]", False, "aff-80"),
        ("[::1]:8480", False, "aff-8480"),
    ],
)
def test_a_cookie_is_named_after_the_port_said_or_not(
    at: Pressed, host: str, is_tls: bool, name: str
) -> None:
    assert at.pages.presses is not None
    asked = HTTPConnection(scope("/", [("host", host)], "http", "GET", is_tls=is_tls))
    assert at.pages.presses.cookie_name(asked) == name


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
    at.clock.advance_ns(12 * 10**9)
    assert thief.post("/login", wrong).status == 401
    others = [
        thief.post("/login", {"name": f"n{n}", "password": "wrong password"}).status
        for n in range(30)
    ]
    assert others.count(401) < 20
    assert others[-1] == 429


def test_the_pages_show_what_can_be_pressed(at: Pressed) -> None:
    own = "<strong>anna</strong> (operate)"
    for browser, word in ((at.browser(), "Log in"), (at.browser("anna"), own)):
        page = browser.get().said["text"]
        assert word in page
        assert 'id="bypass"' in page
    page = at.browser().get("/login?lang=de").said["text"]
    assert "Passwort" in page
    assert "default-src 'none'" in at.browser().get("/login").headers["content-security-policy"]
    files = served(has_hand=True)
    assert {"login.js", "overview.js", "screen.css"} <= set(files)
    assert b"// hand.js" in files["overview.js"][0]


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
