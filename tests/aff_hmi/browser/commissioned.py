"""A person who commissions at the screen alone: what a test sees of it."""

from __future__ import annotations

from typing import Any

from benchmarks.wizard import technician
from benchmarks.wizard.answers import LINE_ANSWERS
from benchmarks.wizard.fresh_line import FreshLine
from tests.aff_hmi.browser.eyes import Page

# what the displays of the simulated Euclid line show at 200 FPM, and where its manual has words
ANSWERS = {
    **LINE_ANSWERS,
    "host": "127.0.0.1",
    "count": "24",
    "unwind_tension_N.display": "89.5 N",  # word 6, a radius, fits it as well at any second
    "tension_ref_N.display": "88.96 N",
    "tension_ref_N.pick": "w4",
    "line_speed_m_s.display": "200 FPM",
    "line_speed_m_s.pick": "w5",
    "unwind_radius_m.pick": "w6",
    "swrap_follower_speed_m_s.display": "200 FPM",
    "swrap_follower_speed_m_s.pick": "w7",
    "pullroll_tension_N.display": "91 N",
    "pullroll_tension_N.pick": "w9",
    "probe": "0.02",
    "status.word": "1",
    "roll_id": "8",
    "echo": "15",
    "applied.unwind": "16",
    "applied.swrap_follower": "17",
}


class Technician(technician.Technician):
    """Somebody with a password and a browser, whose page is looked at."""

    def __init__(self, chromium: Any, line: FreshLine, **context: Any) -> None:
        self.screen = Page(chromium, f"{line.url}login?lang=en", **context)
        super().__init__(self.screen.page, line)
