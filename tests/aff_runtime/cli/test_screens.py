"""What status and top show of one and the same answer."""

from __future__ import annotations

from typing import Any

from aff_runtime.cli.status import lines
from aff_runtime.cli.top import screen


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
    for n in range(1, blocks + 1):
        block = f"unwind.swrap_follower_with_a_long_name_{n}x"
        signals |= {
            f"{block}.amplitude_m_s": 0.00123456,
            f"{block}.phase_deg": -122.4567,
            f"{block}.state": 2.0,
            f"{block}.ripple_before": 3.456789,
            f"{block}.ripple": None,
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
        "recorder": {"folder": "/r/20260101T000000Z_E", "rows": 10, "rows_lost": 3, "alive": True},
    }


def test_the_screen_never_exceeds_80_columns_and_24_rows() -> None:
    for blocks in (0, 1, 30):
        rows = screen(answer(blocks))
        assert len(rows) <= 24
        assert max(map(len, rows)) <= 80


def test_the_screen_works_before_the_first_record() -> None:
    rows = screen({**answer(), "state": "STARTING", "signals": {}})
    assert "STARTING" in rows[0]


def test_half_of_the_wish_going_out_fills_half_of_the_bar() -> None:
    (row,) = [row for row in screen(answer(0)) if row.startswith("correction_unwind")]
    assert row.count("#") == row.count(".") - "0.0014".count(".")


def test_lost_rows_and_a_differing_file_are_told() -> None:
    text = "\n".join(lines(answer(0)))
    assert "3 LOST" in text
    assert "site.yaml:7:3" in text
    assert "[CONFIG_DIFFERS]" in text


def test_a_dead_recorder_is_told() -> None:
    text = "\n".join(lines({**answer(0), "recorder": {"folder": "x", "alive": False}}))
    assert "RECORDER IS GONE" in text
