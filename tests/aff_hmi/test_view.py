"""What the overview says of a moment."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product

import pytest

from aff_hmi.layout import Layout, label_of, layout_of
from aff_hmi.notices import FACTS_OLD_S, conditions_of, notices_of
from aff_hmi.reason import reason_of
from aff_hmi.view import View, view_of
from aff_hmi.watch import Observed
from aff_hmi.words import say_in
from aff_runtime.app.report.alarm_table import PRIORITIES
from aff_runtime.app.report.line_facts import RollFacts
from aff_runtime.app.report.status import headline, live_status
from aff_runtime.app.report.status_answer import StatusAnswer
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.events import BY_NAME, TABLE, Event
from aff_runtime.base.signals import State
from aff_runtime.core.monitor import OrderState
from aff_runtime.core.phase import Source
from aff_runtime.telemetry.recorder_messages import RecorderReport
from tests.aff_hmi.moments import LINE, facts, row, seen
from tests.each_case import each_case
from tests.parameter_records import EUCLID

SAY = say_in("en")


def layout(moment: Observed) -> Layout:
    assert moment.row is not None
    return layout_of(moment.facts, tuple(c.name for c in moment.row.channels))


def shown(moment: Observed) -> View:
    return view_of(moment, layout(seen()), SAY)


def test_ripple_is_the_rms_of_the_followed_orders_now_and_without() -> None:
    values = shown(seen()).values
    assert values["without:unwind"] == pytest.approx(math.sqrt((9 + 16) / 2), rel=1e-5)
    assert values["now:unwind"] == pytest.approx(0.01 * math.sqrt((9 + 16) / 2), rel=1e-5)
    assert values["reduction:unwind"] == pytest.approx(-40.0)


def test_two_orders_of_one_frequency_are_one_ripple() -> None:
    turn = {"unwind.omega_rad_s": 6.0, "swrap.omega_rad_s": 6.1}
    names = ("shape_mm", "state", "ripple_before", "ripple")
    other = {f"unwind.swrap_2x.{name}": row()[f"unwind.unwind_2x.{name}"] for name in names}
    apart = {"unwind.omega_rad_s": 6.0, "swrap.omega_rad_s": 9.0}
    one = shown(seen(row(**turn, **other))).values
    two = shown(seen(row(**apart, **other))).values
    assert one["without:unwind"] == pytest.approx(math.sqrt((9 + 16) / 2), rel=1e-5)
    assert two["without:unwind"] == pytest.approx(math.sqrt((9 + 16 + 16) / 2), rel=1e-5)


@each_case("state", [State.READY, State.BYPASS, State.FAULT, State.OFF, State.ARMED])
def test_without_is_not_claimed_while_nothing_goes_out(state: State) -> None:
    view = shown(seen(row(state)))
    assert "without:unwind" not in view.values
    assert view.notes["without:unwind"] == "nothing goes out: this is the ripple without AFF"


def test_without_is_not_claimed_during_a_probe_which_is_said() -> None:
    view = shown(seen(facts=facts(probing=True)))
    assert "without:unwind" not in view.values
    assert view.why == "the response is being measured: a small excitation goes out"


def test_an_order_that_was_not_heard_is_not_counted() -> None:
    deaf = {k: math.nan for k in row() if k.endswith("ripple_before")}
    view = shown(seen(row(**deaf)))
    assert "without:unwind" not in view.values
    assert view.notes["without:unwind"].startswith("not known")


def test_numbers_are_in_the_units_of_the_page() -> None:
    view = shown(seen(row(correction_unwind_m_s=-0.03)))
    assert view.values["speed"] == 60.0
    assert view.values["radius:unwind"] == 200.0
    assert view.values["correction:unwind"] == -30.0
    assert view.values["peak:unwind"] == 30.0
    assert view.values["share:unwind"] == pytest.approx(0.2)
    assert view.values["reference:unwind_tension_N"] == 90.0


@each_case("state", [State.FAULT, State.BYPASS, State.READY, State.SHADOW])
def test_of_an_output_that_rests_the_correction_is_that_of_now(state: State) -> None:
    """Ten seconds of 30 mm/s are in the window, and it has come down to 2 mm/s."""
    before = seen(row(state, correction_unwind_m_s=-0.03))
    now = replace(before, row=TickRow(row(state, correction_unwind_m_s=-0.002)))
    view = shown(now)
    assert view.values["peak:unwind"] == 2.0
    assert view.values["share:unwind"] == pytest.approx(0.002 / 0.15, rel=1e-5)
    assert view.notes["peak:unwind"] == "now; let out by the guard:"


@pytest.mark.parametrize("state", [State.ACTIVE, State.FADING])
def test_of_an_output_that_goes_out_it_is_the_largest_of_ten_seconds(state: State) -> None:
    before = seen(row(state, correction_unwind_m_s=-0.03))
    view = shown(replace(before, row=TickRow(row(state, correction_unwind_m_s=-0.002))))
    assert view.values["peak:unwind"] == 30.0
    assert view.notes["peak:unwind"].startswith("largest of ten seconds")


def test_a_number_that_is_not_known_is_none_and_never_zero() -> None:
    moment = seen(row(unwind_tension_N=math.nan, unwind_radius_m=math.nan))
    view = shown(moment)
    assert view.values["tension:unwind_tension_N"] is None
    assert view.values["rms:unwind_tension_N"] is None
    assert view.values["radius:unwind"] is None


@pytest.mark.parametrize(
    ("blocked", "doubted"),
    [
        ("TENSION_IMPLAUSIBLE (unwind_tension_N)", "tension:unwind_tension_N"),
        ("SIGNAL_IMPLAUSIBLE (line_speed_m_s)", "speed"),
        ("RADIUS_JUMP (unwind_radius_m 0.21)", "radius:unwind"),
    ],
)
def test_what_the_guard_does_not_believe_is_not_shown_as_alive(blocked: str, doubted: str) -> None:
    view = shown(seen(row(State.FAULT), facts=facts(blocked=blocked)))
    assert doubted in view.doubted
    if doubted.startswith("tension"):
        assert "now:unwind" in view.doubted
        assert view.notes["rms:unwind_tension_N"].startswith("the service does not believe it")


def test_what_is_not_believed_is_not_shown_as_alive_when_another_reason_stands_first() -> None:
    also = ("TENSION_IMPLAUSIBLE (unwind_tension_N)", "SIGNAL_IMPLAUSIBLE (line_speed_m_s)")
    told = facts(blocked="WEB_INTACT=0", also_blocking=also)
    doubted = shown(seen(row(State.FAULT), facts=told)).doubted
    assert {"tension:unwind_tension_N", "now:unwind", "speed"} <= set(doubted)
    assert len(set(doubted)) == len(doubted)


@each_case("blocked", ["", "WEB_INTACT=0", "PLC_STALE", "TENSION_IMPLAUSIBLE"])
def test_nothing_else_is_doubted(blocked: str) -> None:
    assert shown(seen(facts=facts(blocked=blocked))).doubted == ()


def test_a_control_process_that_has_died_has_no_age_and_no_state() -> None:
    view = shown(seen(writer_lives=False))
    assert view.tick_age_s is None
    assert (view.state, view.word, view.why) == ("STARTING", "UNKNOWN", "the service starts")


def test_no_service_is_said_with_what_to_do() -> None:
    view = view_of(Observed(trouble="gone"), Layout(), SAY)
    assert (view.state, view.word) == ("GONE", "UNKNOWN")
    assert "journalctl" in view.to_do
    assert view.values == {}


def test_a_reason_is_of_now_while_who_said_it_is_heard() -> None:
    """Of a tick's state it grows old with the ticks; why there are none is known without them."""
    assert shown(seen()).why_from == "supervisor"
    assert shown(seen(tick_age_s=7.0)).why_from == "supervisor"
    assert shown(seen(row=None)).why_from == "facts"
    assert view_of(Observed(trouble="gone"), Layout(), SAY).why_from == "hmi"


