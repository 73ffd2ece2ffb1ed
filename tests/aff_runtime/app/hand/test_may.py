"""Who may do what, over every state, role, place and hand; the reasons in their order."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import pytest

from aff_runtime.app.hand.may import (
    WORDS,
    Action,
    Circumstances,
    Code,
    Person,
    Place,
    Reason,
    Role,
    may,
)
from aff_runtime.app.link.messages import Blocked
from aff_runtime.base.signals import State
from aff_runtime.safety.reasons import REMOTE, SHADOW
from tests.each_case import each_case

STATES = (None, *State)
ROLES = (None, *Role)
BLOCKED = ("", "WEB_INTACT=0", "REMOTE=1: the PLC arms, by its reset", "SHADOW=1")
OWN = Person(role=Role.OPERATE, place=Place.PANEL, has_hand=True)
OPEN = Circumstances(state=State.READY, ceiling=Role.OPERATE)


def codes(action: Action, person: Person, now: Circumstances) -> list[Code]:
    return [reason.code for reason in may(action, person, now)]


FREE_FROM = {None: (), Place.PANEL: (Place.PANEL,), Place.NETWORK: tuple(Place)}


@each_case("role", ROLES)
@each_case("free", FREE_FROM)
def test_bypass_is_for_who_has_logged_in_or_stands_where_it_is_free_whatever_else_is(
    role: Role | None, free: Place | None
) -> None:
    for state, place, idle, ceiling, hand, blocked in product(
        STATES, Place, (False, True), Role, ("", "anna"), BLOCKED
    ):
        person = Person(role=role, place=place, is_idle=idle)
        now = Circumstances(
            state=state, ceiling=ceiling, hand_of=hand, blocked=blocked, bypass_from=free
        )
        is_open = role is not None or place in FREE_FROM[free]
        assert codes(Action.BYPASS, person, now) == ([] if is_open else [Code.LOGGED_OUT])


def test_arming_needs_every_one_of_its_conditions() -> None:
    allowed = 0
    for state, role, place, farthest, ceiling, hand, idle, blocked in product(
        STATES, ROLES, Place, Place, Role, ("own", "nobody", "other"), (False, True), BLOCKED
    ):
        person = Person(role=role, place=place, has_hand=hand == "own", is_idle=idle)
        now = Circumstances(
            state=state,
            blocked=blocked,
            ceiling=ceiling,
            commands_from=farthest,
            hand_of="" if hand == "nobody" else "anna",
        )
        is_fit = (
            role in (Role.OPERATE, Role.COMMISSION)
            and ceiling in (Role.OPERATE, Role.COMMISSION)
            and (place, farthest) != (Place.NETWORK, Place.PANEL)
            and hand == "own"
            and not idle
            and not blocked
            and state in (State.FAULT, State.BYPASS, State.OFF, State.READY, State.SHADOW)
        )
        assert (may(Action.ARM, person, now) == ()) is is_fit
        allowed += is_fit
    assert allowed == 5 * 2 * 2 * 3


@each_case(
    ("person", "now", "expected"),
    [
        (OWN, OPEN, []),
        (Person(role=None, place=Place.PANEL), OPEN, [Code.LOGGED_OUT, Code.NO_HAND]),
        (OWN, Circumstances(state=State.READY), [Code.CEILING]),
        (Person(role=Role.VIEW, place=Place.PANEL, has_hand=True), OPEN, [Code.ROLE]),
        (Person(role=Role.OPERATE, place=Place.NETWORK, has_hand=True), OPEN, [Code.PLACE]),
        (Person(role=Role.OPERATE, place=Place.PANEL, is_idle=True), OPEN, ["idle", "no hand"]),
        (OWN, Circumstances(state=None, ceiling=Role.OPERATE), [Code.SILENT]),
        (OWN, Circumstances(state=State.ACTIVE, ceiling=Role.OPERATE), [Code.ALREADY]),
        (OWN, Circumstances(state=State.FADING, ceiling=Role.OPERATE), [Code.FADING]),
        (Person(role=None, place=Place.NETWORK), Circumstances(state=State.ARMED), [Code.ALREADY]),
    ],
)
def test_the_reasons_come_in_their_order(
    person: Person, now: Circumstances, expected: list[Code]
) -> None:
    assert codes(Action.ARM, person, now) == expected


def test_another_roll_is_confirmed_by_arming_and_only_from_rest() -> None:
    jumped = {"blocked": "RADIUS_JUMP (unwind_radius_m 0.21)", "ceiling": Role.OPERATE}
    assert may(Action.ARM, OWN, Circumstances(state=State.FAULT, **jumped)) == ()
    assert codes(Action.ARM, OWN, Circumstances(state=State.OFF, **jumped)) == [Code.GUARD]


def test_every_reason_of_the_guard_is_told_and_each_is_left_out_for_what_ends_it() -> None:
    of_law = "unwind: no measured response; run the probe"
    now = replace(
        FREE, state=State.FAULT, blocked="RADIUS_JUMP (r)", also_blocking=("WEB_INTACT=0", of_law)
    )
    named = {one: [reason.name for reason in may(one, CARL, now)] for one in Action}
    assert named[Action.ARM] == ["WEB_INTACT=0", of_law]
    assert named[Action.PROBE] == ["WEB_INTACT=0"]
    assert named[Action.SHADOW] == ["RADIUS_JUMP (r)"]
    late = replace(now, also_blocking=("SHADOW=1",))
    assert Code.NO_SHADOW not in codes(Action.END_SHADOW, CARL, late)


def test_every_reason_has_its_words_and_names_what_it_is_about() -> None:
    assert set(WORDS) == set(Code)
    assert (
        Reason(code=Code.OTHER_HAND, name="anna\x1b\u202e").text == r"anna\x1b\u202e has the hand"
    )
    blocked = Reason(code=Code.GUARD, name="WEB_INTACT=0").text
    assert blocked == "blocked by WEB_INTACT=0: the PLC sees no web"
    remote = Reason(code=Code.GUARD, name="REMOTE=1: the PLC arms, by its reset").text
    assert remote == "blocked by REMOTE=1: the PLC arms, by its reset"


CARL = Person(role=Role.COMMISSION, place=Place.PANEL, has_hand=True)
FREE = Circumstances(state=State.READY, ceiling=Role.COMMISSION)


@each_case(
    ("person", "now", "code"),
    [
        (OWN, FREE, Code.PROBE_ROLE),
        (CARL, OPEN, Code.NO_PROBE),
        (replace(CARL, place=Place.NETWORK), FREE, Code.PLACE),
        (replace(CARL, has_hand=False), FREE, Code.NO_HAND),
        (replace(CARL, is_idle=True), FREE, Code.IDLE),
        (CARL, replace(FREE, probing=True), Code.PROBING),
        (CARL, replace(FREE, state=None), Code.SILENT),
        (CARL, replace(FREE, state=State.FADING), Code.FADING),
        (CARL, replace(FREE, blocked="WEB_INTACT=0"), Code.GUARD),
        (CARL, replace(FREE, blocked="REMOTE=1: the PLC arms, by its reset"), Code.GUARD),
    ],
)
def test_a_probe_needs_commission_everywhere_and_what_an_arm_needs(
    person: Person, now: Circumstances, code: Code
) -> None:
    assert codes(Action.PROBE, person, now) == [code]
    assert codes(Action.PROBE_LOUDER, person, now) == [code]


@each_case("state", [State.READY, State.BYPASS, State.ARMED, State.ACTIVE])
def test_what_stands_against_the_law_is_no_reason_against_the_probe_that_ends_it(
    state: State,
) -> None:
    now = replace(FREE, state=state, blocked="unwind: no measured response; run the probe")
    assert codes(Action.PROBE, CARL, now) == []


@pytest.mark.parametrize(("first", "code"), [("unwind", None), ("LINE_RUN=0", Code.GUARD)])
def test_more_reasons_than_are_told_are_of_the_law_where_the_last_one_told_is(
    first: str, code: Code | None
) -> None:
    """Behind the law's the guard has shadow and remote alone, which are told whatever is not."""
    law = [f"unwind: {n}x: coherence 0.23 near 13.57 Hz is too low" for n in range(40)]
    guard = [f"permissive {n}" for n in range(40)]
    told = Blocked.by(law if code is None else guard)
    now = replace(FREE, state=State.BYPASS, blocked=told.text, also_blocking=told.others)
    assert told.others[-1].startswith("and ")
    found = codes(Action.PROBE, CARL, now)
    assert found == ([] if code is None else [code] * (len(told.others) + 1))
    for last in ([SHADOW], [REMOTE], [SHADOW, REMOTE]):
        told = Blocked.by((law if code is None else guard) + last)
        with_it = replace(now, blocked=told.text, also_blocking=told.others)
        named = [one.name for one in may(Action.PROBE, CARL, with_it)]
        assert [name for name in named if name in last] == last
        assert len(named) == len(found) + len(last)
        assert codes(Action.END_SHADOW, CARL, with_it) == (
            [] if SHADOW in last else [Code.NO_SHADOW]
        )


