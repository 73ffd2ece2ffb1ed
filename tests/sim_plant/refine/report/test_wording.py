import math

import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.report.verdict import Moment, NumberChange
from sim_plant.refine.report.wording import (
    coordinate_text,
    label,
    number_rows,
    place_words,
    scaled,
    size_of,
    tells_size,
    unit_of,
)
from tests.each_case import each_case
from tests.sim_plant.refine.small import finding


@each_case(
    ("value", "unit", "shown"),
    [
        (2.5e-4, "m", (0.25, "mm")),
        (1.5, "m", (1.5, "m")),
        (0.0449, "s", (44.9, "ms")),
        (math.pi, "rad", (180.0, "deg")),
        (0.9, "1", (0.9, "")),
        (3.0, "N m", (3.0, "N m")),
    ],
)
def test_a_value_is_shown_in_the_unit_that_reads_best(value, unit, shown):
    factor, name = scaled(value, unit)
    assert (pytest.approx(factor * value), name) == shown


def test_no_label_keeps_its_unit_and_none_is_empty():
    for name, effect in BY_NAME.items():
        for parameter, known in effect.accepts.items():
            text = label(parameter, unit_of(name, parameter))
            assert text
            if known.unit not in ("", "1"):
                assert len(text) < len(parameter), (name, parameter)
                assert not text.endswith((" m", " s", " N", " rad", " Hz", " kg")), text


def test_interval_and_value_share_a_unit_also_where_they_lie_on_both_sides_of_it():
    found = finding(
        "splice", "web", {"at_length_m": 0.09}, interval95={"at_length_m": (0.05, 0.13)}
    )
    assert size_of(found) == "at length 90 mm (95 %: 50 to 130)"


def test_a_number_that_the_library_set_is_not_told_as_found():
    found = finding(
        "roll_bounce",
        "unwind",
        {"mass_kg": 20.0, "order": 4.0, "frequency_Hz": 3.4},
        interval95={"frequency_Hz": (3.39, 3.41)},
    )
    assert size_of(found) == (
        "mass 20 kg (assumed; the others hold for it), order 4, "
        "frequency 3.40 Hz (95 %: 3.39 to 3.41)"
    )


def test_a_number_that_the_library_set_may_be_what_the_record_admits():
    numbers = {"mass_kg": 20.0, "frequency_Hz": 3.4}
    found = finding("roll_bounce", "unwind", numbers, interval95={"mass_kg": (15.0, 32.0)})
    assert size_of(found) == "mass 20 kg (assumed; it may be 15 to 32), frequency 3.4 Hz"


def test_a_number_that_was_fitted_is_not_told_as_assumed_where_the_library_begins():
    numbers = {"slope_s_m": 0.002, "threshold_m_s": 0.0}
    ranges = {"slope_s_m": (0.001, 0.003), "threshold_m_s": (0.0, 0.8)}
    found = finding("slip", "pull_roll", numbers, interval95=ranges)
    assert size_of(found).endswith("threshold 0 m/s (95 %: 0 to 0.8)")
    begun = finding("slip", "pull_roll", numbers, interval95={"slope_s_m": (0.001, 0.003)})
    assert size_of(begun).endswith("threshold 0 m/s (assumed; the others hold for it)")


def test_a_strength_that_no_record_shows_is_told_by_what_it_may_be():
    found = finding(
        "shaft_compliance_backlash",
        "rewind",
        {"backlash_rad": 0.0, "compliance_rad_N_m": 0.003},
        interval95={"backlash_rad": (0.0, 0.004), "compliance_rad_N_m": (0.0029, 0.0031)},
    )
    assert size_of(found).startswith("backlash not shown: between 0 and 0.229 deg, compliance")


def test_components_and_angles_are_no_size():
    found = finding(
        "eccentric_roller",
        "R6",
        {"cos_m": 3e-4, "sin_m": 4e-4, "eccentricity_m": 5e-4, "angle_rad": 0.9273},
    )
    assert size_of(found) == "eccentricity 0.5 mm"
    assert [n.unit for n in number_rows(found)] == ["mm", "mm", "mm", "deg"]
    assert number_rows(found)[3].value == "53.13"
    told = [n.key for n in number_rows(found) if tells_size(found.place.effect, n.key)]
    assert told == ["eccentricity_m"]


def test_an_outline_without_a_name_is_told_by_its_largest_orders():
    orders = {f"{part}{n}_m": 1e-3 / n * share for n in range(1, 9) for part, share in PARTS}
    found = finding("out_of_round_roll", "unwind", {"shape": "orders", **orders})
    told = ", ".join(f"{n}x {1.0 / n:.4g} mm" for n in range(1, 7))
    assert size_of(found) == f"orders, {told}"


def test_details_of_a_named_outline_are_not_told_beside_its_size():
    details = {"cos1_m": 1e-4, "sin1_m": 0.0}
    found = finding("out_of_round_roll", "unwind", {"shape": "flat", "size_m": 0.012, **details})
    assert size_of(found) == "flat, depth 12 mm"


PARTS = (("cos", 0.6), ("sin", -0.8))


