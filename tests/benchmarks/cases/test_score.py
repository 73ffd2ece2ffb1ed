"""What counts as right on a labelled pair."""

from __future__ import annotations

import pytest

from benchmarks.cases.report import page
from benchmarks.cases.score import Label, label_of, outcome, over_floor, share_of
from tests.each_case import each_case


def label(*effects, healthy=False, outside=False, visible=True, numbers=None) -> Label:
    entries = [
        {
            "effect_class": name,
            "location": place,
            "accept": list(accept),
            "parameters": numbers or {},
        }
        for name, place, *accept in effects
    ]
    return label_of(
        {
            "case": "c",
            "effects": entries,
            "healthy": healthy,
            "outside": outside,
            "visible": visible,
        }
    )


def verdict(*effects, beside=(), unknown=()):
    return {
        "effects": [
            {"effect": name, "location": place, "parameters": {}} for name, place in effects
        ],
        "ambiguous": [{"effect": what, "with": list(others)} for what, others in beside],
        "unknown": [{"class": kind, "coordinate": {}} for kind in unknown],
    }


DRAG, SLIP = ("bearing_drag", "R7"), ("slip", "swrap_lead")


@each_case(
    ("truth", "said", "expected"),
    [
        ([DRAG], verdict(DRAG), "exact"),
        ([DRAG], verdict(("bearing_drag", "R8")), "wrong"),
        (
            [DRAG],
            verdict(
                ("bearing_drag", "R8"), beside=[("bearing_drag at R8", ["bearing_drag at R7"])]
            ),
            "set",
        ),
        ([DRAG], verdict(DRAG, SLIP), "wrong"),
        ([DRAG, SLIP], verdict(DRAG), "part"),
        ([DRAG, SLIP], verdict(SLIP, DRAG), "exact"),
        ([DRAG], verdict(unknown=["state"]), "unknown"),
        ([DRAG], verdict(), "nothing"),
        ([DRAG], {}, "failed"),
        ([("mains_hum", "all", "R3")], verdict(("mains_hum", "R3")), "exact"),
        ([("viscoelastic_web", "web", "web_modulus")], verdict(("web_modulus", "web")), "exact"),
        ([("slip", "swrap")], verdict(SLIP), "exact"),
    ],
)
def test_a_verdict_is_held_against_its_label(truth, said, expected):
    assert outcome(label(*truth), said) == expected


def test_one_claim_does_not_count_for_two_effects():
    twice = label(DRAG, DRAG)
    assert outcome(twice, verdict(DRAG)) == "part"


def test_the_worst_tension_is_judged_and_no_angle_or_speed():
    rows = {
        "a_tension_N": {"before": 2.0, "after": 1.1, "noise_floor": 1.0},
        "b_tension_N": {"before": 3.0, "after": 0.6, "noise_floor": 0.5},
        "unwind_angle_rad": {"before": 99.0, "after": 99.0, "noise_floor": 1.0},
    }
    assert over_floor({"residual_rms": rows}) == (pytest.approx(6.0), pytest.approx(1.2))
    assert over_floor({}) is None


def test_a_share_comes_with_its_bounds():
    # Wilson 1927 for 12 of 30: 24.6 to 57.7 %
    assert str(share_of([True] * 12 + [False] * 18)) == "12 of 30 (40 %, 25 to 58)"


def test_what_is_outside_is_counted_twice_once_by_its_coordinate():
    fan = {"what": "air-bar pulsation", "strain": 1e-4, "frequency_Hz": 1.5}
    outside = label(("unknown", "unwind_zone"), outside=True, numbers=fan)
    near, far = ({"class": "time", "coordinate": {"frequency_Hz": f}} for f in (1.5, 3.0))
    entries = [
        ("check", outside, {"verdict": {"unknown": [said]}, "time_s": 1.0, "error": ""})
        for said in (near, far)
    ]
    text = page(entries)
    assert "unknown and no effect named: 2 of 2" in text
    assert "class and coordinate right: 1 of 2" in text
    assert "outside: air-bar pulsation at unwind_zone" in text
    assert text.count("**unknown**") == 1


def test_numbers_of_right_singles_are_on_the_page_and_those_of_pairs_are_not():
    said = verdict(DRAG)
    said["effects"][0]["parameters"] = {"constant_N_m": 0.051}
    numbers = {"added_torque_N_m": 0.05}
    entries = [
        ("check", label(*hidden, numbers=numbers), {"verdict": said, "time_s": 1.0, "error": ""})
        for hidden in ([DRAG], [DRAG, SLIP])
    ]
    text = page(entries)
    assert text.count("2.0 (added_torque_N_m)") == 1
    assert "(median / 90 %, %; 1 numbers): 2.000 / 2.000" in text


def test_the_page_totals_each_part_apart_and_marks_what_is_not_right():
    entries = [
        ("train", label(DRAG), {"verdict": verdict(DRAG), "time_s": 10.0, "error": ""}),
        ("train", label(healthy=True), {"verdict": verdict(SLIP), "time_s": 20.0, "error": ""}),
        ("check", label(DRAG), {"verdict": {}, "time_s": 30.0, "error": "went wrong"}),
    ]
    text = page(entries)
    assert "**wrong**" in text
    assert "went wrong" in text
    train, check = text.split("## train")[1].split("## check")
    assert "visible singles: 1 of 1" in train
    assert "healthy lines accused: 1 of 1" in train
    assert "failed: 1" in check
