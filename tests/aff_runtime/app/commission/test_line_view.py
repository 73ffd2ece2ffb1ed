"""What a screen is told of a line before it is probed, and after."""

import math
import shutil

import pytest

from aff_runtime.app.commission.line_view import line
from aff_runtime.app.commission.messages import Request
from aff_runtime.app.commission.sources import Paths
from aff_runtime.config.loader import load_site
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from tests.aff_runtime.app.card.measure.recorded import SITE_FILE
from tests.aff_runtime.app.commission.said import plain


@pytest.fixture
def where(tmp_path):
    site = tmp_path / "site.yaml"
    shutil.copyfile(SITE_FILE, site)
    (tmp_path / "rt").mkdir(mode=0o700)
    return Paths(
        site=site, state=tmp_path, socket=tmp_path / "rt" / "control.sock", card=tmp_path / "card"
    )


def test_before_the_first_probe_its_bounds_are_known_and_the_ripple_is_not(where):
    site, found = load_site(where.site), plain(line(where, Request(do="line"), None))["line"]
    assert found["errors"] == []
    assert found["probe"]["duration_s"] == site.probe.duration_s
    rows = {row["actuator"]: row for row in found["probe"]["rows"]}
    assert set(rows) == set(site.actuators)
    for name, actuator in site.actuators.items():
        assert rows[name]["amplitude"] == site.probe.amplitude_m_s
        assert rows[name]["limit"] == actuator.limit_m_s
        assert (rows[name]["unit"], rows[name]["signal_unit"]) == ("m/s", "N")
        assert rows[name]["ripple"] is None
    assert (found["responses"], found["proof"]) == ([], None)


def test_after_one_the_ripple_is_amplitude_times_the_largest_gain(where):
    site = load_site(where.site)
    name, actuator = next(iter(site.actuators.items()))
    gains = (40.0, 250.0, 90.0)
    points = [
        ResponsePoint(
            frequency_Hz=f, gain=gain, phase_rad=-1.0, relative_error=0.02, coherence=0.99
        )
        for f, gain in zip((1.0, 2.0, 4.0), gains, strict=True)
    ]
    about = Provenance(actuator=name, signal=actuator.error.signal, line_speed_m_s=1.0)
    path = where.site.parent / actuator.response
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(Response(points=points, delay_s=0.04, provenance=about).to_json())
    found = plain(line(where, Request(do="line"), None))["line"]
    (row,) = [one for one in found["probe"]["rows"] if one["actuator"] == name]
    assert row["ripple"] == pytest.approx(max(gains) * site.probe.amplitude_m_s)
    (response,) = found["responses"]
    assert response["unit"] == "N/(m/s)"
    assert response["radius_m"] is None
    assert response["points"][1] == pytest.approx([2.0, 250.0, math.degrees(-1.0), 2.0, 0.99])


def test_a_file_that_is_not_good_says_what_is_wrong_and_nothing_else(where):
    where.site.write_text(where.site.read_text().replace("version: 1", "version: one"))
    found = plain(line(where, Request(do="line"), None))["line"]
    assert found["errors"]
    assert (found["probe"], found["limits"]) == (None, [])
