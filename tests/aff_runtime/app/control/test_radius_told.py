"""What reaches the supervisor in words: a radius outside the range of the site, a lost PLC."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from aff_runtime.app.control.trouble_log import EVERY_TICKS
from aff_runtime.app.link.messages import LogLine, WireTroubles
from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import Outcome, Permission, Snapshot
from tests.aff_runtime.app.control.test_late_questions import Ends
from tests.parameter_records import EUCLID

RADIUS = "unwind_radius_m"  # 4 in to 12 in: 0.1016 m to 0.3048 m


@pytest.fixture
def ends() -> Iterator[Ends]:
    found = Ends()
    yield found
    found.close()


def read(ends: Ends, tick: int, radius_m: float) -> list[tuple[str, ...]]:
    """Have the law read a radius, and the control process look twice; return what it tells."""
    values = [radius_m if name == RADIUS else 1.0 for name in EUCLID.gateway.read.channels]
    snapshot = Snapshot(
        tick=tick,
        t_ns=0,
        outcome=Outcome.OK,
        fresh=True,
        age_s=0.0,
        plc_heartbeat=tick,
        status=0,
        roll_id=1,
        values=tuple(values),
    )
    closed = Permission(adapt=False, applied_ratio=(0.0, 0.0), limit_ratio=(1.0, 1.0))
    ends.outside._law.step(snapshot, EUCLID.cycle_s, closed)
    for later in (1, 2):
        ends.outside._troubles.look((tick + later) * EVERY_TICKS)
    return [said.troubles for said in ends.heard() if isinstance(said, WireTroubles)]


def test_it_is_told_once_and_its_end_too(ends: Ends) -> None:
    assert read(ends, 1, 0.2) == []
    ((said,),) = read(ends, 4, 0.31)
    assert f"unwind: {RADIUS} is above radius_max_m 0.3048 m: not taken" in said
    assert "0.2 m, stays" in said
    assert read(ends, 7, 0.33) == []
    ((said,),) = read(ends, 10, 0.10)
    assert "below radius_min_m 0.1016 m" in said
    assert read(ends, 13, 0.15) == [()]


def test_a_lost_plc_reaches_the_log_with_the_event(ends: Ends) -> None:
    ends.outside.event(7, 0, BY_NAME["PLC_STALE"].code)
    (said,) = (one.text for one in ends.heard() if isinstance(one, LogLine))
    assert said.startswith("PLC_STALE began with: ")
