"""What the guard takes from the site file."""

from __future__ import annotations

import pytest

from aff_runtime.app.wiring.site_to_guard import guard_params
from aff_runtime.config.loader import load_site, read_site
from tests.aff_runtime.config.shipped import EUCLID, edited

SPLICE = "    resets_on: splice\n"


def renamed(tmp_path, name, winding=""):
    """Return the shipped site with its unwind's roll under another name."""
    text = EUCLID.read_text()
    head, tail = text.split("\nrolls:\n")
    tail = tail.replace("  unwind:\n", f"  {name}:\n", 1).replace(SPLICE, SPLICE + winding)
    tail = tail.replace("roll: unwind", f"roll: {name}")
    path = tmp_path / "site.yaml"
    path.write_text(f"{head}\nrolls:\n{tail}")
    return path


@pytest.mark.parametrize(
    ("name", "winding", "shrinks"),
    [
        ("unwind", "", True),
        ("rewind", "", False),
        ("rewind_2", "", False),
        ("aufwickler", "", True),
        ("aufwickler", "    winding: rewind\n", False),
        ("rewind", "    winding: unwind\n", True),
    ],
)
def test_a_radius_may_grow_where_the_roll_winds(tmp_path, name, winding, shrinks):
    (radius,) = guard_params(load_site(renamed(tmp_path, name, winding))).radii
    assert radius.shrinks is shrinks


@pytest.mark.parametrize(
    ("name", "winding", "said"),
    [
        ("unwind", "", False),
        ("rewind", "", False),
        ("aufwickler", "", True),
        ("aufwickler", "    winding: unwind\n", False),
    ],
)
def test_what_is_assumed_of_a_roll_is_said(tmp_path, name, winding, said):
    warnings = {one.path: one.text for one in read_site(renamed(tmp_path, name, winding)).warnings}
    assert ("counts as an unwind" in warnings.get(f"rolls.{name}", "")) is said


def test_a_radius_that_no_splice_resets_is_not_judged(tmp_path):
    path = edited(tmp_path, (SPLICE, ""))
    assert guard_params(load_site(path)).radii == ()
