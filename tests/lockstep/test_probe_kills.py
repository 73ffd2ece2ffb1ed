"""A runtime that dies in its probe: the excitation is bounded, and ends at the PLC."""

from __future__ import annotations

from copy import deepcopy

import pytest

from aff_runtime.app.wiring.site_to_law import probe_params, site_params
from aff_runtime.base.signals import State
from aff_runtime.config.loader import load_site
from aff_runtime.core.probe.probe import Probe, Stage
from aff_runtime.loop.messages import Arm, SupervisorLost, Swap
from aff_runtime.loop.ports import Advice
from tests.lockstep.bench import SITE, Bench, Setup
from tests.lockstep.fault_table import ZERO_WITHIN_S, peak, zero_after_s


@pytest.fixture
def probing(begun: tuple[Bench, Probe]) -> tuple[Bench, Probe]:
    """A copy of a bench in the middle of a probe."""
    return deepcopy(begun)


@pytest.fixture(scope="module")
def begun() -> tuple[Bench, Probe]:
    """A bench in the middle of a probe of both actuators."""
    site = load_site(SITE)
    bench = Bench(Setup())
    probe = Probe(site_params(site), probe_params(site, tuple(site.actuators)))
    bench.run(0.5)
    bench.outside.advise = lambda _: Advice()  # type: ignore[method-assign]
    for said in (Swap(law=probe), Arm()):
        bench.say(said)
    bench.run(9.0)
    assert probe.stage is Stage.EXCITING, (probe.stage, probe.reason)
    assert bench.guard.state is State.ACTIVE
    size_m_s = site.probe.amplitude_m_s
    sent = peak(bench.applied, bench.now_s - 2.0, bench.now_s)
    assert 0.2 * size_m_s < sent <= size_m_s * (1.0 + 1e-9)
    return bench, probe


def test_a_runtime_killed_in_the_middle_of_a_probe_leaves_zero_at_the_plant(probing) -> None:
    bench, _ = probing
    killed_s = bench.now_s
    bench.run_plant_alone(2.0)
    assert zero_after_s(bench.applied, killed_s) < ZERO_WITHIN_S
    assert bench.plant.plc.trips == 1
    assert max(peak(bench.applied, 0.0, bench.now_s), 0.0) <= load_site(SITE).probe.amplitude_m_s


def test_a_supervisor_lost_in_the_middle_of_a_probe_ends_it_at_zero(probing) -> None:
    bench, probe = probing
    lost_s = bench.now_s
    bench.say(SupervisorLost())
    bench.run(1.0)
    assert not bench.cycle.tick()
    assert probe.stage is not Stage.DONE
    bench.run_plant_alone(1.0)
    assert zero_after_s(bench.applied, lost_s) < ZERO_WITHIN_S
