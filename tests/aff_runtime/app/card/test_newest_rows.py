"""The newest rows of a step whose event happens once begin after settings were changed last."""

from types import SimpleNamespace

import pytest

from aff_runtime.app.card.gather import AFTER_CHANGE_S, MARGIN_S, wanted_windows
from aff_runtime.app.card.steps import STEPS, step_of
from aff_runtime.base.runs.table import last_event_s

EVENTS = (
    "time_s,tick,code,name,argument,text\n"
    '0.5,100,,SETTINGS,,"3f9a started by uid 0"\n'
    '33.4,6680,,EDIT,,"unwind: response none -> 1"\n'
    '40.1,8020,,PROBE,,"unwind"\n'
    ",,,EDIT,,of no time\n"
)


@pytest.fixture
def answer(tmp_path):
    (tmp_path / "events.csv").write_text(EVENTS)
    tick = SimpleNamespace(time_s=300.0)
    return SimpleNamespace(
        live=SimpleNamespace(tick=tick), recorder=SimpleNamespace(folder=str(tmp_path))
    )


@pytest.mark.parametrize(
    ("number", "from_s"), [(12, 33.4 + AFTER_CHANGE_S), (0, 300.0 - MARGIN_S - 61.0)]
)
def test_a_proof_begins_after_the_last_change_and_a_minute_is_a_minute(answer, number, from_s):
    (window,) = wanted_windows(step_of(number), SimpleNamespace(windows=(), answer=answer))
    assert window.from_s == pytest.approx(from_s)
    assert window.to_s == 300.0 - MARGIN_S


def test_only_what_happens_once_is_looked_for_from_there_on():
    assert [one.number for one in STEPS if one.begins_anew] == [5, 8, 10, 11, 12]


@pytest.mark.parametrize("number", [5, 11])
def test_a_plug_or_a_trip_soon_after_a_change_of_settings_is_looked_for_behind_it(answer, number):
    answer.live.tick.time_s = 60.0
    (window,) = wanted_windows(step_of(number), SimpleNamespace(windows=(), answer=answer))
    assert window.from_s == pytest.approx(33.4 + AFTER_CHANGE_S)


def test_an_event_without_a_time_and_a_file_without_events_are_no_moment(tmp_path, answer):
    assert last_event_s(tmp_path, lambda row: row["name"] == "EDIT") == 33.4
    assert last_event_s(tmp_path, lambda row: row["name"] == "FORGET") == 0.0
