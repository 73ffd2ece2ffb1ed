"""Status in words."""

from __future__ import annotations

import math
from dataclasses import asdict, replace

import pytest

from aff_runtime.app.report.block_status import WORDS
from aff_runtime.app.report.status import (
    explain,
    headline,
    live_status,
    missing_permissive,
    not_armed,
    refused_arm,
)
from aff_runtime.app.report.status_answer import StatusAnswer
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import State, Status
from aff_runtime.config.models import Block, Site
from aff_runtime.core.monitor import OrderState
from tests.each_case import each_case
from tests.parameter_records import EUCLID

NEED = ["LINE_RUN", "WEB_INTACT", "AFF_ENABLE_REQUEST"]


def record(state: State, status: int, alarm: int = 0) -> dict[str, float]:
    return {
        "state": state,
        "status": status,
        "alarm": alarm,
        "outcome": 1,
        "unwind_tension_N": math.nan,
    }


@each_case(
    ("status", "missing"),
    [
        (0, "LINE_RUN=0"),
        (Status.LINE_RUN | Status.AFF_ENABLE_REQUEST, "WEB_INTACT=0"),
        (Status.LINE_RUN | Status.WEB_INTACT, "AFF_ENABLE_REQUEST=0"),
        (Status.LINE_RUN | Status.WEB_INTACT | Status.AFF_ENABLE_REQUEST, ""),
    ],
)
def test_the_first_missing_permissive_is_named(status: int, missing: str) -> None:
    assert missing_permissive(status, NEED) == missing


def test_a_record_is_told_in_words_and_nan_becomes_nothing() -> None:
    state, live = live_status(TickRow(record(State.FAULT, 0, 15)), NEED, EUCLID)
    assert state is State.FAULT
    assert live.alarm.name == "POWER_UP"
    assert live.comm == "TIMEOUT"
    assert live.signals["unwind_tension_N"] is None


def told(
    state: State, alarm: str = "NONE", blocked: str = "", differs: tuple[str, ...] = ()
) -> str:
    _, live = live_status(TickRow(record(state, 0, BY_NAME[alarm].code)), NEED, EUCLID)
    live = replace(live, blocked_by=blocked)
    return headline(StatusAnswer(line="L", state=state.name, config_differs=differs, live=live))


@each_case(
    ("line", "expected"),
    [
        (told(State.ACTIVE), "ACTIVE"),
        (
            told(State.OFF, blocked="WEB_INTACT=0"),
            "OFF, READY: blocked by WEB_INTACT=0: the PLC sees no web",
        ),
        (told(State.FAULT, "POWER_UP"), "FAULT: just started; arm when ready"),
        (
            told(State.FAULT, "POWER_UP", "PLC_STALE"),
            "FAULT: just started; blocked by PLC_STALE: PLC data is stale; "
            "check the PLC heartbeat and the network, then arm again",
        ),
        (
            told(State.FAULT, "TENSION_IMPLAUSIBLE", "TENSION_IMPLAUSIBLE (unwind_tension_N)"),
            "FAULT: TENSION_IMPLAUSIBLE (unwind_tension_N), tension is NaN, stuck or out of "
            "range; check the load cell, then arm again",
        ),
        (
            told(State.BYPASS, "APPLIED_DIFFERS", "APPLIED_DIFFERS (unwind: 0.02 m/s, 0 sent)"),
            "BYPASS: APPLIED_DIFFERS (unwind: 0.02 m/s, 0 sent), the PLC adds a correction to the "
            "drive that we did not send; find the station that writes to the PLC beside us, or "
            "the fault in the applied word, then arm again",
        ),
        (
            told(State.FAULT, "PLC_STALE", "LINE_RUN=0"),
            "FAULT: PLC_STALE, PLC data is stale; blocked by LINE_RUN=0: the line does not run",
        ),
        (
            told(State.FAULT, "OVERRUN"),
            "FAULT: OVERRUN, control cycle overran three times in a row, over now; "
            "check CPU load and real-time rights, then arm again",
        ),
        (told(State.BYPASS, "BYPASSED"), "BYPASS: bypassed, or a probe has ended; arm to return"),
        (told(State.ACTIVE, differs=("x",)), "ACTIVE  [CONFIG_DIFFERS]"),
    ],
)
def test_the_headline_says_what_blocks_and_what_to_do(line: str, expected: str) -> None:
    assert line == expected


@each_case(
    ("state", "blocked", "expected"),
    [
        (State.FAULT, "WEB_INTACT=0", "FAULT: blocked by WEB_INTACT=0: the PLC sees no web"),
        (State.BYPASS, "x: no", "BYPASS: blocked by x: no"),
        (State.OFF, "LINE_RUN=0", "OFF, READY: blocked by LINE_RUN=0: the line does not run"),
        (State.READY, "x: no", "READY: blocked by x: no"),
        (State.FADING, "", "FADING: not armed"),
    ],
)
def test_a_refused_arm_names_the_state_as_status_does(
    state: State, blocked: str, expected: str
) -> None:
    assert not_armed(state, blocked) == expected


def test_an_arm_that_nothing_stands_against_any_more_is_asked_for_again():
    """A control process that has just begun refuses until its first reading is judged."""
    over = refused_arm(State.FAULT, "")
    assert over == "FAULT: not armed; nothing stands against it now: arm again"
    assert refused_arm(State.FAULT, "PLC_STALE") == not_armed(State.FAULT, "PLC_STALE")


def test_an_objection_of_the_law_is_told_as_it_is() -> None:
    text = "unwind: no measured response; run the probe"
    assert explain(text) == text


