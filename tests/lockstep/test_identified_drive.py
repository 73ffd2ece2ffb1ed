"""The product's rooms and the real line: a probe finds Euclid's drive, and the law runs on it."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from aff_runtime.app.wiring.site_to_law import probe_params, site_params
from aff_runtime.config.identified_drive import with_identified
from aff_runtime.config.loader import load_site
from aff_runtime.core.probe.probe import Probe, ProbeResult, Stage
from aff_runtime.core.response import Provenance, Response
from aff_runtime.loop.messages import Arm, Swap
from aff_runtime.loop.ports import Advice
from sim_plant.line.reading.load import load_declaration
from tests.lockstep.bench import Bench, Setup
from tests.lockstep.known_response import LINE, ROOT

pytestmark = pytest.mark.timeout(300)
DRIVE = re.compile(r"^    drive:\n(?:      .*\n)+", re.MULTILINE)
SECONDS = 45.0


@pytest.fixture(scope="module")
def site_file(tmp_path_factory) -> Path:
    """Return Euclid's site file without its drive, probing for longer."""
    text = DRIVE.sub("", (ROOT / "config" / "euclid.yaml").read_text(), count=1)
    text = text.replace("  duration_s: 25\n", f"  duration_s: {SECONDS:g}\n", 1)
    path = tmp_path_factory.mktemp("identified") / "site.yaml"
    path.write_text(text)
    return path


@pytest.fixture(scope="module")
def result(site_file) -> ProbeResult:
    site = load_site(site_file)
    bench = Bench(Setup(site=site_file))
    probe = Probe(site_params(site), probe_params(site, ("unwind",)))
    bench.outside.advise = lambda _: Advice()
    for said in (Swap(law=probe), Arm()):
        bench.say(said)
    bench.run(SECONDS + 7.0)
    assert probe.stage is Stage.DONE, probe.reason
    signal = site.actuators["unwind"].error.signal
    about = Provenance(actuator="unwind", signal=signal, cycle_s=site.cycle_s)
    return probe.result({"unwind": about})[0]


@pytest.mark.long  # on phasors: core/identify/test_drive_fit.py
def test_the_drive_is_found_inside_its_intervals(result):
    line = load_declaration(LINE)
    found = result.response.drive
    assert found is not None, result.response.no_drive
    drive, web = line.control.drives[0], line.web
    core_4 = line.initial_radii_m.core**4
    wound = 0.5 * math.pi * web.density_kg_m3 * web.width_m * (found.radius_m**4 - core_4)
    length_m = sum(span.length_m for span in line.spans[:10])
    true = {
        "speed_gain_rad_s": drive.K_ref_rad_s,
        "integral_time_s": 4.0 * drive.zeta**2 / drive.K_ref_rad_s,
        "inertia_kg_m2": line.inertia_kg_m2.unwind_core_and_drive + wound,
        "stiffness_N_m": web.EA_N / length_m,
    }
    for name, number in true.items():
        estimate = getattr(found, name)
        assert estimate.low <= number <= estimate.high, (name, number, str(estimate))


@pytest.mark.long  # the same rooms: app/check/test_identified_drive.py
def test_the_site_then_runs_the_shape_law_on_it(result, site_file):
    kept = Response.from_json(result.response.to_json())
    site = load_site(site_file)
    assert not site.actuators["unwind"].uses_shape
    whole, used = with_identified(site, {"unwind": kept})
    assert whole.actuators["unwind"].uses_shape
    params = site_params(whole).actuators[0]
    assert params.law == "shape"
    assert params.drive is not None
    assert params.drive.inertia_at(kept.drive.radius_m) == pytest.approx(
        kept.drive.inertia_kg_m2.value, rel=1e-3
    )
    assert "drive identified" in used[0].text
