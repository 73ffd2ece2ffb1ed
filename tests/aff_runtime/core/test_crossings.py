"""Where orders meet, against the source's line."""

import pytest

from aff_runtime.core.crossings import crossings
from aff_runtime.core.params import RollParams

INCH = 0.0254


def test_the_sources_line_meets_at_its_own_test_radius():
    unwind = RollParams(name="unwind", radius="r", radius_min_m=2 * INCH, radius_max_m=10 * INCH)
    swrap = RollParams(name="swrap", radius_m=6.05 * INCH)
    found = crossings([unwind, swrap], {"unwind": (1, 2, 3, 4), "swrap": (1, 2, 3)})
    by_orders = {(c.order, c.other_order): c.radius_m / INCH for c in found}
    assert by_orders[1, 1] == pytest.approx(6.05)
    assert by_orders[3, 2] == pytest.approx(9.075)
    assert by_orders[4, 3] == pytest.approx(8.0667, abs=1e-3)
    assert (2, 1) not in by_orders  # 12.1 in is beyond this roll
    assert [c.radius_m for c in found] == sorted((c.radius_m for c in found), reverse=True)


def test_rolls_of_fixed_radius_have_no_crossing():
    rolls = [RollParams(name="a", radius_m=0.1), RollParams(name="b", radius_m=0.1)]
    assert crossings(rolls, {"a": (1,), "b": (1,)}) == ()
