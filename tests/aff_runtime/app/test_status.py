"""Status in words."""

from __future__ import annotations

import math

import pytest

from aff_runtime.app.status import describe, headline, missing_permissive
from aff_runtime.base.signals import State, Status

NEED = ["LINE_RUN", "WEB_INTACT", "AFF_ENABLE_REQUEST"]


def record(state: State, status: int, alarm: int = 0) -> dict[str, float]:
    return {
        "state": state,
        "status": status,
        "alarm": alarm,
        "outcome": 1,
        "unwind_tension_N": math.nan,
    }


@pytest.mark.parametrize(
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
    answer = describe(record(State.FAULT, 0, 15), NEED)
    assert answer["state"] == "FAULT"
    assert answer["alarm"]["name"] == "POWER_UP"
    assert answer["comm"] == "TIMEOUT"
    assert answer["signals"]["unwind_tension_N"] is None


def test_the_headline_says_what_blocks_and_what_to_do() -> None:
    off = describe(record(State.OFF, Status.LINE_RUN), NEED)
    assert headline(off) == "OFF, READY: blocked by WEB_INTACT=0"
    fault = describe(record(State.FAULT, 255, 1), NEED)
    assert "PLC_STALE" in headline(fault)
    assert "arm again" in headline(fault)
    assert headline({**off, "config_differs": ["x"]}).endswith("[CONFIG_DIFFERS]")
