"""The operator's page holds every state and alarm that the service and its screen can show."""

from aff_hmi.view import GONE, WORDS
from aff_runtime.app.report.status_answer import SILENT
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
def test_every_state_has_its_row_with_the_word_of_the_screen(state):
    assert f"\n| {state.name} | {WORDS[state.name]} | " in PAGE


def test_what_stands_for_a_state_where_no_tick_says_it_has_its_row():
    unknown = WORDS[GONE]
    said = {**WORDS, SILENT: f"{unknown}, was ...", unknown: unknown}
    del said[GONE]
    for name, word in said.items():
        assert f"\n| {name} | {word} | " in PAGE
