"""A row of the ring as objects: what each column that the loop writes has become."""

from __future__ import annotations

import math

import pytest

from aff_runtime.app.report.tick_row import Channel, CorrectionDue, TickRow
from aff_runtime.base.signals import Outcome, State, StateBits, Status
from aff_runtime.core.phase import Source
from aff_runtime.loop.record import record_columns
from tests.each_case import each_case

S = 10**9
CHANNELS = ("unwind_tension_N", "line_speed_m_s")
OUTPUTS = ("unwind_m_s", "rewind_N_m")
LAW = ("unwind.omega_rad_s", "unwind.unwind_1x.state", "probe.stage")
COLUMNS = record_columns(CHANNELS, OUTPUTS, LAW)
ROW = TickRow({name: float(at) for at, name in enumerate(COLUMNS)})


def at(name: str) -> float:
    """Return the number that the column of this name has in ``ROW``."""
    return float(COLUMNS.index(name))


def test_the_channels_are_those_of_the_site_and_no_other_column() -> None:
    assert ROW.channels == tuple(Channel(name=name, value=at(name)) for name in CHANNELS)


def test_a_correction_comes_with_the_share_let_out_in_the_tick_before() -> None:
    assert ROW.corrections == tuple(
        CorrectionDue(
            name=f"correction_{output}",
            value=at(f"correction_{output}"),
            applied_ratio=at(f"applied_ratio_{output}"),
        )
        for output in OUTPUTS
    )
    assert ROW.applied_ratio("unwind") == at("applied_ratio_unwind_m_s")
    assert ROW.applied_ratio("rewind") == at("applied_ratio_rewind_N_m")
    assert math.isnan(ROW.applied_ratio("nobody"))


def test_timing_is_told_by_name() -> None:
    timing = ROW.timing
    assert (timing.plc_age_s, timing.io_us) == (at("age_s"), at("io_us"))
    assert (timing.tick_us, timing.missed_count) == (at("tick_us"), at("missed_count"))


@each_case(
    ("bits", "live"),
    [
        (StateBits(0), False),
        (StateBits.ARMED, True),
        (StateBits.ACTIVE, True),
        (StateBits.FADING, True),
    ],
)
def test_what_a_tick_says_of_state_exchange_and_output_is_read_by_name(
    bits: StateBits, live: bool
) -> None:
    tick = TickRow(
        {"state": 4.0, "state_bits": float(bits), "outcome": 1.0, "fresh": 1.0, "alarm": 3.0}
    )
    assert (tick.state, tick.outcome, tick.alarm_code) == (State(4), Outcome(1), 3)
    assert tick.is_fresh
    assert tick.is_live is live


def test_an_empty_row_has_no_state_and_no_age() -> None:
    empty = TickRow({})
    for name in ("state", "is_live", "alarm_code", "status_word", "outcome"):
        with pytest.raises(ValueError, match="NaN"):
            getattr(empty, name)
    assert (empty.is_fresh, empty.is_remote) == (False, False)
    assert (empty.channels, empty.corrections) == ((), ())
    assert math.isnan(empty.plc_age_s)


def test_the_age_of_a_tick_is_not_that_of_the_data_in_it() -> None:
    """It was made 2.5 s after the start, of data that stood still for 0.3 s; now is 4 s after."""
    tick = TickRow({"time_s": 2.5, "age_s": 0.3, "status": float(Status.REMOTE)})
    assert tick.tick_age_s(1 * S, 5 * S) == pytest.approx(1.5)
    assert math.isnan(tick.tick_age_s(0, 5 * S))
    assert (tick.plc_age_s, tick.timing.plc_age_s) == (0.3, 0.3)
    assert tick.status_word == Status.REMOTE
    assert tick.is_remote


def test_a_roll_that_is_not_followed_has_no_source_and_no_speed() -> None:
    turn = TickRow({"unwind.source": float(Source.ENCODER), "unwind.omega_rad_s": 5.0})
    assert turn.roll("unwind").source is Source.ENCODER
    assert turn.roll("unwind").omega_rad_s == 5.0
    assert turn.roll("swrap").source is None
    assert math.isnan(turn.roll("swrap").theta_rad)
    assert math.isnan(TickRow({"x_N": None}).number("x_N"))
