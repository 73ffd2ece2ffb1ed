"""The operator's page: outline in mm, angles, tables, and words that cannot break it."""

from __future__ import annotations

import math
import re
from html.parser import HTMLParser
from typing import Any

import pytest

from aff_runtime.app.report.block_status import blocks
from aff_runtime.app.report.roll_page import CENTRE, ROOM, ROUND, outline_mm, page, plot
from aff_runtime.app.report.status_answer import StatusAnswer, read_answer
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.cli.roll import ATTEMPTS, at_the_encoders_zero
from aff_runtime.core.phase import Source
from tests.aff_runtime.cli.test_screens import answer, shape_block, shown
from tests.parameter_records import EUCLID


def order(n: int, mm: float, deg: float, **more: Any) -> dict[str, Any]:
    return shape_block(n, amplitude=mm, encoder_deg=deg, **more)


def test_the_outline_is_the_sum_of_the_orders() -> None:
    outline = outline_mm(shown(order(1, 0.5, 30.0), order(2, 0.2, -90.0)))
    for at in (0, 45, 200):
        turn = math.radians(at)
        expected = 0.5 * math.cos(turn + math.radians(30.0)) + 0.2 * math.sin(2.0 * turn)
        assert outline[at] == pytest.approx(expected, abs=1e-12)


def test_the_farthest_place_is_drawn_at_the_largest_deviation_and_its_angle() -> None:
    text = plot("unwind", "unwind", shown(*(order(n, 0.4, -60.0 * n) for n in (1, 2, 3))))
    path = re.search(r'points="([^"]+)"', text)
    assert path is not None
    points = [tuple(map(float, pair.split(","))) for pair in path[1].split()]
    far = max(range(360), key=lambda i: math.hypot(points[i][0] - CENTRE, points[i][1] - CENTRE))
    x, y = points[far]
    assert far == 60  # all orders have their crest there
    assert math.degrees(math.atan2(CENTRE - y, x - CENTRE)) == pytest.approx(60.0, abs=0.1)
    assert math.hypot(x - CENTRE, y - CENTRE) == pytest.approx(ROUND + ROOM, abs=0.1)
    assert "+1.20 mm" in text
    assert "where the encoder reads zero" in text


def test_without_the_encoders_zero_the_page_does_not_claim_it() -> None:
    rows = [order(n, 0.4, 0.0) | {"encoder_deg": None} for n in (1, 2, 3)]
    assert "where the service began to count" in plot("unwind", "unwind", shown(*rows))


def test_the_angle_at_the_encoders_zero_is_that_of_the_law_turned_by_its_origin() -> None:
    """The law's angle is 40 deg ahead of the encoder: order 3 is 120 deg ahead."""
    record = {
        "fresh": 1.0,
        "unwind.source": float(Source.ENCODER),
        "unwind.theta_rad": math.radians(50.0),
        "unwind_angle_rad": math.radians(10.0) + 400.0 * math.tau,
        "unwind.omega_rad_s": 5.0,
        "unwind.unwind_3x.state": 2.0,
        "unwind.unwind_3x.phase_deg": 100.0,
        "unwind.unwind_3x.shape_mm": 0.3,
    }
    (row,) = blocks(TickRow(record), EUCLID)
    assert row.encoder_deg == pytest.approx(-140.0)
    for lost in ({"fresh": 0.0}, {"unwind.source": float(Source.LINE_SPEED)}):
        (row,) = blocks(TickRow(record | lost), EUCLID)
        assert row.encoder_deg is None


class Tags(HTMLParser):
    """Collects open tags and text."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.words: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: Any) -> None:
        self.tags.append(tag)

    def handle_data(self, data: str) -> None:
        self.words.append(data)


def test_the_page_tells_every_order_what_it_gains_and_why_one_rests() -> None:
    why = "makes ripple larger than without; it fades and rests for 20 turns"
    rows = [order(n, 0.4, 0.0) for n in (1, 2)] + [order(3, 0.1, 5.0, out=0.0, why=why)]
    plain = answer(1)["blocks"][0] | {"benefit_dB": 3.2, "actuator": "swrap_follower"}
    given = {**answer(0), "line": "<b>1 & 2", "blocks": [*rows, plain], "crossings": ["in 4 min"]}
    seen = Tags(page(read_answer(given)))
    assert seen.tags.count("svg") == 1
    assert seen.tags.count("tr") == 2 + 4
    assert "b" not in seen.tags
    assert {why, "next: in 4 min", "unwind_3x", "0 %", "41.3", "1.23 mm/s"} <= set(seen.words)


def test_a_line_without_a_shape_says_so() -> None:
    assert "No roll is known in mm" in page(read_answer(answer(2)))
    assert "No roll is known in mm" in page(read_answer({**answer(0), "state": "STARTING"}))


def test_a_tick_without_a_fresh_reading_is_asked_again_and_not_for_ever() -> None:
    asked: list[str] = []

    def ask() -> StatusAnswer:
        asked.append("status")
        block = shape_block(1, encoder_deg=12.0 if len(asked) == 3 else None)
        return read_answer({**answer(0), "blocks": [block]})

    assert at_the_encoders_zero(ask).blocks[0].encoder_deg == 12.0
    assert len(asked) == 3
    at_the_encoders_zero(ask)
    assert len(asked) == 3 + 1 + ATTEMPTS
