"""What status and top show of one and the same answer."""

from __future__ import annotations

from typing import Any

from aff_runtime.app.report.block_status import BlockStatus
from aff_runtime.app.report.status import explain
from aff_runtime.app.report.status_answer import read_answer
from aff_runtime.base.events import BY_NAME
from aff_runtime.cli.status import block_lines, is_alarm, lines
from aff_runtime.cli.top import screen


def block(order: int) -> dict[str, Any]:
    return {
        "actuator": "unwind",
        "name": f"swrap_follower_with_a_long_name_{order}x",
        "state": "HELD phase",
        "frequency_Hz": 1.05234 * order,
        "amplitude": 0.00123456,
        "unit": "m/s",
        "limit": 0.02,
        "phase_deg": -122.4567,
        "ripple_before": 13.456789,
        "ripple": None if order == 2 else 0.0123456,
        "ripple_unit": "N",
    }


def answer(blocks: int = 30) -> dict[str, Any]:
    signals: dict[str, float | None] = {
        "age_s": 0.004,
        "io_us": 150.0,
        "tick_us": 250.0,
        "missed_count": 0.0,
        "unwind_tension_N": 88.9,
        "line_speed_m_s": 1.016,
        "correction_unwind_m_s": 0.0014,
        "applied_ratio_unwind_m_s": 0.5,
    }
    return {
        "line": "Euclid",
        "state": "ACTIVE",
        "blocked_by": "",
        "alarm": {"code": 0},
        "comm": "OK",
        "config_hash": "3f9a" * 16,
        "config_differs": ["site.yaml:7:3  line: x"],
        "signals": signals,
        "blocks": [block(n) for n in range(1, blocks + 1)],
        "recorder": {"folder": "/r/20260101T000000Z_E", "rows": 10, "rows_lost": 3, "alive": True},
    }


def test_the_screen_never_exceeds_80_columns_and_24_rows() -> None:
    for blocks in (0, 1, 30):
        rows = screen(read_answer(answer(blocks)))
        assert len(rows) <= 24
        assert max(map(len, rows)) <= 80


def test_the_screen_works_before_the_first_record() -> None:
    rows = screen(read_answer({**answer(), "state": "STARTING", "signals": {}}))
    assert "STARTING" in rows[0]


def test_half_of_the_wish_going_out_fills_half_of_the_bar() -> None:
    (row,) = [row for row in screen(read_answer(answer(0))) if row.startswith("correction_unwind")]
    assert row.count("#") == row.count(".") - "0.0014".count(".")


def test_a_block_is_told_with_units_and_its_state_in_a_word() -> None:
    table = list(block_lines(read_answer(answer(2)).blocks))
    assert table[0].split() == ["unwind", "Hz", "mm/s|limit", "deg", "N", "before>now", "state"]
    name, *rest = table[1].split()
    assert name.endswith("_1x")
    assert rest == ["1.05", "1.23|20", "-122", "13.5>0.0123", "HELD", "phase"]
    assert "13.5>-" in table[2]
    assert max(map(len, table)) <= 80


def test_the_alarm_code_is_for_alarms_only() -> None:
    def fault(code: int) -> dict[str, Any]:
        return {**answer(0), "state": "FAULT", "alarm": {"code": code}}

    assert not is_alarm(read_answer(fault(BY_NAME["POWER_UP"].code)))
    assert is_alarm(read_answer(fault(BY_NAME["PLC_STALE"].code)))
    assert not is_alarm(read_answer({**answer(0), "state": "OFF"}))
    for name, alarms in (("BYPASSED", False), ("APPLIED_DIFFERS", True)):
        resting = {**answer(0), "state": "BYPASS", "alarm": {"code": BY_NAME[name].code}}
        assert is_alarm(read_answer(resting)) is alarms


def test_the_status_says_what_works_the_law_out() -> None:
    said = {**answer(0), "meta": {"versions": {"arithmetic": "compiled"}}}
    assert "law      by compiled" in list(lines(read_answer(said)))


def test_all_that_stands_against_an_armed_output_is_told_and_what_it_means() -> None:
    said = {**answer(0), "state": "OFF", "blocked_by": "LINE_RUN=0"}
    said["also_blocking"] = ["WEB_INTACT=0", "SPLICE"]
    first, *others = list(lines(read_answer(said)))[:3]
    assert "blocked by LINE_RUN=0" in first
    assert [one.strip() for one in others] == [
        f"and by {explain(name)}" for name in ("WEB_INTACT=0", "SPLICE")
    ]


def test_lost_rows_and_a_differing_file_are_told() -> None:
    text = "\n".join(lines(read_answer(answer(0))))
    assert "3 LOST" in text
    assert "site.yaml:7:3" in text
    assert "[CONFIG_DIFFERS]" in text


def test_a_dead_recorder_is_told() -> None:
    text = "\n".join(
        lines(read_answer({**answer(0), "recorder": {"folder": "x", "alive": False}}))
    )
    assert "RECORDER IS GONE" in text


def shape_block(order: int, **more: Any) -> dict[str, Any]:
    return block(order) | {
        "law": "shape",
        "name": f"unwind_{order}x",
        "roll": "unwind",
        "order": order,
        "amplitude": 0.7234,
        "unit": "mm",
        "limit": 15.0,
        "share": 1.0,
        "out": 1.0,
        "benefit_dB": 41.3,
        "state": "settled",
        "why": "",
        **more,
    }


def shown(*blocks: dict[str, Any]) -> tuple[BlockStatus, ...]:
    return read_answer({**answer(0), "blocks": blocks}).blocks


def test_an_order_of_a_shape_shows_mm_angle_share_and_benefit() -> None:
    table = list(block_lines(shown(shape_block(1), shape_block(2, out=None, benefit_dB=None))))
    assert table[0].split() == [
        "unwind",
        "Hz",
        "mm",
        "deg",
        "out",
        "N",
        "before>now",
        "dB",
        "state",
    ]
    expected = "unwind_1x 1.05 0.723 -122 100% 13.5>0.0123 41 settled"
    assert table[1].split() == expected.split()
    assert table[2].split()[-3:] == ["13.5>-", "-", "settled"]
    assert max(map(len, table)) <= 80


def test_blocks_held_for_one_reason_are_told_in_one_line() -> None:
    held = [shape_block(n, why="not sure; probe") for n in (15, 16)]
    told = list(
        lines(
            read_answer({**answer(0), "blocks": [shape_block(1), *held], "shapes": ["kept in x"]})
        )
    )
    assert "why      unwind unwind_15x unwind_16x: not sure; probe" in told
    assert "shape    kept in x" in told


def test_the_screen_keeps_the_low_orders_of_every_roll() -> None:
    blocks = [shape_block(n) for n in range(1, 31)]
    blocks.append(shape_block(1, name="swrap_1x", roll="swrap"))
    rows = screen(read_answer({**answer(0), "blocks": blocks}))
    assert len(rows) <= 24
    assert any("swrap_1x" in row for row in rows)
    assert not any("unwind_30x" in row for row in rows)


def test_the_next_meeting_of_two_rolls_is_told_and_the_screen_has_a_row_for_it() -> None:
    meets = "unwind: in about 4 min unwind 1x meets swrap_follower 1x at radius 0.1537 m"
    given = {**answer(30), "crossings": [meets]}
    assert f"next     {meets}" in list(lines(read_answer(given)))
    rows = screen(read_answer(given))
    (row,) = [row for row in rows if row.startswith("next")]
    assert "in about 4 min unwind 1x meets swrap_follower 1x" in row
    assert len(rows) <= 24
    assert max(map(len, rows)) <= 80