@each_case(
    ("value", "ends", "said"),
    [
        (0.2452, (0.2343, 0.258), "0.25 (95 %: 0.23 to 0.26)"),
        (1.00812, (1.00784, 1.0084), "1.0081 (95 %: 1.0078 to 1.0084)"),
        (99.7, (99.6999, 99.7001), "99.7000 (95 %: 99.6999 to 99.7001)"),
        (34.4, (26.08, 42.73), "34 (95 %: 26 to 43)"),
        (-0.04, (-0.4, 0.3), "0.0 (95 %: -0.4 to 0.3)"),
    ],
)
def test_digits_end_where_the_interval_says_nothing_more(value, ends, said):
    found = finding("radius_error", "unwind", {"ratio": value}, interval95={"ratio": ends})
    assert size_of(found) == f"ratio {said}"


def test_a_number_that_may_be_of_either_sign_is_no_size():
    numbers = {"shape": "flat", "size_m": 0.012, "unwound_m": 0.0025}
    ends = {"size_m": (0.0117, 0.0123), "unwound_m": (-0.0038, 0.0088)}
    found = finding("out_of_round_roll", "unwind", numbers, interval95=ends)
    assert size_of(found) == "flat, depth 12.0 mm (95 %: 11.7 to 12.3)"
    assert [n.is_open for n in number_rows(found)] == [False, False, True]


def test_a_share_per_speed_is_told_in_percent():
    found = finding("slip", "swrap", {"slope_s_m": 0.0034})
    assert size_of(found) == "slope 0.34 % per m/s"


def test_a_moment_of_the_record_is_told_once():
    found = finding(
        "bearing_drag",
        "R14",
        {"constant_N_m": 0.05, "from_s": 28.8},
        begins=Moment(record="a.csv", time_s=28.8),
    )
    assert size_of(found) == "constant 0.05 N m, in a.csv from 28.8 s"


HUM = {
    "cos_N": -0.9,
    "sin_N": -0.5,
    "cos_1_N": 0.9,
    "sin_1_N": 0.9,
    "cos_2_N": 0.6,
    "sin_2_N": 0.1,
    "frequency_Hz": 99.7,
    "amplitude_N": math.hypot(0.9, 0.5),
    "phase_rad": -2.6,
}
CELLS = ("unwind_tension_N", "r3_tension_N", "rewind_tension_N")


def test_what_every_cell_has_is_told_by_its_name_and_whole():
    interval = {"amplitude_N": (1.0, 1.1)}
    found = finding("mains_hum", "all", HUM, cells=CELLS, interval95=interval)
    # of cells 2 and 3 the phasor is the first's plus their own: 0 + 0.4j, -0.3 - 0.4j
    assert size_of(found) == (
        "frequency 99.7 Hz, 1.03 N amplitude at unwind_tension, 0.4 N amplitude at r3_tension, "
        "0.5 N amplitude at rewind_tension"
    )
    rows = number_rows(found)
    assert [(n.name, n.value, n.unit) for n in rows] == [
        ("frequency", "99.7", "Hz"),
        ("amplitude at unwind_tension", "1.03", "N"),
        ("amplitude at r3_tension", "0.4", "N"),
        ("amplitude at rewind_tension", "0.5", "N"),
    ]
    assert [(n.low, n.high) for n in rows[1:]] == [("1", "1.1"), ("", ""), ("", "")]


def test_cells_of_a_line_that_is_not_known_are_counted():
    assert size_of(finding("mains_hum", "all", HUM)).endswith(
        "1.03 N amplitude at cell 1, 0.4 N amplitude at cell 2, 0.5 N amplitude at cell 3"
    )


def test_one_cell_has_one_size():
    one = {name: HUM[name] for name in ("cos_N", "sin_N", "frequency_Hz", "amplitude_N")}
    told = size_of(finding("mains_hum", "R9", one, cells=CELLS))
    assert told == "frequency 99.7 Hz, amplitude 1.03 N"


def test_a_rhythm_and_a_reading_that_sticks_are_told_with_their_place():
    rhythm = {"period_s": 1.36, "zone": "unwind_zone", "channel": "unwind_speed_rad_s"}
    assert coordinate_text("time", rhythm) == (
        "something that comes again every 1.36 s at every speed, strongest in "
        "unwind_speed_rad_s, in unwind_zone"
    )
    sticks = {"channel": "r3_tension_N", "gap_N": 0.87, "also_in": "rewind_tension_N"}
    said = coordinate_text("state", sticks)
    assert said.startswith("r3_tension_N (and rewind_tension_N alike) depends on which way")
    assert "0.87 N apart" in said


def test_a_number_that_became_another_one_is_told_in_its_own_unit_from_what_to_what():
    found = finding(
        "changed_number",
        "control.drives.pull_roll.K_ref_rad_s",
        {"change": -0.25, "from_s": 37.3},
        begins=Moment(record="a.csv", time_s=37.3),
        becomes=NumberChange(before=40.0, after=30.0, low=29.75, high=30.25),
    )
    said = "from 40 rad/s to 30.0 rad/s (95 %: 29.8 to 30.2), in a.csv from 37.3 s"
    assert size_of(found) == said
    where = "K ref of pull_roll (control.drives.pull_roll.K_ref_rad_s)"
    assert place_words(found.place) == f"changed number at {where}"