def test_what_comes_next_is_said_in_minutes() -> None:
    (coming,) = shown(seen()).coming
    assert coming.text == "unwind: unwind 4x meets swrap 1x in 12 min, at {radius}"
    assert coming.radius_mm == 154


@each_case("event", TABLE, ids=lambda e: e.name)
def test_the_screen_has_the_words_of_status(event: Event) -> None:
    for state, blocked in product(State, ["", "WEB_INTACT=0", "PLC_STALE 0.3 s"]):
        compare_words(state, event, blocked)


def compare_words(state: State, event: Event, blocked: str) -> None:
    _, live = live_status(TickRow({**row(state), "alarm": event.code}), [], EUCLID)
    live = replace(live, blocked_by=blocked)
    line = headline(StatusAnswer(line="L", state=state.name, live=live))
    reason = reason_of(state.name, event.code, blocked, SAY)
    if state in (State.FAULT, State.BYPASS) and event.code:
        assert event.text in line
        assert event.text in reason.why
        assert reason.to_do in line or blocked == "WEB_INTACT=0"
        assert reason.to_do
    if blocked and state in (State.FAULT, State.BYPASS, State.OFF, State.READY):
        assert blocked in line
        assert blocked in reason.why
    assert reason.why


def test_an_alarm_comes_first_with_its_step() -> None:
    code = BY_NAME["SECOND_MASTER"].code
    moment = seen(row(State.FAULT, alarm=code), facts=facts(config_differs=("site.yaml:7:3",)))
    first, second = shown(moment).alarms
    assert (first.rank, first.name) == (1, "SECOND_MASTER")
    assert first.to_do == BY_NAME["SECOND_MASTER"].action
    assert (second.rank, second.name) == (3, "CONFIG_DIFFERS")


