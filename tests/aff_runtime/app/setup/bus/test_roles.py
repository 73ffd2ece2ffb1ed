"""Which signal is what, by the names, units, signs and ways that DBC and EDS files give."""

from __future__ import annotations

from dataclasses import replace

from aff_runtime.app.setup.asking.quantities import further, quantities
from aff_runtime.app.setup.bus.ranking import can_be, is_alone, is_likely, ranked
from aff_runtime.app.setup.bus.roles import (
    Role,
    complement_role,
    correction_role,
    has_one,
    is_diameter,
    of_quantity,
    words_read,
)
from aff_runtime.fieldbus.can.layout import Field, FrameLayout
from aff_runtime.fieldbus.can.named_signal import NamedSignal
from tests.each_case import each_case

ROLLS = ("unwind", "nip")
QUANTITIES = {one.channel: of_quantity(one, ROLLS) for one in quantities("nip")}
HEARTBEAT, STATUS, ROLL_ID, ECHO = words_read()


def signal(name: str, unit: str = "", *, frame: str = "MSG", **how: object) -> NamedSignal:
    way = how.pop("sent_to_us", None)
    field = Field(name=name, frame=frame, shift=0, **({"length": 16} | how))
    return NamedSignal(
        name=f"{frame}.{name}",
        field=field,
        layout=FrameLayout(name=frame, can_id=1, extended=False, length=8),
        called=name,
        owner=frame,
        unit=unit,
        sent_to_us=way,
    )


def best(role: Role, *signals: NamedSignal, **how: object) -> list[str]:
    rows = ranked(role, signals, taken=how.get("taken", {}), moves=how.get("moves", {}))
    return [one.signal.field.name for one in rows]


@each_case(
    ("text", "found"),
    [
        ("UnwindTension", True),
        ("unwind_tension", True),
        ("UNWIND TENSION ACT", True),
        ("bahnzug_abw", True),
        ("Extension", True),  # holds "tension": a name alone decides nothing, the row says so
        ("TenMeter", False),
    ],
)
def test_words_are_found_however_a_name_is_written(text: str, found: bool) -> None:
    assert has_one(QUANTITIES["unwind_tension_N"].groups[0], text) is found


def test_short_words_stand_for_themselves() -> None:
    assert has_one(frozenset({"ref"}), "TensionRef")
    assert not has_one(frozenset({"ref"}), "Preferred")


def test_the_tension_of_its_own_roll_goes_before_that_of_another_and_before_its_set_point() -> (
    None
):
    rows = best(
        QUANTITIES["unwind_tension_N"],
        signal("RewindTension", "N"),
        signal("UnwindTensionSetpoint", "N"),
        signal("UnwindTension", "lbf"),
        signal("UnwindSpeed", "m/min"),  # of another kind: never
    )
    assert rows[0] == "UnwindTension"
    assert "UnwindSpeed" not in rows
    assert best(
        QUANTITIES["tension_ref_N"], signal("Tension", "N"), signal("TensionSetpoint", "N")
    ) == ["TensionSetpoint", "Tension"]


def test_a_roller_alone_is_not_taken_for_the_line() -> None:
    rows = ranked(QUANTITIES["line_speed_m_s"], [signal("NipSpeed", "m/s")], taken={}, moves={})
    assert is_likely(rows)
    assert not is_alone(rows)


def test_two_that_go_by_the_same_words_are_not_told_apart() -> None:
    drives = [signal("Velocity actual value", frame=f"drive{n}", sent_to_us=True) for n in (1, 2)]
    assert not is_alone(ranked(QUANTITIES["line_speed_m_s"], drives, taken={}, moves={}))


def test_nothing_that_says_another_kind_is_likely() -> None:
    rows = ranked(
        of_quantity(further("r3_tension_N"), ROLLS),
        [signal("R3Angle", "count"), signal("Flags")],
        taken={},
        moves={},
    )
    assert not is_likely(rows)


def test_a_heartbeat_that_stands_still_goes_behind_one_that_moves() -> None:
    rows = best(
        HEARTBEAT,
        signal("LifeCounter"),
        signal("Heartbeat"),
        moves={"MSG.Heartbeat": False, "MSG.LifeCounter": True},
    )
    assert rows == ["LifeCounter", "Heartbeat"]


@each_case(
    ("role", "right", "wrong"),
    [
        (HEARTBEAT, {"length": 8}, {"length": 7}),
        (HEARTBEAT, {"length": 8}, {"length": 8, "factor": 0.1}),
        (ECHO, {"length": 16}, {"length": 8}),
        (STATUS, {"length": 16}, {"length": 32, "is_float": True}),
        (correction_role("unwind"), {"signed": True}, {"signed": False}),
        (correction_role("unwind"), {"signed": True}, {"signed": True, "offset": 1.0}),
        (complement_role("unwind", 16), {"length": 16}, {"length": 17}),
    ],
)
def test_what_check_would_refuse_is_not_offered(
    role: Role, right: dict[str, object], wrong: dict[str, object]
) -> None:
    assert can_be(role, signal("x", **right))
    assert not can_be(role, signal("x", **wrong))


def test_a_correction_in_another_unit_is_not_offered_since_a_dbc_factor_counts_as_si() -> None:
    role = correction_role("unwind")
    assert can_be(role, signal("x", "m/s", signed=True))
    assert not can_be(role, signal("x", "mm/s", signed=True))


def test_what_a_node_takes_is_not_read_and_a_frame_has_one_sender() -> None:
    taken_by_node = signal("Heartbeat", sent_to_us=False)
    assert not can_be(HEARTBEAT, taken_by_node)
    read = signal("Status", frame="A")
    other = signal("Trim", frame="A", signed=True)
    ours = signal("Trim", frame="B", signed=True)
    rows = ranked(
        correction_role("unwind"), [read, other, ours], taken={read.name: False}, moves={}
    )
    assert [one.signal for one in rows] == [ours]


def test_a_diameter_is_told_by_its_name() -> None:
    assert is_diameter("UnwindDiameter")
    assert is_diameter("ROLL_DIA")
    assert not is_diameter("UnwindRadius")
    assert not is_diameter("Diagnosis")


def test_a_role_of_no_unit_never_takes_what_has_one() -> None:
    assert not can_be(ROLL_ID, signal("RollId", "mm"))
    assert can_be(ROLL_ID, replace(signal("RollId"), unit="count"))
