"""What an operator and an engineer do to a running service, judged at the plant.

In virtual time the same holds quickly: ``tests/lockstep/test_operator.py``; on a real wire bypass
and edits are in ``tests/aff_runtime/app/test_service.py``.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import pytest

from tests.hil.live_line import LiveLine, Rows
from tests.lockstep.fault_table import ZERO_WITHIN_S, assert_never_above_limit, peak
from tests.processes import until

pytestmark = [pytest.mark.long, pytest.mark.hil, pytest.mark.wire, pytest.mark.timeout(90)]

ATTEMPTS = 4
TURN_S = 1.26  # of the unwind roll at 200 FPM: the correction repeats
RUBBISH = "version: 1\nline: [this, is: not\n\ta site file"


def _fault(line: LiveLine) -> None:
    line.at_plant("fault freeze:0.3")
    until("FAULT", lambda: line.state == "FAULT")


def _off(line: LiveLine) -> None:
    line.at_plant("set WEB_INTACT 0")
    until("OFF", lambda: line.state == "OFF")


def _ready(line: LiveLine) -> None:
    line.ask("shadow", on=True)
    until("SHADOW", lambda: line.state == "SHADOW")
    line.ask("shadow", on=False)
    until("READY", lambda: line.state == "READY")


def _shadow(line: LiveLine) -> None:
    line.ask("shadow", on=True)
    until("SHADOW", lambda: line.state == "SHADOW")


def _bypass(line: LiveLine) -> None:
    line.ask("bypass")
    until("BYPASS", lambda: line.state == "BYPASS")


def _fading(line: LiveLine) -> None:
    line.at_plant("set LINE_RUN 0")  # bypass follows within the 150 ms of the fade


def _armed(line: LiveLine) -> None:
    line.edit(line.site_text.replace("active_above_m_s: 0.1", "active_above_m_s: 5"))
    until("ARMED", lambda: line.state == "ARMED")


def _active(line: LiveLine) -> None:
    until("ACTIVE", line.is_working)


WAYS = {
    "FAULT": _fault,
    "OFF": _off,
    "READY": _ready,
    "ARMED": _armed,
    "ACTIVE": _active,
    "FADING": _fading,
    "BYPASS": _bypass,
    "SHADOW": _shadow,
}


@pytest.fixture
def put_back(line: LiveLine):
    """Undo what the ways into the states have done."""
    yield line
    line.at_plant("set WEB_INTACT 1")
    line.at_plant("set LINE_RUN 1")
    line.ask("shadow", on=False)
    if line.bench.site.read_text() != line.site_text:
        old = line.status()["config_hash"]
        line.edit(line.site_text)
        until("the old settings", lambda: line.status()["config_hash"] != old)


@pytest.mark.parametrize("state", WAYS)
def test_bypass_works_in_every_state(put_back: LiveLine, state: str):
    line = put_back
    WAYS[state](line)
    line.ask("bypass")
    pressed_s = line.now_s()
    until("BYPASS", lambda: line.state == "BYPASS")
    line.at_plant("set WEB_INTACT 1")
    line.at_plant("set LINE_RUN 1")
    line.wait_plant(pressed_s + ZERO_WITHIN_S + 0.3)
    rows = line.since(pressed_s - 0.1)
    assert peak(rows, pressed_s + ZERO_WITHIN_S, rows[-1][0]) == 0.0
    assert line.state == "BYPASS"


def _undisturbed(
    line: LiveLine, work: Callable[[], tuple[float, float]], is_smooth: Callable[[Rows], bool]
) -> Rows:
    """Do ``work``, which returns a span of plant time in which the guard stayed ACTIVE.

    It is done again where a step is seen and the machine held up plant or service meanwhile, for
    that steps what the plant sees: a bump is there each time.
    """
    seen: Rows = []
    for _ in range(ATTEMPTS):
        line.ensure_active()
        pauses = line.pauses()
        line.wait_plant(line.now_s() + TURN_S + 0.3)
        start_s, end_s = work()
        rows = [row for row in line.since(start_s) if row[0] <= end_s]
        if line.state != "ACTIVE":
            assert line.alarm in ("PLC_STALE", "OVERRUN"), line.alarm  # the machine paused
            continue
        seen = rows
        if is_smooth(rows) or line.pauses() == pauses:
            break
    assert seen, f"never undisturbed: {line.status()}"
    return seen


def _steepest(rows: Rows, start_s: float, end_s: float) -> float:
    """Largest rate of any correction, m/s2, each change spread over the time its old value stood.

    A pause of the machine holds a value and then steps by what the sine moved meanwhile: the rate
    of the sine. A bump steps between two ticks.
    """
    span = [(t, values) for t, values in rows if start_s <= t <= end_s]
    steepest = 0.0
    for column in zip(*(values for _, values in span), strict=True):
        changes = [
            (t, value)
            for (t, _), old, value in zip(span[1:], column, column[1:], strict=False)
            if value != old
        ]
        for (since_s, held), (t, value) in pairwise(changes):
            steepest = max(steepest, abs(value - held) / (t - since_s))
    return steepest


def _is_smooth_from(rows: Rows, at_s: float) -> bool:
    """Return whether nothing is much steeper from ``at_s`` on than it was before."""
    return _steepest(rows, at_s, rows[-1][0]) < 3.0 * _steepest(rows, rows[0][0], at_s)


def _is_smooth_in_the_middle(rows: Rows) -> bool:
    return _is_smooth_from(rows, 0.5 * (rows[0][0] + rows[-1][0]))


def _is_smooth_after_a_turn(rows: Rows) -> bool:
    return _is_smooth_from(rows, rows[0][0] + TURN_S)


def test_rubbish_in_the_site_file_changes_nothing(line: LiveLine):
    config = line.status()["config_hash"]

    def spoil() -> tuple[float, float]:
        start_s = line.now_s() - TURN_S
        line.edit(line.site_text)
        until("no difference", lambda: not line.status()["config_differs"])
        line.edit(RUBBISH)
        until("CONFIG_DIFFERS", lambda: bool(line.status()["config_differs"]))
        line.wait_plant(line.now_s() + TURN_S)
        return start_s, line.now_s()

    try:
        rows = _undisturbed(line, spoil, _is_smooth_in_the_middle)
        status = line.status()
        assert status["config_hash"] == config
        assert f"{line.bench.site.name}:" in status["config_differs"][0]
        assert _is_smooth_in_the_middle(rows)
    finally:
        line.edit(line.site_text)
    until("no difference", lambda: not line.status()["config_differs"])
    assert line.status()["config_hash"] == config


def test_a_good_edit_is_applied_without_a_bump(line: LiveLine):
    gentle = line.site_text.replace("settle_s: 6", "settle_s: 9")
    texts = [gentle, line.site_text]

    def retune() -> tuple[float, float]:
        start_s, old = line.now_s() - TURN_S, line.status()["config_hash"]
        texts.reverse()
        line.edit(texts[0] if line.bench.site.read_text() != texts[0] else texts[1])
        until("the new settings", lambda: line.status()["config_hash"] != old)
        line.wait_plant(line.now_s() + TURN_S)
        return start_s, line.now_s()

    rows = _undisturbed(line, retune, _is_smooth_after_a_turn)
    assert not line.status()["config_differs"]
    assert _is_smooth_after_a_turn(rows)
    quiet = [t for t, values in rows if all(abs(v) < 1e-4 for v in values)]
    assert len(quiet) < 0.1 * len(rows)  # it never faded
    assert_never_above_limit(rows)


def test_nothing_but_the_write_block_is_ever_written(line: LiveLine):
    counts = line.at_plant("status")["counts"]
    assert counts["writes"] > 1000
    assert counts["foreign_writes"] == 0
    assert counts["foreign_reads"] == 0