def site_with(*blocks: Block, **given: object) -> Site:
    """Return Euclid with one actuator, the unwind, and these blocks on it."""
    unwind = EUCLID.actuators["unwind"].model_copy(update={"blocks": blocks, **given})
    return EUCLID.model_copy(update={"actuators": {"unwind": unwind}})


SITE = site_with(
    Block(roll="swrap", orders=(1,), settle_s=10, amp_limit_m_s=0.01),
    Block(roll="unwind", orders=(1, 2), settle_s=6, amp_limit_m_s=0.02),
)


def test_a_block_is_told_in_words_with_units_limit_and_frequency() -> None:
    row = {
        **record(State.ACTIVE, 0),
        "unwind.omega_rad_s": math.tau * 0.8,
        "unwind.quality": 0.0,
        "unwind.unwind_2x.amplitude_m_s": 0.004,
        "unwind.unwind_2x.phase_deg": -71.0,
        "unwind.unwind_2x.state": float(OrderState.CLAMPED),
        "unwind.unwind_2x.ripple_before": 1.5,
        "unwind.unwind_2x.ripple": math.nan,
    }
    (shown,) = live_status(TickRow(row), NEED, SITE)[1].blocks
    block = asdict(shown)
    assert block.pop("frequency_Hz") == pytest.approx(1.6)
    assert block == {
        "actuator": "unwind",
        "name": "unwind_2x",
        "roll": "unwind",
        "order": 2,
        "state": "CLAMPED",
        "why": "its limit is reached; raise it when the cause is known",
        "law": "blocks",
        "amplitude": 0.004,
        "unit": "m/s",
        "limit": 0.02,
        "phase_deg": -71.0,
        "encoder_deg": None,
        "out": None,
        "ripple_before": 1.5,
        "ripple": None,
        "benefit_dB": None,
        "ripple_unit": "N",
        "settle_s": 6,
        "share": None,
        "response_ratio": None,
    }


SHAPE_SITE = site_with(
    Block(roll="unwind", orders=(1, 3), settle_s=6, amp_limit_m_s=0.02),
    Block(roll="swrap", orders=(1,), settle_s=6, amp_limit_m_s=0.02),
    memory_turns=6.0,
    shape_limit_m=0.015,
)


def shape_record(name: str, state: OrderState, **more: float) -> dict[str, float]:
    said = {"shape_mm": 0.8, "phase_deg": 30.0, "ripple_before": 1.0, "ripple": 0.01}
    said |= {"state": float(state), "gain_of_P": 1.1, "share": 1.0, **more}
    return {f"unwind.{name}.{key}": value for key, value in said.items()}


def shapes(*rows: dict[str, float], swrap_Hz: float = 1.05) -> dict[str, dict[str, object]]:
    row = record(State.ACTIVE, 0) | {
        "unwind.omega_rad_s": math.tau * 0.8,
        "swrap.omega_rad_s": math.tau * swrap_Hz,
    }
    for more in rows:
        row |= more
    return {b.name: asdict(b) for b in live_status(TickRow(row), NEED, SHAPE_SITE)[1].blocks}


def test_an_order_of_a_shape_is_told_in_mm_with_its_benefit() -> None:
    block = shapes(shape_record("unwind_3x", OrderState.SETTLED))["unwind_3x"]
    assert (block["law"], block["amplitude"], block["unit"]) == ("shape", 0.8, "mm")
    assert block["limit"] == pytest.approx(15.0)
    assert block["benefit_dB"] == pytest.approx(40.0)
    assert block["frequency_Hz"] == pytest.approx(2.4)
    assert (block["share"], block["why"]) == (1.0, "")


@pytest.mark.parametrize(("applied", "out"), [(0.0, 0.0), (0.5, 0.2)])
def test_what_goes_out_of_an_order_is_its_share_of_what_the_guard_lets_out(
    applied: float, out: float
) -> None:
    row = shape_record("unwind_3x", OrderState.SETTLED, share=0.4)
    block = shapes(row | {"applied_ratio_unwind_m_s": applied})["unwind_3x"]
    assert block["out"] == pytest.approx(out)


def test_a_held_order_says_why() -> None:
    told_of = shapes(
        shape_record("unwind_1x", OrderState.RISING, share=0.0),
        shape_record("unwind_3x", OrderState.HELD_PHASE, share=0.0),
    )
    assert "rests for 20 turns" in str(told_of["unwind_1x"]["why"])
    assert "probe" in str(told_of["unwind_3x"]["why"])


def test_an_imbalance_is_told_as_a_torque() -> None:
    block = shapes(shape_record("imbalance", OrderState.SETTLED))["imbalance"]
    assert (block["unit"], block["order"], block["roll"]) == ("N m", 1, "unwind")
    assert block["amplitude"] == pytest.approx(0.08)  # 100 N m per metre


@pytest.mark.parametrize(("swrap_Hz", "meets"), [(0.81, True), (1.05, False)])
def test_orders_that_the_memory_cannot_tell_apart_are_said_to_meet(
    swrap_Hz: float, meets: bool
) -> None:
    rows = (
        shape_record("unwind_1x", OrderState.STALLED),
        shape_record("swrap_1x", OrderState.STALLED),
    )
    told_of = shapes(*rows, swrap_Hz=swrap_Hz)
    assert ("meets swrap_1x" in str(told_of["unwind_1x"]["why"])) is meets


def test_every_state_of_a_block_has_a_word() -> None:
    assert set(WORDS) == set(OrderState)
