"""How the service stands is said of a fresh tick; of an old one its age is said, and no state."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from aff_runtime.app.hand.may import Action, Code, Role, against_settings
from aff_runtime.app.report.status import headline
from aff_runtime.app.report.status_answer import NOT_SAID, StatusAnswer, read_answer
from aff_runtime.app.supervisor.hand.opening import ServiceEnd
from aff_runtime.base.signals import State
from aff_runtime.cli.status import is_alarm, lines
from tests.aff_runtime.app.supervisor.whole import Whole


@pytest.fixture
def whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Whole]:
    found = Whole(tmp_path, monkeypatch, hand=Role.COMMISSION)
    yield found
    found.stop()


def status(whole: Whole) -> StatusAnswer:
    """Return the answer as a caller reads it."""
    said = whole.service._standing.status()
    return read_answer(json.loads(json.dumps(said.to_json())))


def test_before_the_first_tick_it_starts(whole: Whole) -> None:
    answer = status(whole)
    assert (answer.state, answer.live, answer.tick_age_s) == ("STARTING", None, NOT_SAID)


@pytest.mark.parametrize(("age_s", "is_fresh"), [(0.1, True), (0.69, True), (0.71, False)])
def test_the_state_of_a_tick_that_is_old_is_not_known(
    whole: Whole, age_s: float, is_fresh: bool
) -> None:
    whole.clock.advance_ns(40 * 10**9)
    whole.tick(State.ACTIVE, tick=8000.0)
    whole.clock.advance_ns(round(age_s * 1e9))
    answer = status(whole)
    assert answer.live is not None
    assert answer.tick_age_s == age_s
    assert (answer.state, answer.live.comm) == (("ACTIVE", "OK") if is_fresh else ("SILENT",) * 2)
    assert is_alarm(answer) is not is_fresh
    assert (f"no tick for {age_s:.1f} s" in headline(answer)) is not is_fresh
    assert any("ACTIVE" in line for line in lines(answer)) is is_fresh

    known = State.ACTIVE if is_fresh else None
    end = ServiceEnd(whole.children, whole.service._pending, whole.probes)
    assert (end.now().state, end.now().tick) == (known, 8000)
    stands = whole.service._circumstances()
    assert stands.state is known
    codes = {reason.code for reason in against_settings(Action.TRY, stands)}
    assert (Code.SILENT in codes) is not is_fresh


def test_a_control_process_that_goes_on_is_believed_again(whole: Whole) -> None:
    whole.tick(State.ACTIVE)
    whole.clock.advance_ns(10**9)
    assert status(whole).state == "SILENT"
    whole.tick(State.READY)
    assert status(whole).state == "READY"
