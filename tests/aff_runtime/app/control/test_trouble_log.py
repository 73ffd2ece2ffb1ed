"""What the wire knows of itself is said once it stands, and once more when it is over."""

from __future__ import annotations

import pytest

from aff_runtime.app.control.trouble_log import EVERY_TICKS, TroubleLog
from aff_runtime.base.signals import Outcome


class Wire:
    """A gateway of which only the troubles matter."""

    def __init__(self) -> None:
        self.troubles: tuple[str, ...] = ()


def looks(log: TroubleLog, count: int) -> None:
    for tick in range(1, count * EVERY_TICKS + 1):
        log.look(tick)


def test_a_trouble_that_stands_is_said_once_and_its_end_too() -> None:
    wire, said, shown = Wire(), [], []
    log = TroubleLog(wire, tuple, said.append, shown.append)  # type: ignore[arg-type]
    looks(log, 3)
    assert said == shown == []
    wire.troubles = ("unwind_drive (node 3): EMCY 0x3210",)
    looks(log, 5)
    assert said == ["wire: unwind_drive (node 3): EMCY 0x3210"]
    wire.troubles = ()
    looks(log, 5)
    assert said[1:] == ["wire: no trouble any more"]
    assert shown == [("unwind_drive (node 3): EMCY 0x3210",), ()]


def test_a_radius_that_the_law_does_not_take_stands_beside_the_wire_s_troubles() -> None:
    wire, said, shown, notes = Wire(), [], [], ["unwind: radius is above"]
    log = TroubleLog(wire, lambda: tuple(notes), said.append, shown.append)  # type: ignore[arg-type]
    wire.troubles = ("closed by the other side",)
    looks(log, 3)
    assert shown == [("closed by the other side", "unwind: radius is above")]
    wire.troubles = ()
    looks(log, 3)
    assert shown[1:] == [("unwind: radius is above",)]
    notes.clear()
    looks(log, 3)
    assert shown[2:] == [()]


def test_a_lost_plc_is_told_with_what_came_first_though_the_wire_works_again() -> None:
    wire, said = Wire(), []
    log = TroubleLog(wire, tuple, said.append)  # type: ignore[arg-type]
    for fresh, trouble in (
        (False, "an older one"),
        (True, ""),
        (False, "closed by the other side"),
        (False, "no connection within 0.05 s"),
        (False, ""),  # connected anew, and not heard twice yet
    ):
        wire.troubles = (trouble,) if trouble else ()
        log.follow(Outcome.OK if fresh else Outcome.NOT_CONNECTED, fresh=fresh, latched=False)
    log.stale()
    assert said == ["PLC_STALE began with: closed by the other side"]


@pytest.mark.parametrize(
    ("outcome", "went"),
    [
        (Outcome.OK, "its heartbeat did not move"),
        # each reply a tick too late: it is asked anew, and the connection stays
        (Outcome.TIMEOUT, "nothing new came in time"),
        # as of a counter that went backwards
        (Outcome.BAD_REPLY, "its replies or heartbeats were not to be believed"),
    ],
)
def test_a_wire_without_trouble_is_told_by_what_its_ticks_were(
    outcome: Outcome, went: str
) -> None:
    wire, said = Wire(), []
    log = TroubleLog(wire, tuple, said.append)  # type: ignore[arg-type]
    for before in (Outcome.TIMEOUT, Outcome.TIMEOUT, Outcome.BAD_REPLY, Outcome.BAD_REPLY):
        log.follow(before, fresh=False, latched=False)
    log.follow(Outcome.OK, fresh=True, latched=False)
    for ended in (Outcome.OK, outcome, outcome):
        log.follow(ended, fresh=False, latched=False)
    log.stale()
    assert said == [f"PLC_STALE began with: no trouble of the wire: {went}"]


def test_what_the_loss_began_with_is_shown_until_the_alarm_is_over() -> None:
    wire, shown = Wire(), []
    log = TroubleLog(wire, tuple, lambda _: None, shown.append)  # type: ignore[arg-type]
    wire.troubles = ("closed by the other side",)
    log.follow(Outcome.NOT_CONNECTED, fresh=False, latched=False)
    log.stale()
    began = "PLC_STALE began with: closed by the other side"
    assert shown == [(began,)]
    wire.troubles = ("no connection within 0.05 s",)
    looks(log, 2)
    assert shown[1:] == [("no connection within 0.05 s", began)]
    wire.troubles = ()
    log.follow(Outcome.OK, fresh=True, latched=True)
    looks(log, 2)
    assert shown[2:] == [(began,)]
    log.follow(Outcome.OK, fresh=True, latched=False)
    assert shown[3:] == [()]


def test_a_trouble_of_a_moment_is_not_said() -> None:
    wire, said = Wire(), []
    log = TroubleLog(wire, tuple, said.append)  # type: ignore[arg-type]
    wire.troubles = ("unwind_drive (node 3): is being configured",)
    looks(log, 1)
    wire.troubles = ()
    looks(log, 4)
    assert said == []
