"""Identified numbers in a response file: there and back, absent, and not to be believed."""

from __future__ import annotations

import json
import math

import pytest

from aff_runtime.base.errors import ConfigError
from aff_runtime.core.identified import Estimate, IdentifiedDrive
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from tests.each_case import each_case


def estimate(value: float, share: float = 0.1) -> Estimate:
    return Estimate(value=value, low=value * (1.0 - share), high=value * (1.0 + share))


def drive(**changed: object) -> IdentifiedDrive:
    given: dict[str, object] = {
        "roll": "unwind",
        "radius_m": 0.2,
        "speed_gain_rad_s": estimate(15.0),
        "integral_time_s": estimate(0.32),
        "inertia_kg_m2": estimate(0.41),
        "friction_N_m_s": Estimate(value=0.0, low=-0.1, high=0.1),
        "delay_s": estimate(0.015),
        "stiffness_N_m": estimate(1350.0),
        "misfit": 1.1,
        "band_Hz": 9.0,
        "tones": 26,
        **changed,
    }
    return IdentifiedDrive(**given)  # type: ignore[arg-type]


def response(found: IdentifiedDrive | None) -> Response:
    point = ResponsePoint(
        frequency_Hz=1.0, gain=100.0, phase_rad=math.pi, relative_error=0.01, coherence=1.0
    )
    about = Provenance(actuator="unwind", signal="unwind_tension_N")
    return Response(points=[point], delay_s=0.02, provenance=about, drive=found)


def test_a_drive_goes_into_the_file_and_comes_back():
    assert Response.from_json(response(drive()).to_json()).drive == drive()


def test_why_there_is_no_drive_goes_into_the_file_and_comes_back_on_one_line():
    given = response(None)
    told = Response(
        points=given.points, delay_s=0.0, provenance=given.provenance, no_drive="6 of 37\ntones"
    )
    assert Response.from_json(told.to_json()).no_drive == "6 of 37\\ntones"


def test_a_file_without_a_drive_reads_and_is_written_as_before():
    text = response(None).to_json()
    assert "drive" not in json.loads(text)
    assert Response.from_json(text).drive is None


@each_case(
    ("key", "value"),
    [
        ("inertia_kg_m2", {"value": 0.4, "low": 0.5, "high": 0.6}),
        ("inertia_kg_m2", {"value": 0.4, "low": 0.3}),
        ("inertia_kg_m2", {"value": "NaN", "low": 0.3, "high": 0.5}),
        ("radius_m", "wide"),
        ("radius_m", None),
    ],
)
def test_a_drive_that_none_can_be_is_refused(key, value):
    said = json.loads(response(drive()).to_json())
    said["drive"][key] = value
    with pytest.raises(ConfigError, match=r"run the probe again|identified drive"):
        Response.from_json(json.dumps(said))


def test_an_interval_is_sure_up_to_thirty_percent_each_way():
    assert estimate(10.0, 0.2).is_sure
    assert not estimate(10.0, 0.4).is_sure
    assert not Estimate(value=0.1, low=-0.1, high=0.3).is_sure


def test_a_number_that_is_not_sure_is_told_by_its_interval_alone():
    assert str(estimate(10.0, 0.2)) == "10 (8 to 12)"
    assert str(estimate(10.0, 0.4)) == "not shown by this probe, between 6 and 14"