RESTS = (Action.SHADOW, Action.END_SHADOW, Action.FORGET)
IN = {Action.SHADOW: State.READY, Action.END_SHADOW: State.SHADOW, Action.FORGET: State.READY}


@each_case("action", RESTS)
@each_case(
    ("who", "how", "code"),
    [
        ({"role": Role.VIEW}, {}, Code.ROLE),
        ({"place": Place.NETWORK}, {}, Code.PLACE),
        ({"has_hand": False}, {}, Code.NO_HAND),
        ({"is_idle": True}, {}, Code.IDLE),
        ({}, {"ceiling": Role.VIEW}, Code.CEILING),
        ({}, {"state": None}, Code.SILENT),
        ({}, {"remote": True}, Code.REMOTE),
        ({}, {"probing": True}, Code.PROBING),
        ({}, {}, None),
    ],
)
def test_shadow_and_forgetting_need_what_arming_needs_and_are_the_plcs_in_remote(
    action: Action, who: dict[str, object], how: dict[str, object], code: Code | None
) -> None:
    person = replace(OWN, **who)  # type: ignore[arg-type]
    now = replace(OPEN, **{"state": IN[action], **how})  # type: ignore[arg-type]
    assert codes(action, person, now) == ([] if code is None else [code])


def test_no_screen_may_is_said_with_the_words_of_the_console() -> None:
    said = [may(one, OWN, Circumstances(state=IN[one]))[0].text for one in RESTS]
    assert [text.partition("aff-runtime ")[2] for text in said] == [
        "shadow on",
        "shadow off",
        "forget",
    ]


@each_case("state", State)
def test_nothing_is_forgotten_while_a_correction_goes_out(state: State) -> None:
    goes_out = state in (State.ACTIVE, State.FADING)
    found = codes(Action.FORGET, OWN, replace(OPEN, state=state))
    assert found == ([Code.GOES_OUT] if goes_out else [])


def test_a_cause_that_latches_keeps_out_of_shadow_and_a_missing_permissive_does_not() -> None:
    for blocked, expected in (("PLC_STALE", [Code.GUARD]), ("WEB_INTACT=0", [])):
        now = replace(OPEN, state=State.FAULT, blocked=blocked)
        assert codes(Action.SHADOW, OWN, now) == expected
    wanted = replace(OPEN, state=State.BYPASS, blocked="SHADOW=1")  # asked for, still to come
    assert codes(Action.END_SHADOW, OWN, wanted) == []
    assert codes(Action.END_SHADOW, OWN, OPEN) == [Code.NO_SHADOW]
    assert codes(Action.SHADOW, OWN, replace(OPEN, state=State.SHADOW)) == [Code.SHADOWED]
