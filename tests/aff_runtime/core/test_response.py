"""Interpolation, honesty about phase, and the stored text."""

import cmath
import json
import math

import pytest

from aff_runtime.base.errors import ConfigError
from aff_runtime.core.response import Provenance, Response, ResponsePoint, arming_objections
from tests.aff_runtime.core.plants import GRID_HZ, LagDelay, measured
from tests.each_case import each_case


def test_interpolates_a_lag_with_delay_between_points():
    plant = LagDelay(-400.0, delay=39, lag=0.96)  # 0.2 s: phase turns far between points
    response = measured(plant.at, GRID_HZ, delay_s=0.2)
    for f in (0.45, 0.9, 1.7, 3.3, 5.9):
        error = response.at(f) / plant.at(f)
        assert abs(error) == pytest.approx(1.0, rel=0.02)
        assert abs(math.degrees(cmath.phase(error))) < 2.0


def test_negative_frequency_is_the_conjugate():
    response = measured(LagDelay(3.0, 5).at, GRID_HZ)
    assert response.at(-1.3) == pytest.approx(response.at(1.3).conjugate())


def test_the_nearest_point_is_the_first_of_those_equally_near():
    """Against a look at every point; two points of one frequency, ties, and beyond both ends."""
    response = measured(LagDelay(3.0).at, (1.0, 2.0, 2.0, 4.0))
    for f in (0.5, 1.0, 1.4, 1.5, 1.6, 2.0, 2.5, 3.0, 3.1, 4.0, 9.0):
        wanted = min(response.points, key=lambda point: abs(point.frequency_Hz - f))
        assert response.nearest(f) is wanted


def test_memory_of_a_pure_delay_is_the_delay():
    response = measured(LagDelay(3.0, 19).at, GRID_HZ, delay_s=0.1)
    assert response.memory_s(1.0) == pytest.approx(0.1, rel=1e-6)


def test_bound_grows_with_noise_and_with_distance_from_the_band():
    good, poor = (measured(LagDelay(3.0).at, GRID_HZ, relative_error=e) for e in (0.01, 0.2))
    assert poor.phase_error_bound_rad(1.0) - good.phase_error_bound_rad(1.0) == pytest.approx(
        2.3 * 0.19 / math.sqrt(2)
    )
    top = GRID_HZ[-1]
    bounds = [good.phase_error_bound_rad(top * r) for r in (1.0, 1.2, 1.5, 2.0)]
    assert bounds == sorted(bounds)
    assert bounds[-1] - bounds[0] == pytest.approx(math.pi / 2, rel=1e-6)
    assert good.phase_error_bound_rad(GRID_HZ[0] / 2) > math.radians(60)
    assert good.phase_error_bound_rad(0.0) == math.pi


def test_text_and_back_is_the_same_response():
    old = measured(LagDelay(-40.0, 7, 0.9).at, GRID_HZ, delay_s=0.03)
    new = Response.from_json(old.to_json())
    assert new.points == old.points
    assert new.delay_s == old.delay_s
    assert new.provenance.actuator == "unwind"
    assert math.isnan(new.provenance.radius_m)


@each_case(
    "text",
    [
        "",
        "{}",
        "[]",
        "null",
        '{"format": "other"}',
        '{"format": "aff-response-1", "points": [1]}',
        '{"format": "aff-response-1", "delay_s": 0, "points": [],'
        ' "provenance": {"actuator": "a", "signal": "b"}}',
    ],
)
def test_foreign_text_is_refused(text):
    with pytest.raises(ConfigError):
        Response.from_json(text)


def test_point_that_is_no_number_is_refused():
    point = ResponsePoint(
        frequency_Hz=1.0, gain=math.nan, phase_rad=0.0, relative_error=0.1, coherence=1.0
    )
    with pytest.raises(ConfigError, match=r"1\.0 Hz"):
        Response(points=[point], delay_s=0.0, provenance=Provenance(actuator="a", signal="b"))


def test_objections_name_order_and_reason():
    response = measured(LagDelay(3.0).at, GRID_HZ)
    assert arming_objections(response, [("unwind_1x", 1.0)]) == ()
    (missing,) = arming_objections(None, [("unwind_1x", 1.0)])
    assert "probe" in missing
    outside = arming_objections(response, [("unwind_4x", 30.0)])
    assert "unwind_4x" in outside[0]
    assert "outside" in outside[0]
    assert any("does not turn" in t for t in arming_objections(response, [("unwind_1x", 0.0)]))
    noisy = measured(LagDelay(3.0).at, GRID_HZ, relative_error=0.7, coherence=0.5)
    texts = " ".join(arming_objections(noisy, [("unwind_1x", 1.0)]))
    assert "phase error" in texts
    assert "coherence" in texts


@each_case(
    ("key", "value"),
    [
        ("relative_error", -1.0),
        ("coherence", 5.0),
        ("coherence", -0.5),
        ("gain", 1e308),
        ("gain", 1e-320),
        ("gain", 10**400),
    ],
)
def test_a_point_that_no_probe_leaves_is_refused(key, value):
    data = json.loads(measured(LagDelay(3.0).at, GRID_HZ).to_json())
    data["points"][0][key] = value
    with pytest.raises(ConfigError, match=r"probe again|run the probe"):
        Response.from_json(json.dumps(data))


def test_brackets_without_end_are_no_response():
    with pytest.raises(ConfigError, match="not a response file"):
        Response.from_json("[" * 100_000)
