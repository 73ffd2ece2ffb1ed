"""All that stands against an armed output is told, and the first of it is what is told alone."""

from __future__ import annotations

from collections.abc import Callable
from math import nan

from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.base.events import BY_NAME, TABLE, Reaction
from aff_runtime.base.signals import State, Status
from aff_runtime.safety.reasons import REMOTE, SHADOW, reasons
from tests.aff_runtime.safety.bench import Bench

NEED = ("LINE_RUN", "AFF_ENABLE_REQUEST", "WEB_INTACT", "TENSION_VALID", "ESTOP_OK")
SPOILS: dict[str, Callable[[Bench], object]] = {
    "TENSION_IMPLAUSIBLE (unwind_tension_N)": lambda b: setattr(b, "tension_N", nan),
    "RADIUS_JUMP (unwind_radius_m)": lambda b: (b.run(), setattr(b, "radius_m", 0.3)),
    "OVERRUN": lambda b: setattr(b, "overrun", True),
    "SUPERVISOR_LOST": lambda b: setattr(b, "supervisor_alive", False),
    **{f"{name}=0": lambda b, name=name: b.clear(Status[name]) for name in NEED},
    "SPLICE": lambda b: b.set(Status.SPLICE_ACTIVE),
    "unwind: no response": lambda b: setattr(b.guard, "objections", ("unwind: no response",)),
    SHADOW: lambda b: b.guard.shadow(True),
    REMOTE: lambda b: b.set(Status.REMOTE),
}


@given(st.sets(st.sampled_from(sorted(SPOILS))))
def test_the_guard_names_all_that_was_spoiled_and_nothing_else(spoilt: set[str]) -> None:
    bench = Bench()
    for name, spoil in SPOILS.items():
        if name in spoilt:
            spoil(bench)
    bench.run()
    # a splice brings another roll: while it lasts no radius is taken for a jump; and the tension
    # of a line that does not run is not judged
    expected = spoilt - ({"RADIUS_JUMP (unwind_radius_m)"} if "SPLICE" in spoilt else set())
    found = bench.guard.reasons()
    assert len(found) == len(set(found))
    assert set(found) == expected


@given(st.sets(st.sampled_from(sorted(SPOILS))))
def test_the_first_reason_alone_is_the_first_of_all_and_none_lets_it_be_armed(
    spoilt: set[str],
) -> None:
    bench = Bench()
    for name, spoil in SPOILS.items():
        if name in spoilt:
            spoil(bench)
    bench.run()
    found = bench.guard.reasons()
    assert bench.guard.first_blocking() == (f"blocked by {found[0]}" if found else "")
    bench.guard.arm()
    bench.run(3)
    confirmed = all(one.startswith("RADIUS_JUMP") for one in found)  # to arm confirms the roll
    assert (bench.state in (State.ARMED, State.ACTIVE)) is confirmed


@given(
    causes=st.sets(st.sampled_from(sorted(BY_NAME))),
    missing=st.lists(st.sampled_from([f"{name}=0" for name in NEED]), unique=True, min_size=1),
    objections=st.lists(st.sampled_from(["unwind: a", "unwind: b"]), unique=True),
    shadow=st.booleans(),
    by_plc=st.booleans(),
)
def test_what_latches_comes_before_what_fades_and_that_before_what_only_keeps_from_arming(
    causes: set[str], missing: list[str], objections: list[str], shadow: bool, by_plc: bool
) -> None:
    """The order is written a second time here, from the table of events."""
    found = list(
        reasons(
            sum(1 << BY_NAME[name].code for name in causes),
            detail=lambda code: f"code {code}",
            missing=missing,
            objections=objections,
            shadow=shadow,
            by_plc=by_plc,
        )
    )
    present = sorted((event for event in TABLE if event.name in causes), key=lambda one: one.code)
    latching = [e for e in present if e.reaction is Reaction.FADE_AND_LATCH]
    fading = [e.name for e in present if e.reaction is Reaction.FADE]
    of_permissives = missing if "PERMISSIVE_LOST" in fading else []
    assert found == [
        *(f"{e.name} (code {e.code})" for e in latching),
        *of_permissives,
        *(name for name in fading if name != "PERMISSIVE_LOST"),
        *objections,
        *(["SHADOW=1"] if shadow else []),
        *(["REMOTE=1: the PLC arms, by its reset"] if by_plc else []),
    ]
