"""Whatever becomes of a probe's result, the probe ends, and who asked for it is answered once."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from aff_runtime.app.link.answers import Done, ProbeDone
from aff_runtime.app.link.messages import MeasureResponse, Probed
from aff_runtime.app.link.replies import ProbeResult, Reply
from aff_runtime.app.supervisor.probe_desk import FIT_PATIENCE_S, NOT_HEARD
from aff_runtime.base.signals import State
from tests.aff_runtime.app.supervisor.whole import Whole
from tests.security.learned_files import learned, response

DURATION_S = 40.0
MEASURED = Probed(
    results=(
        ProbeResult(actuator="unwind", sign=1, remarks=(), delay_s=0.03, text=response("unwind")),
    )
)


class Probing:
    """A service whose probe has begun, and what was told to who asked for it."""

    def __init__(self, whole: Whole) -> None:
        self.whole = whole
        self.told: list[Done | ProbeDone] = []
        self.begin()

    def begin(self) -> None:
        self.whole.probes.begin(["unwind"], self.told.append)
        asked = self.whole.control.sent[-1]
        assert isinstance(asked, MeasureResponse)
        self.whole.control.says = [Reply(id=asked.id, ok=True, duration_s=DURATION_S)]
        self.whole.round()
        assert self.whole.probes.is_under_way

    @property
    def is_kept(self) -> bool:
        return learned(self.whole.site).exists()


@pytest.fixture
def probing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Probing]:
    found = Probing(Whole(tmp_path, monkeypatch))
    yield found
    found.whole.stop()


def test_a_probe_whose_result_is_lost_ends_and_another_one_may_begin(probing: Probing) -> None:
    probing.whole.wait(DURATION_S + FIT_PATIENCE_S - 0.01)
    assert probing.whole.probes.is_under_way
    assert probing.told == []
    probing.whole.wait(0.01)
    assert not probing.whole.probes.is_under_way
    assert [(one.ok, one.message) for one in probing.told] == [(False, NOT_HEARD)]  # type: ignore[union-attr]
    assert probing.whole.probes.said == NOT_HEARD
    probing.whole.control.says = [MEASURED]
    probing.whole.round()
    assert not probing.is_kept
    probing.begin()


def test_what_was_measured_is_kept_though_the_control_process_is_exchanged(
    probing: Probing,
) -> None:
    """The fit says its result over a link that nobody reads any more but who drains it."""
    probing.whole.control.last_words = lambda: [MEASURED]
    former = probing.whole.control
    probing.whole.service._edits.restart_on(probing.whole.children.parameters)
    assert probing.whole.control is not former
    assert learned(probing.whole.site).read_text() == response("unwind") + "\n"
    probing.whole.round()
    exchange = probing.whole.control.sent[-1]  # the new one is told of the response
    assert set(exchange.record.learned) == {"unwind"}
    assert probing.told == []
    probing.whole.control.says = [Reply(id=exchange.id, ok=True)]
    probing.whole.round()
    assert [one.ok for one in probing.told] == [True]
    assert not probing.whole.probes.is_under_way


def test_an_edit_that_waits_for_bypass_waits_for_what_was_measured(probing: Probing) -> None:
    """A probe of an output that is not armed ends in bypass; its fit takes a moment longer."""
    whole, former = probing.whole, probing.whole.control
    whole.tick(State.ACTIVE)
    text = whole.site.read_text()
    whole.site.write_text(text.replace("cycle_ms: 5", "cycle_ms: 10", 1))
    whole.service._edits.look_again()
    whole.round()
    assert whole.service._edits.waiting
    whole.tick(State.BYPASS)
    whole.wait(0.1)
    assert whole.control is former
    former.says = [MEASURED]
    whole.round()
    assert whole.control is not former
    assert whole.children.parameters.site.cycle_s == 0.01
    assert set(whole.children.parameters.learned) == {"unwind"}
    assert [one.ok for one in probing.told] == [True]


def test_a_probe_ends_with_the_control_process_that_measured(probing: Probing) -> None:
    probing.whole.service._edits.restart_on(probing.whole.children.parameters)
    assert not probing.whole.probes.is_under_way
    assert [one.ok for one in probing.told] == [False]
    assert probing.whole.probes.said == "the control process starts anew"
    probing.begin()


def test_a_death_is_told_as_one(probing: Probing) -> None:
    probing.whole.control.how_it_ended = "killed by SIGKILL"
    probing.whole.round()
    assert probing.whole.probes.said == "the control process died"
    assert len(probing.told) == 1


@pytest.mark.parametrize("was_fitted", [True, False])
def test_a_service_that_stops_keeps_what_was_measured_meanwhile(
    probing: Probing, was_fitted: bool
) -> None:
    probing.whole.control.last_words = lambda: [MEASURED] if was_fitted else []
    probing.whole.stop()
    assert probing.is_kept is was_fitted
    assert [one.ok for one in probing.told] == [was_fitted]
    assert probing.whole.probes.said == ("measured" if was_fitted else "the service stops")
