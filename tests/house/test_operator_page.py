"""The operator's page holds every state and every alarm that the service can show."""

from aff_runtime.base.events import TABLE, Reaction
from aff_runtime.base.signals import State
from tests.each_case import each_case
from tests.house.documents import ROOT, text

PAGE = text(ROOT / "docs" / "operator.md")
DOES = {
    Reaction.NOTE: "note",
    Reaction.HOLD: "hold",
    Reaction.FADE: "fade",
    Reaction.FADE_AND_LATCH: "latch",
}
ALARMS = [event for event in TABLE if event.code != 0]


@each_case("event", ALARMS, ids=lambda e: e.name)
def test_every_alarm_has_its_row(event):
    cells = (str(event.code), event.name, DOES[event.reaction], event.text, event.action)
    assert f"| {' | '.join(cells)} |" in PAGE


@each_case("state", list(State), ids=lambda s: s.name)
def test_every_state_has_its_row(state):
    assert f"\n| {state.name} | " in PAGE