@each_case("name", ["NONE", "POWER_UP", "BYPASSED", "SPLICE", "PERMISSIVE_LOST"])
def test_what_asks_for_nobody_is_no_alarm(name: str) -> None:
    assert name not in PRIORITIES
    assert shown(seen(row(State.FAULT, alarm=BY_NAME[name].code))).alarms == ()


def test_a_silent_supervisor_is_told() -> None:
    (notice,) = shown(seen(facts_age_s=FACTS_OLD_S + 1.0)).alarms
    assert notice.name == "SUPERVISOR"
    assert "3 s" in notice.text


def test_a_recorder_that_is_gone_or_loses_rows_is_told() -> None:
    gone = RecorderReport(folder="/r", rows=5, alive=False)
    lossy = RecorderReport(folder="/r", rows=5, rows_lost=3, alive=True)
    assert shown(seen(facts=facts(recorder=gone))).alarms[0].text == "nothing is recorded"
    assert shown(seen(facts=facts(recorder=lossy))).alarms[0].text.startswith("3 rows")


def test_the_state_names_the_signal_too_when_its_cause_is_over() -> None:
    fault = seen(row(State.FAULT, alarm=BY_NAME["TENSION_IMPLAUSIBLE"].code))
    named = {"TENSION_IMPLAUSIBLE": "TENSION_IMPLAUSIBLE (unwind_tension_N)"}
    view = view_of(fault, layout(seen()), SAY, named)
    text = BY_NAME["TENSION_IMPLAUSIBLE"].text
    assert view.why == f"TENSION_IMPLAUSIBLE (unwind_tension_N): {text} (over now)"
    assert shown(fault).why == f"TENSION_IMPLAUSIBLE: {text} (over now)"


def test_orders_that_rest_are_told_together() -> None:
    clamped = {k: float(OrderState.CLAMPED) for k in row() if k.endswith(".state")}
    (notice,) = shown(seen(row(**clamped))).alarms
    assert notice.name == "unwind: unwind_1x, unwind_2x"
    assert "limit is used up" in notice.text


def test_what_waits_for_its_delay_is_told_once_it_stands() -> None:
    clamped = seen(row(**{k: float(OrderState.CLAMPED) for k in row() if k.endswith(".state")}))
    (resting,) = conditions_of(clamped, "ACTIVE")
    assert notices_of(clamped, "ACTIVE", SAY, standing={}) == ()
    assert len(notices_of(clamped, "ACTIVE", SAY, standing={resting.key: "unwind"})) == 1
    stale = seen(row(State.FAULT, alarm=BY_NAME["PLC_STALE"].code))
    assert len(notices_of(stale, "FAULT", SAY, standing={})) == 1  # it has no delay
    named = {"PLC_STALE": "PLC_STALE (unwind_tension_N)"}
    assert [one.name for one in notices_of(stale, "FAULT", SAY, standing=named)] == [
        *named.values()
    ]


@each_case(
    ("source", "told"),
    [
        (Source.NONE, []),
        (Source.ENCODER, []),
        (Source.ROLL_SPEED, ["ENCODER (unwind_angle_rad)"]),
        (Source.LINE_SPEED, ["ENCODER (unwind_angle_rad)"]),
    ],
)
def test_an_encoder_that_is_not_believed_asks_for_somebody(
    source: Source, told: list[str]
) -> None:
    roll = RollFacts(name="unwind", angle_channel="unwind_angle_rad")
    values = row(**{"unwind.source": float(source)})
    moment = seen(values, facts=facts(facts=replace(LINE, rolls=(roll,))))
    assert [one.name for one in conditions_of(moment, "ACTIVE")] == told
    assert shown(moment).to_do.startswith("check the encoder" if told else "nothing")
    without = seen(
        values, facts=facts(facts=replace(LINE, rolls=(replace(roll, angle_channel=""),)))
    )
    assert conditions_of(without, "ACTIVE") == ()


