"""What one account does a thousand times hides nothing that another has done."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from aff_runtime.app.hand.client import HandClient
from aff_runtime.app.hand.may import Action, Code, Place
from aff_runtime.app.hand.messages import LOGINS, PRESS_REFUSED, Notice
from aff_runtime.app.supervisor.hand.quotas import MOST_ACCOUNTS, Limits
from tests.aff_runtime.app.supervisor.hand.stand import Stand
from tests.doubles.virtual_clock import VirtualClock

S = 10**9


def flood(stand: Stand, client: HandClient, what: str, account: str, count: int = 95) -> None:
    """Say something so often within a moment, as a screen does that is heard again after it."""
    for _ in range(count):
        client.say(Notice(what=what, account=account, place=Place.NETWORK))
        stand.round()
    stand.clock.advance_ns(2 * S)  # packets, 50 a second


def written(stand: Stand) -> Counter[tuple[str, str]]:
    return Counter((row["what"], row["account"]) for row in stand.rows())


@pytest.mark.parametrize("what", ["login", "logout", "alarm seen", PRESS_REFUSED])
def test_an_account_that_says_too_much_hides_no_line_of_another(stand: Stand, what: str) -> None:
    client = stand.client()
    for _ in range(3):
        flood(stand, client, what, "vera")
    assert 20 <= written(stand)[what, "vera"] <= 61
    for one in ("login", "hand taken", PRESS_REFUSED):
        flood(stand, client, one, "anna", count=5)
        assert written(stand)[one, "anna"] == 5
    stand.say(client, stand.command(Action.BYPASS, account="anna"))
    assert stand.rows()[-1]["what"] == "bypass"


@pytest.mark.parametrize("what", LOGINS)
def test_logins_hide_nothing_else_of_their_own_account(stand: Stand, what: str) -> None:
    client = stand.client()
    flood(stand, client, what, "anna")
    flood(stand, client, "hand taken", "anna", count=20)
    assert written(stand) == {(what, "anna"): 20, ("hand taken", "anna"): 20}
    stand.clock.advance_ns(100 * S)  # 0.01 lines/s: room for one
    stand.round()
    assert stand.rows()[-1]["why"].startswith("75 more logins of anna, of uid ")


def test_names_that_a_screen_makes_up_bring_no_more_lines_and_no_more_memory() -> None:
    clock = VirtualClock(1)
    limits = Limits(clock)
    taken = sum(limits.lines.of(f"name{n}").take() for n in range(50) for _ in range(60))
    assert taken == 300
    for n in range(10 * MOST_ACCOUNTS):
        limits.lines.of(f"other{n}").take()
    assert len(limits.lines._of) <= MOST_ACCOUNTS + 1
    clock.advance_ns(10**6 * S)
    told = [*limits.told(7)]
    assert sum(int(one.split()[0]) for one in told) == 50 * 60 + 10 * MOST_ACCOUNTS - 300
    clock.advance_ns(10**6 * S)
    assert limits.lines.of("anna").take()  # those who have been quiet are forgotten
    assert [*limits.lines._of] == ["anna"]


def test_what_is_written_for_long_leaves_two_days_in_the_audit(stand: Stand) -> None:
    limits = Limits(clock := VirtualClock(1))
    seconds, lines = 100_000, 0
    for _ in range(seconds // 10):
        clock.advance_ns(10 * S)
        for shares in (limits.lines, limits.logins, limits.presses):
            lines += sum(shares.of(f"n{n}").take() for n in range(20))
        lines += limits.strangers.take()
    stand.say(stand.client(), stand.command())
    stand.service.answer()
    longest = max(len(line) + 1 for line in stand.audit.path.read_bytes().splitlines())
    per_day = 86_400 * longest * ((lines - 520) / seconds + 3 * 0.2)  # 520 at once, and no more
    assert 2 * per_day < 8 * (8 << 20)


def test_a_press_that_the_screen_refused_says_what_why_who_and_where(stand: Stand) -> None:
    said = Notice(
        what=PRESS_REFUSED,
        account="vera",
        place=Place.NETWORK,
        action=Action.ARM,
        code=Code.ROLE,
        more=3,
        ago_s=312,
    )
    stand.say(stand.client(), said)
    (row,) = stand.rows()
    assert (row["what"], row["result"], row["account"], row["place"]) == (
        *(PRESS_REFUSED, "noted"),
        *("vera", "network"),
    )
    assert row["why"] == "arm: role; 3 before it were not said; 312 s before this line"


def test_a_hand_that_was_taken_over_says_from_whom(stand: Stand) -> None:
    said = Notice(what="hand taken over", account="bert", place=Place.PANEL, other="anna")
    stand.say(stand.client(), said)
    assert stand.rows()[0]["why"] == "from anna"


def test_what_was_left_out_is_said_when_the_service_ends(tmp_path: Path) -> None:
    stand = Stand(tmp_path)
    client = stand.client()
    flood(stand, client, "login", "anna", count=30)
    assert len(stand.rows()) == 20
    stand.close()
    assert stand.rows()[-1]["why"].startswith("10 more logins of anna, of uid ")
