"""The screen's way to the service, on a real socket: answers find their press, silence is told."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Awaitable, Callable, Iterator
from pathlib import Path

import pytest

from aff_hmi import press_desk
from aff_hmi.press_desk import CLOSE_LOOK_NS, CLOSE_NS, MOST_HELD, RETRY_NS, PressDesk
from aff_runtime.app.hand.may import Action, Place, Role
from aff_runtime.app.hand.messages import Answer, Notice
from aff_runtime.base.errors import WireError
from tests.aff_runtime.app.supervisor.hand.stand import Stand
from tests.doubles.virtual_clock import VirtualClock


@pytest.fixture
def stand(tmp_path: Path) -> Iterator[Stand]:
    with contextlib.closing(Stand(tmp_path)) as found:
        yield found


def play(desk: PressDesk, stand: Stand | None, deed: Callable[[], Awaitable[object]]) -> object:
    """Do something while service and desk have their turns."""

    async def both() -> object:
        task = asyncio.ensure_future(deed())
        while not task.done():
            await asyncio.sleep(0)
            if stand is not None:
                stand.round()
                if stand.service.asked:
                    stand.service.answer()
            desk.poll()
        return task.result()

    return asyncio.run(both())


def test_a_press_is_answered_and_the_rules_are_known(stand: Stand) -> None:
    desk = PressDesk(stand.path, VirtualClock(1))
    command = stand.command()
    answer = play(desk, stand, lambda: desk.press(command))
    assert answer == Answer(id=command.id, ok=True, audit=2)
    assert desk.rules is not None
    assert (desk.rules.ceiling, desk.rules.arms_from) == (Role.OPERATE, Place.PANEL)
    play(desk, stand, lambda: desk.press(stand.command(Action.BYPASS)))
    assert stand.service.bypassed == 1
    desk.notice(Notice(what="logout", account="anna", place=Place.PANEL))
    stand.round()
    assert stand.rows()[-1]["what"] == "logout"
    desk.close()


def test_an_answer_waits_for_no_poll(stand: Stand) -> None:
    desk = PressDesk(stand.path, VirtualClock(1))

    async def press() -> Answer:
        asking = asyncio.ensure_future(desk.press(stand.command()))
        while not asking.done():
            await asyncio.sleep(0)
            stand.round()
            if stand.service.asked:
                stand.service.answer()
        return asking.result()

    assert asyncio.run(press()).ok
    desk.close()


def test_two_presses_at_once_get_each_its_own_answer(stand: Stand) -> None:
    desk = PressDesk(stand.path, VirtualClock(1))
    good, late = stand.command(), stand.command(valid_until_ns=0)

    async def both() -> list[Answer]:
        return list(await asyncio.gather(desk.press(good), desk.press(late)))

    first, second = play(desk, stand, both)  # type: ignore[misc]
    assert (first.id, first.ok) == (good.id, True)
    assert (second.id, second.ok) == (late.id, False)
    desk.close()


def test_without_a_service_a_press_fails_at_once_and_later_ones_find_it(tmp_path: Path) -> None:
    clock = VirtualClock(1)
    desk = PressDesk(tmp_path / "run" / "hand.sock", clock)
    with contextlib.closing(Stand(tmp_path)) as stand:
        stand.path.rename(stand.path.with_name("gone"))
        with pytest.raises(WireError, match="no service hears this screen"):
            play(desk, None, lambda: desk.press(stand.command()))
        assert desk.rules is None
        stand.path.with_name("gone").rename(stand.path)
        bypass = stand.command(Action.BYPASS)
        assert play(desk, stand, lambda: desk.press(bypass))  # it does not wait to try again
    clock.advance_ns(RETRY_NS + 1)
    desk.poll()
    assert desk.rules is None
    assert "hung up" in desk.trouble
    desk.close()


def test_a_service_that_says_nothing_is_not_waited_for_without_end(
    stand: Stand, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(press_desk, "PATIENCE_S", 0.01)
    desk = PressDesk(stand.path, VirtualClock(1))
    with pytest.raises(WireError, match="does not answer"):
        play(desk, None, lambda: desk.press(stand.command()))
    assert not desk._waiting
    desk.close()


def test_who_waits_is_told_when_the_service_hangs_up(tmp_path: Path) -> None:
    stand = Stand(tmp_path)
    desk = PressDesk(stand.path, VirtualClock(1))

    async def cut() -> None:
        press = asyncio.ensure_future(desk.press(stand.command()))
        await asyncio.sleep(0)
        stand.close()
        desk.poll()
        await press

    with pytest.raises(WireError, match=r"hung up|reset"):
        asyncio.run(cut())
    desk.close()


def heard(stand: Stand) -> list[tuple[str, str]]:
    return [(row["account"], row["why"]) for row in stand.rows()]


def test_what_is_noted_while_nobody_hears_waits_and_says_how_long(tmp_path: Path) -> None:
    clock = VirtualClock(1)
    desk = PressDesk(tmp_path / "run" / "hand.sock", clock)
    desk.poll()
    for name in ("anna", "bert"):
        desk.notice(Notice(what="hand taken", account=name, place=Place.PANEL))
        clock.advance_ns(300 * 10**9)
    with contextlib.closing(Stand(tmp_path)) as stand:
        desk.poll()
        stand.round()
        assert stand.rows() == []  # the service has not let us in yet
        desk.poll()
        stand.round()
        assert heard(stand) == [
            ("anna", "600 s before this line"),
            ("bert", "300 s before this line"),
        ]
        desk.notice(Notice(what="hand released", account="bert", place=Place.PANEL))
        stand.round()
        assert heard(stand)[2:] == [("bert", "")]
    desk.close()


def test_of_more_than_can_wait_the_newest_are_said_and_how_many_are_not(tmp_path: Path) -> None:
    clock = VirtualClock(1)
    desk = PressDesk(tmp_path / "run" / "hand.sock", clock)
    for n in range(MOST_HELD + 9):
        desk.notice(Notice(what="hand taken", account=f"n{n}", place=Place.PANEL))
    with contextlib.closing(Stand(tmp_path)) as stand:
        for _ in range(8):
            clock.advance_ns(RETRY_NS)
            stand.clock.advance_ns(RETRY_NS)
            desk.poll()
            stand.round()
        rows = heard(stand)
        assert [name for name, _ in rows] == [f"n{n}" for n in range(9, MOST_HELD + 9)]
        assert [why.partition(";")[0] for _, why in rows[:2]] == [
            "9 before it were not said",
            "1 s before this line",
        ]
    desk.close()


def test_a_flood_of_notices_does_not_have_the_screen_sent_away(stand: Stand) -> None:
    clock = VirtualClock(1)
    desk = PressDesk(stand.path, clock)
    for _ in range(2):
        desk.poll()
        stand.round()
    for _ in range(500):
        desk.notice(Notice(what="hand taken", account="anna", place=Place.PANEL))
        stand.round()
    desk.poll()
    assert desk.rules is not None
    answer = play(desk, stand, lambda: desk.press(stand.command(Action.BYPASS)))
    assert answer.ok  # type: ignore[attr-defined]
    desk.close()


class Turning(VirtualClock):
    """A clock during whose sleep a service has its turn."""

    def __init__(self, stand: Stand) -> None:
        super().__init__(1)
        self.stand = stand

    def sleep_until_ns(self, deadline_ns: int) -> None:
        self.stand.clock.advance_ns(deadline_ns - self.now_ns())
        super().sleep_until_ns(deadline_ns)
        self.stand.round()


def test_what_waits_when_the_screen_ends_is_said_before_it_leaves(stand: Stand) -> None:
    clock = Turning(stand)
    desk = PressDesk(stand.path, clock)
    for n in range(MOST_HELD):  # more than the pace lets through at once
        desk.notice(Notice(what="hand taken", account=f"n{n}", place=Place.PANEL))
    desk.close()
    stand.round()
    assert [name for name, _ in heard(stand)] == [f"n{n}" for n in range(MOST_HELD)]
    assert clock.now_ns() < CLOSE_NS


def test_what_no_service_hears_is_in_the_screens_log(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    clock = VirtualClock(1)
    desk = PressDesk(tmp_path / "run" / "hand.sock", clock)
    desk.notice(Notice(what="hand taken over", account="bert", place=Place.PANEL, other="anna"))
    clock.advance_ns(7 * 10**9)
    before_ns = clock.now_ns()
    desk.close()
    (line,) = caplog.messages
    assert line.endswith('hand taken over; from anna by "bert", panel, 7 s ago')
    assert clock.now_ns() == before_ns  # nobody is there to be waited for


def test_a_service_that_lets_nobody_in_is_waited_for_in_vain_but_not_for_ever(
    stand: Stand, caplog: pytest.LogCaptureFixture
) -> None:
    clock = VirtualClock(1)
    desk = PressDesk(stand.path, clock)
    desk.notice(Notice(what="logout", account="anna", place=Place.PANEL))
    desk.close()
    assert 0 <= clock.now_ns() - CLOSE_NS < 2 * CLOSE_LOOK_NS
    assert 'logout by "anna", panel, 2 s ago' in caplog.text