def test_all_that_stands_in_the_way_is_shown_each_with_what_to_do() -> None:
    others = ("WEB_INTACT=0", "SPLICE", "SHADOW=1", "unwind: no measured response; run the probe")
    moment = seen(row(State.OFF), facts=facts(blocked="LINE_RUN=0", also_blocking=others))
    view = shown(moment)
    assert view.why == "blocked by LINE_RUN=0: the line does not run"
    assert [one.why.split(":")[0] for one in view.also] == [
        "WEB_INTACT=0",
        "SPLICE",
        "SHADOW=1",
        "unwind",
    ]
    assert all(one.to_do for one in view.also)
    german = view_of(moment, layout(seen()), say_in("de"))
    assert not {one.why for one in view.also[:2]} & {one.why for one in german.also[:2]}
    assert not {one.to_do for one in view.also} & {one.to_do for one in german.also}


@pytest.mark.parametrize("state", [State.ACTIVE, State.ARMED])
def test_what_an_armed_output_leaves_to_the_law_is_not_in_its_way(state: State) -> None:
    told = facts(blocked="unwind: a", also_blocking=("unwind: b",))
    assert shown(seen(row(state), facts=told)).also == ()


def test_an_alarm_names_the_signal_that_the_guard_names() -> None:
    code = BY_NAME["TENSION_IMPLAUSIBLE"].code
    for blocked, name in (
        ("TENSION_IMPLAUSIBLE (unwind_tension_N)", "TENSION_IMPLAUSIBLE (unwind_tension_N)"),
        ("SIGNAL_IMPLAUSIBLE (line_speed_m_s)", "TENSION_IMPLAUSIBLE"),
        ("", "TENSION_IMPLAUSIBLE"),
    ):
        moment = seen(row(State.FAULT, alarm=code), facts=facts(blocked=blocked))
        assert [one.name for one in shown(moment).alarms] == [name]


@each_case(
    ("trouble", "told"),
    [
        ("no reply within 0.05 s", "keine Antwort innerhalb von 0,05 s"),
        ("no connection within 2 s", "keine Verbindung innerhalb von 2 s"),
        ("closed by the other side", "von der Gegenseite geschlossen"),
        ("[Errno 111] Connection refused", "[Errno 111] Connection refused"),
    ],
)
def test_what_ails_the_wire_is_told_in_the_readers_language(trouble: str, told: str) -> None:
    moment = seen(facts=facts(wire=(trouble,)))
    (notice,) = notices_of(moment, "ACTIVE", say_in("de"))
    assert notice.text == told


def test_events_are_in_words_the_newest_first() -> None:
    moment = seen(events=((18, 0.0, 1.0), (15, 0.0, 60.0), (99, 0.0, 61.0)))
    events = shown(moment).events
    assert [one.name for one in events] == ["BYPASSED", "POWER_UP", "CODE 99"]
    assert events[0].text == "bypassed, or a probe has ended"


def test_events_of_one_kind_in_a_row_are_one_with_their_number() -> None:
    view = shown(seen(events=((5, 0.0, 1.0), (5, 0.0, 2.0), (15, 0.0, 60.0))))
    assert [(e.name, e.ago_s) for e in view.events] == [
        ("PHASE_UNSURE ×2", 1.0),
        ("POWER_UP", 60.0),
    ]


def test_a_page_changes_when_the_site_does_and_not_with_the_numbers() -> None:
    moment = seen()
    other = seen(row(unwind_tension_N=1.0))
    renamed = replace(LINE, outputs=(replace(LINE.outputs[0], actuator="rewind"),))
    assert layout(moment).ident == layout(other).ident
    assert layout(seen(facts=facts(facts=renamed))).ident != layout(moment).ident


def test_a_limit_that_a_try_changes_is_filled_in_and_the_page_stays() -> None:
    wider = replace(LINE, outputs=(replace(LINE.outputs[0], limit=0.2),))
    moments = seen(), seen(facts=facts(facts=wider))
    before, after = (view_of(one, layout(one), SAY) for one in moments)
    assert after.layout == before.layout
    assert (before.limits, after.limits) == ({"unwind": 150.0}, {"unwind": 200.0})  # mm/s


def test_a_set_point_is_no_tension() -> None:
    assert [one.channel for one in layout(seen()).tensions] == ["unwind_tension_N"]


def test_a_hostile_name_stays_one_short_line() -> None:
    assert label_of("a\nb\u202e_tension_N") == "a\\nb\\u202e tension"
    assert len(label_of("x" * 500)) <= 60
