"""A probe on the real line: it finds its amplitude, and leaves the line alone at its bounds."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.app.wiring.site_to_law import probe_params, site_params
from aff_runtime.base.signals import State
from aff_runtime.config.loader import load_site
from aff_runtime.core.probe.probe import WITHDRAWN_S, Probe, Stage
from aff_runtime.core.response import Provenance
from aff_runtime.loop.messages import Arm, Swap
from aff_runtime.loop.ports import Advice
from tests.lockstep.bench import SITE, Bench, Setup
from tests.lockstep.fault_table import ZERO_WITHIN_S, peak, zero_after_s
from tests.lockstep.known_response import SPEED_M_S

pytestmark = pytest.mark.timeout(300)
GIVEN = "  amplitude_m_s: 0.008\n"
FIRST_M_S, BOUND_M_S = 0.02 / 16, 0.02
PLC_S = 0.1


def probing(folder: Path, settings: str, seconds: float) -> tuple[Bench, Probe]:
    """Return a bench whose unwind is being probed for some seconds."""
    path = folder / "site.yaml"
    path.write_text(SITE.read_text().replace(GIVEN, settings, 1))
    site = load_site(path)
    bench = Bench(Setup(site=path))
    probe = Probe(site_params(site), probe_params(site, ("unwind",)))
    bench.run(0.5)
    bench.outside.advise = lambda _: Advice()  # type: ignore[method-assign]
    for said in (Swap(law=probe), Arm()):
        bench.say(said)
    bench.run(seconds)
    return bench, probe


@pytest.mark.parametrize(
    ("reference", "times", "bound", "said"),
    [
        ("tension_ref_N", 1.25, "  bound_N: 5\n", r"unwind_tension_N moved .* the bound is 5"),
        ("line_speed_ref_m_s", 1.1, "", "the line speed went from 1.02 to"),
    ],
)
@pytest.mark.sweep(every=2)  # the speed on a line of its own: core/probe/test_choosing.py
def test_who_moves_the_line_in_the_middle_of_a_probe_ends_it(
    tmp_path: Path, reference: str, times: float, bound: str, said: str
) -> None:
    bench, probe = probing(tmp_path, GIVEN + bound, 14.0)
    assert probe.stage is Stage.EXCITING, probe.reason
    now = {"tension_ref_N": bench.plant.measured["tension_ref_N"], "line_speed_ref_m_s": SPEED_M_S}
    bench.plant.set_reference(reference, times * now[reference])
    for _ in range(100):
        bench.run(0.1)
        if probe.stage is Stage.WITHDRAWING:
            break
    begun_s = bench.now_s
    bench.run(WITHDRAWN_S + PLC_S)
    assert probe.stage is Stage.ABORTED
    assert re.search(said, probe.reason), probe.reason
    assert bench.guard.state is State.ACTIVE  # no fault: it went back by itself
    fade = peak(bench.applied, begun_s, begun_s + 0.5 * WITHDRAWN_S)
    assert 0.0 < fade <= 0.008
    bench.run(0.5)
    assert zero_after_s(bench.applied, begun_s) <= WITHDRAWN_S + PLC_S


# quick: its size in core/probe/test_choosing.py, zero after a kill in test_probe_kills.py
@pytest.mark.long
def test_a_first_probe_begins_at_a_sixteenth_of_its_bound_and_dies_at_zero(tmp_path: Path) -> None:
    bench, probe = probing(tmp_path, "", 16.0)
    assert probe.stage is Stage.RISING, probe.reason
    assert peak(bench.applied, 0.0, bench.now_s) == pytest.approx(FIRST_M_S, rel=0.05)
    killed_s = bench.now_s
    bench.run_plant_alone(2.0)
    assert zero_after_s(bench.applied, killed_s) < ZERO_WITHIN_S


@pytest.mark.long  # quick: core/probe/test_choosing.py, on a plant of one lag
def test_a_chosen_amplitude_is_heard_on_the_line_and_keeps_within_its_bounds(
    tmp_path: Path,
) -> None:
    bench, probe = probing(tmp_path, "", 100.0)
    assert probe.stage is Stage.DONE, probe.reason
    assert probe.bounds.moved[0] < probe.bounds.most(0)
    assert peak(bench.applied, 0.0, bench.now_s) <= BOUND_M_S * (1.0 + 1e-9)
    signal = "unwind_tension_N"
    (result,) = probe.result({"unwind": Provenance(actuator="unwind", signal=signal)})
    errors = np.array([point.relative_error for point in result.response.points])
    assert np.mean(errors < 0.61) > 0.9
    assert np.median(errors) < 0.2
