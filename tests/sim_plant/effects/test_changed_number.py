"""A declared number that changes at a moment, against a line that is handed over by hand."""

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.line.arrays.corrections import changeable_numbers, value_of
from tests.sim_plant.effects.running import SPEED_M_S, TENSION_N, effect, euclid, line, run

SAMPLE_S, FROM_S, ROWS = 0.005, 0.5, 200
NUMBERS = {number.name: number for number in changeable_numbers(euclid())}
WOUND_AT = "web.wound_in_tension_N"
"""What the web is wound at is also divided by its modulus: two changes of it do not add."""


def amount(kind: str) -> float:
    """Return a change that every loop survives: a thousandth of a draw is newtons already."""
    return {"draw": 1e-4, "offset": 2.0}.get(kind, 0.05)


@pytest.mark.parametrize("names", [NUMBERS.keys() - {WOUND_AT}, {WOUND_AT}], ids=["all", "wound"])
def test_the_line_runs_on_as_one_whose_numbers_were_changed_by_hand_between_two_runs(
    names: set[str],
) -> None:
    changed = {name: amount(NUMBERS[name].kind) for name in sorted(names)}
    there = [effect("changed_number", n, change=c, from_s=FROM_S) for n, c in changed.items()]
    made = run(*there, settle_s=2.0, seconds=ROWS * SAMPLE_S)
    by_hand, first = line(settle_s=2.0), round(FROM_S / SAMPLE_S)
    before = by_hand.simulate(np.full(first, SPEED_M_S), np.full(first, TENSION_N))
    for name, change in changed.items():
        NUMBERS[name].shift(by_hand.arrays, change)
    rest = ROWS - first
    after = by_hand.simulate(np.full(rest, SPEED_M_S), np.full(rest, TENSION_N))
    for channel in ("span_tension_N", "unwind_tension_N", "pull_roll_speed_m_s"):
        handed = np.concatenate([before[channel], after[channel]])
        assert made[channel] == pytest.approx(handed, rel=1e-12), channel


def test_a_number_that_is_read_once_cannot_change_at_a_moment() -> None:
    radius = "rollers.unwind.radius_m"
    assert radius not in NUMBERS
    with pytest.raises(PlantError, match="leave out from_s"):
        run(effect("changed_number", radius, change=0.01, from_s=1.0))


def test_a_number_is_told_in_its_own_unit() -> None:
    declared = euclid()
    gain = declared.control.drives[0].K_ref_rad_s
    drive = NUMBERS[f"control.drives.{declared.control.drives[0].roller}.K_ref_rad_s"]
    assert value_of(declared, drive, 0.2) == pytest.approx(1.2 * gain)
    assert value_of(declared, NUMBERS[WOUND_AT], -0.5) == pytest.approx(
        0.5 * declared.web.wound_in_tension_N
    )
    zero = next(number for name, number in NUMBERS.items() if name.endswith(".offset"))
    assert value_of(declared, zero, 3.0) == pytest.approx(3.0)
