from __future__ import annotations

from itertools import product

from aff_runtime.base.signals import State
from aff_runtime.safety.state_machine import Inputs, Standing, advance
from tests.each_case import each_case

replace = Inputs._replace
CALM = Inputs(
    arm_edge=False,
    bypass_edge=False,
    shadow=False,
    shadow_edge=False,
    latching=False,
    blocked=False,
    moving=True,
    quiet=True,
)
LOUD = replace(CALM, quiet=False)
ARM = {"arm_edge": True}


def standing(state: State, armed: bool = False) -> Standing:
    return Standing(state=state, armed=armed)


def test_it_starts_in_fault_unarmed() -> None:
    assert Standing() == standing(State.FAULT, armed=False)


@each_case(
    ("before", "inputs", "after"),
    [
        # leaving rest needs an edge
        (standing(State.FAULT), CALM, standing(State.FAULT)),
        (standing(State.BYPASS), CALM, standing(State.BYPASS)),
        (standing(State.FAULT), replace(CALM, **ARM), standing(State.ACTIVE, True)),
        (standing(State.FAULT), replace(CALM, **ARM, moving=False), standing(State.ARMED, True)),
        (standing(State.FAULT), replace(CALM, **ARM, blocked=True), standing(State.OFF)),
        (standing(State.FAULT), replace(CALM, **ARM, latching=True), standing(State.FAULT)),
        (standing(State.FAULT), replace(LOUD, **ARM), standing(State.FAULT)),
        (standing(State.BYPASS), replace(CALM, **ARM), standing(State.ACTIVE, True)),
        (standing(State.BYPASS), replace(CALM, **ARM, latching=True), standing(State.BYPASS)),
        # waiting
        (standing(State.OFF), CALM, standing(State.READY)),
        (standing(State.READY), CALM, standing(State.READY)),
        (standing(State.READY), replace(CALM, blocked=True), standing(State.OFF)),
        (standing(State.READY), replace(CALM, **ARM), standing(State.ACTIVE, True)),
        (standing(State.READY), replace(CALM, **ARM, blocked=True), standing(State.OFF)),
        (standing(State.OFF, True), CALM, standing(State.ACTIVE, True)),
        (standing(State.OFF, True), replace(CALM, blocked=True), standing(State.OFF, True)),
        (standing(State.OFF, True), LOUD, standing(State.OFF, True)),
        (standing(State.ARMED, True), CALM, standing(State.ACTIVE, True)),
        (standing(State.ARMED, True), replace(CALM, moving=False), standing(State.ARMED, True)),
        (standing(State.ARMED, True), replace(CALM, blocked=True), standing(State.OFF, True)),
        # live
        (standing(State.ACTIVE, True), LOUD, standing(State.ACTIVE, True)),
        (standing(State.ACTIVE, True), replace(LOUD, moving=False), standing(State.FADING, True)),
        (standing(State.ACTIVE, True), replace(LOUD, blocked=True), standing(State.FADING, True)),
        (standing(State.FADING, True), LOUD, standing(State.FADING, True)),
        (standing(State.FADING, True), CALM, standing(State.ACTIVE, True)),
        (standing(State.FADING, True), replace(CALM, moving=False), standing(State.ARMED, True)),
        (standing(State.FADING, True), replace(CALM, blocked=True), standing(State.OFF, True)),
        # shadow
        (standing(State.SHADOW), CALM, standing(State.READY)),
        (standing(State.SHADOW), replace(CALM, blocked=True), standing(State.OFF)),
        (standing(State.FAULT), replace(CALM, shadow=True), standing(State.FAULT)),
        (
            standing(State.FAULT),
            replace(CALM, shadow=True, shadow_edge=True),
            standing(State.SHADOW),
        ),
        (standing(State.FAULT), replace(CALM, **ARM, shadow=True), standing(State.SHADOW)),
        (standing(State.SHADOW), replace(CALM, **ARM, shadow=True), standing(State.SHADOW)),
    ],
)
def test_transition(before: Standing, inputs: Inputs, after: Standing) -> None:
    assert advance(before, inputs) == after


EVERY_INPUT = [
    Inputs(
        arm_edge=a,
        bypass_edge=b,
        shadow=s,
        shadow_edge=e and s,
        latching=c,
        blocked=d,
        moving=m,
        quiet=q,
    )
    for a, b, s, e, c, d, m, q in product((False, True), repeat=8)
]
EVERY_STANDING = [standing(state, armed) for state in State for armed in (False, True)]
EVERY_STEP = [(before, inputs) for before in EVERY_STANDING for inputs in EVERY_INPUT]


def test_bypass_wins_in_every_state_whatever_else_happens() -> None:
    for before, inputs in EVERY_STEP:
        if inputs.bypass_edge:
            assert advance(before, inputs) == standing(State.BYPASS)


def test_a_latching_cause_leads_to_rest_from_everywhere_in_one_step() -> None:
    for before, inputs in EVERY_STEP:
        if inputs.latching:
            assert advance(before, inputs).state in (State.FAULT, State.BYPASS)


def test_rest_is_left_only_by_an_edge_with_the_cause_gone_and_the_output_at_zero() -> None:
    for before, inputs in EVERY_STEP:
        if before.state not in (State.FAULT, State.BYPASS) or inputs.bypass_edge:
            continue
        if advance(before, inputs).state not in (State.FAULT, State.BYPASS):
            assert inputs.arm_edge or inputs.shadow_edge
            assert not inputs.latching
            assert inputs.quiet


def test_nothing_becomes_active_while_blocked_or_standing_still_or_in_shadow() -> None:
    for before, inputs in EVERY_STEP:
        after = advance(before, inputs)
        if after.state is State.ACTIVE:
            assert not inputs.blocked
            assert inputs.moving
            assert not inputs.shadow
            assert after.armed or before.state is State.ACTIVE


def test_the_word_to_be_armed_is_given_only_by_the_arm_edge() -> None:
    live = (State.ACTIVE, State.FADING)
    for before, inputs in EVERY_STEP:
        if before.armed or before.state in live:
            continue
        if advance(before, inputs).armed:
            assert inputs.arm_edge


def test_rest_and_shadow_are_never_armed() -> None:
    for before, inputs in EVERY_STEP:
        after = advance(before, inputs)
        changed = after.state is not before.state
        if changed and after.state in (State.FAULT, State.BYPASS, State.SHADOW, State.READY):
            assert not after.armed
