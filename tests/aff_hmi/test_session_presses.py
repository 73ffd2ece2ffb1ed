"""Who is logged in, and who may end whose session."""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("starlette")

from tests.aff_hmi.pressed import Browser, Pressed

S = 1_000_000_000


def listed(browser: Browser) -> list[Any]:
    reply = browser.post("/sessions", {})
    assert reply.status == 200
    return list(reply.said["sessions"])


def number_of(browser: Browser, account: str) -> int:
    return int(next(one["number"] for one in listed(browser) if one["account"] == account))


def test_who_has_logged_in_sees_every_session_with_role_place_and_times(at: Pressed) -> None:
    anna = at.browser("anna")
    anna.take()
    at.clock.advance_ns(300 * S)
    vera = at.browser("vera", client="192.168.7.31")
    at.clock.advance_ns(60 * S)
    of_anna, of_vera = listed(vera)
    assert (of_anna["account"], of_anna["role"], of_anna["place"]) == (
        *("anna", "operate", "at the panel"),
    )
    assert (of_anna["since_s"], of_anna["still_s"], of_anna["has_hand"]) == (360, 360, True)
    assert (of_vera["is_own"], of_vera["place"], of_vera["since_s"]) == (
        True,
        "on the network",
        60,
    )
    assert (of_anna["can_end"], of_vera["can_end"]) == (False, True)


def test_no_token_and_no_password_is_told(at: Pressed) -> None:
    at.browser("anna")
    (line,) = listed(at.browser("anna"))[:1]
    assert set(line) == {
        *("number", "account", "role", "place", "since_s", "still_s", "has_hand", "is_own"),
        "can_end",
    }


def test_a_view_account_ends_nobody_elses_session(at: Pressed) -> None:
    anna, vera = at.browser("anna"), at.browser("vera")
    reply = vera.post("/sessions/end", {"number": number_of(vera, "anna")})
    assert (reply.status, reply.code) == (403, "role")
    assert len(listed(anna)) == 2


@pytest.mark.parametrize("by", ["anna", "carl"])
def test_the_same_account_and_role_commission_end_it_and_its_hand_is_free(
    at: Pressed, by: str
) -> None:
    left_open = at.browser("anna")
    left_open.take()
    browser = at.browser(by)
    reply = browser.post("/sessions/end", {"number": listed(browser)[0]["number"]})
    assert reply.status == 200
    assert left_open.post("/sessions", {}).status == 401
    assert at.hand.sessions.holder() is None
    assert [one["account"] for one in listed(browser)] == [by]
    assert f"session ended by {by}" in at.service.notices
    assert "session ended anna" in at.service.notices


def test_a_session_that_waits_for_its_login_ends_none(at: Pressed) -> None:
    carl = at.browser("carl")
    anna = at.browser("anna")
    number = number_of(anna, "anna")
    at.clock.advance_ns(16 * 60 * S)
    reply = carl.post("/sessions/end", {"number": number})
    assert (reply.status, reply.code) == (403, "idle")
    assert carl.post("/sessions", {}).status == 200
    assert len(listed(anna)) == 2


def test_a_number_is_never_given_again(at: Pressed) -> None:
    carl = at.browser("carl")
    first = at.browser("anna")
    number = number_of(carl, "anna")
    first.post("/logout", {})
    at.browser("anna")
    assert number_of(carl, "anna") != number
    assert carl.post("/sessions/end", {"number": number}).status == 409
