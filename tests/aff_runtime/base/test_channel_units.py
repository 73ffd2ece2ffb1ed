"""The end of a name says its unit, once for every reader."""

from aff_runtime.base.channel_units import (
    suffix_of_unit,
    unit_of_channel,
    unit_of_name,
    without_unit,
)
from tests.each_case import each_case


@each_case(
    ("name", "unit"),
    [
        ("unwind_tension_N", "N"),
        ("unwind_torque_N_m", "N m"),
        ("line_speed_m_s", "m/s"),
        ("unwind_speed_rad_s", "rad/s"),
        ("unwind_angle_rad", "rad"),
        ("unwind_radius_m", "m"),
        ("unwind_supplier_number", ""),
    ],
)
def test_the_longest_end_that_fits_is_a_channels_unit(name, unit):
    assert unit_of_channel(name) == unit_of_name(name) == unit
    assert name.endswith("_" + suffix_of_unit(unit))


def test_a_time_or_a_frequency_is_a_numbers_unit_and_no_channels():
    assert [unit_of_name(name) for name in ("delay_s", "corner_Hz", "ratio")] == ["s", "Hz", ""]
    assert [unit_of_channel(name) for name in ("delay_s", "corner_Hz", "N")] == [None] * 3


def test_a_name_loses_its_unit_and_nothing_else():
    assert without_unit("unwind_torque_N_m") == "unwind_torque"
    assert without_unit("nip") == "nip"
