"""What the interview proposes, by what was found before."""

from __future__ import annotations

from aff_runtime.app.setup.asking.draft import Draft
from aff_runtime.app.setup.asking.drive_questions import law_question
from tests.each_case import each_case

WORD = {"address": 3, "type": "i16", "order": "", "scale": "0.001"}


@each_case(
    ("found", "law"),
    [
        ({"unwind_angle_rad", "unwind_radius_m"}, "shape"),
        ({"unwind_radius_m"}, "blocks"),
        ({"unwind_angle_rad"}, "blocks"),
        (set(), "blocks"),
    ],
)
def test_the_law_of_the_shape_is_proposed_where_angle_and_radius_are_seen(
    found: set[str], law: str
) -> None:
    draft = Draft(words=dict.fromkeys(found, WORD))
    assert law_question(draft).default == law
