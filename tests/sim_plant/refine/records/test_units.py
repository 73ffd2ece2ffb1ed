import math

import pytest

from sim_plant.refine.records.units import TO_SI, canonical, split_header
from tests.each_case import each_case


@each_case(
    ("header", "expected"),
    [
        ("line_speed_m_s", ("line_speed", "m_s")),
        ("unwind_speed_rad_s", ("unwind_speed", "rad_s")),
        ("unwind_tension_N", ("unwind_tension", "N")),
        ("line speed [fpm]", ("line_speed", "fpm")),
        ("Belt Velocity (m/s)", ("Belt_Velocity", "m_s")),
        ("Pitch Moment (Nm)", ("Pitch_Moment", "N_m")),
        ("S1", ("S1", "")),
    ],
)
def test_a_header_splits_into_name_and_unit(header, expected):
    assert split_header(header) == expected


def test_factors_are_those_of_the_units():
    assert TO_SI["lbf"][1] == pytest.approx(0.45359237 * 9.80665)
    assert TO_SI["rpm"][1] == pytest.approx(2.0 * math.pi / 60.0)
    assert TO_SI["fpm"][1] == pytest.approx(0.3048 / 60.0)


def test_spellings_of_one_unit_meet():
    assert canonical("m/s") == canonical(" M/S ") == "m_s"
    assert canonical("ft/min") == "fpm"
