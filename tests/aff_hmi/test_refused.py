"""A press that the screen refuses itself is said to the service, for its audit."""

from __future__ import annotations

from collections.abc import Callable

import pytest

pytest.importorskip("starlette")

from aff_hmi.refused import AT_ONCE, PER_S, RefusedPresses
from aff_hmi.sessions import IDLE_NS
from aff_runtime.app.hand.may import Code, Place, Role
from aff_runtime.app.hand.messages import PRESS_REFUSED, Notice, encode, read_said
from tests.aff_hmi.pressed import Browser, Pressed, armed, later
from tests.doubles.virtual_clock import VirtualClock


def refused(at: Pressed) -> list[Notice]:
    """Return what the service was told, as it reads it."""
    said = [one for one in at.service.said if isinstance(one, Notice)]
    found = [read_said(encode(one)) for one in said if one.what == PRESS_REFUSED]
    return [one for one in found if isinstance(one, Notice)]


def of_view(at: Pressed) -> Browser:
    found = at.browser("vera")
    found.act("arm")
    return found


def without_token(at: Pressed) -> Browser:
    found = armed(at)
    found.act("arm", x_aff_token="x")
    return found


def too_fast(at: Pressed) -> Browser:
    found = armed(at)
    found.take("release")
    while found.act("arm").code != Code.FAST:
        pass
    return found


def idle(at: Pressed) -> Browser:
    found = armed(at)
    later(at, IDLE_NS[Role.OPERATE] + 1)
    found.act("arm")
    return found


def too_late(at: Pressed) -> Browser:
    found = armed(at)
    found.act("arm", frame=at.frame + 5)
    return found


def unheard(at: Pressed) -> Browser:
    found = at.browser("vera", client="192.168.7.9")
    at.service.rules = None
    found.act("bypass")
    return found


def of_nobody(at: Pressed) -> Browser:
    found = at.browser(client="192.168.7.9")
    found.act("bypass")
    return found


PRESSED: dict[str, tuple[Callable[[Pressed], Browser], str, str, Code]] = {
    "an account that may not": (of_view, "vera", "arm", Code.ROLE),
    "a page older than the login": (without_token, "anna", "arm", Code.TOKEN),
    "too many at once": (too_fast, "anna", "arm", Code.FAST),
    "nothing pressed for long": (idle, "anna", "arm", Code.IDLE),
    "not what was seen": (too_late, "anna", "arm", Code.LATE),
    "a service that does not hear": (unheard, "vera", "bypass", Code.SILENT),
    "nobody, from the network": (of_nobody, "nobody", "bypass", Code.LOGGED_OUT),
}


@pytest.mark.parametrize(("press", "who", "action", "code"), PRESSED.values(), ids=PRESSED)
def test_the_service_hears_what_was_refused_why_of_whom_and_where(
    at: Pressed, press: Callable[[Pressed], Browser], who: str, action: str, code: Code
) -> None:
    browser = press(at)
    place = Place.PANEL if browser.client == "127.0.0.1" else Place.NETWORK
    last = refused(at)[-1]
    assert (last.account, last.action, last.code, last.place) == (who, action, code, place)


def test_what_is_done_and_what_is_no_press_is_not_said(at: Pressed) -> None:
    browser = armed(at)
    assert browser.act("arm").status == 200
    assert browser.act("bypass").status == 200
    assert browser.act("stop").status == 400
    assert at.browser().post("/act", b"{").status == 400
    assert at.browser().act("stop").status == 401
    assert at.browser("vera").take().status == 403
    assert refused(at) == []


def test_of_a_flood_of_one_account_some_are_said_and_how_many_more() -> None:
    clock, said = VirtualClock(1), list[Notice]()
    presses = RefusedPresses(said.append, clock)
    for _ in range(100):
        presses.note("arm", Code.ROLE, "vera", Place.PANEL)
    presses.note("arm", Code.NO_HAND, "anna", Place.PANEL)
    assert [one.account for one in said] == ["vera"] * int(AT_ONCE) + ["anna"]
    clock.advance_ns(round(1e9 / PER_S))
    presses.note("arm", Code.ROLE, "vera", Place.PANEL)
    assert (said[-1].account, said[-1].more) == ("vera", 100 - AT_ONCE)


def test_the_end_of_a_flood_is_said_without_another_press() -> None:
    clock, said = VirtualClock(1), list[Notice]()
    presses = RefusedPresses(said.append, clock)
    for _ in range(100):
        presses.note("arm", Code.ROLE, "vera", Place.PANEL)
    presses.tend()
    assert len(said) == AT_ONCE
    clock.advance_ns(round(1e9 / PER_S))
    presses.tend()
    assert len(said) == AT_ONCE + 1
    assert (said[-1].account, said[-1].code, said[-1].more) == ("vera", Code.ROLE, 99 - AT_ONCE)
    clock.advance_ns(100 * round(1e9 / PER_S))
    presses.tend()
    assert len(said) == AT_ONCE + 1


def test_a_screen_says_it_with_its_frames_and_at_its_end(at: Pressed) -> None:
    browser = armed(at)
    for _ in range(15):
        browser.act("arm", frame=at.frame + 5)
    assert len(refused(at)) == AT_ONCE
    later(at, round(1e9 / PER_S))
    assert [one.more for one in refused(at)[int(AT_ONCE) :]] == [4]
    for _ in range(3):
        browser.act("arm", frame=at.frame + 5)
    at.hand.close()
    assert [one.more for one in refused(at)[int(AT_ONCE) :]] == [4, 2]
