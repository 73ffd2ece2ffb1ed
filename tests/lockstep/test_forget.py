"""Another roll was put in and the PLC did not tell: what each law still knows of it afterwards."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import replace

import pytest

from aff_runtime.app.control.shape_keeper import ShapeKeeper
from aff_runtime.app.wiring.site_to_law import site_params
from aff_runtime.config.loader import load_site
from aff_runtime.core.controller import Controller
from aff_runtime.core.response import Response
from aff_runtime.loop.messages import Bypass
from tests.lockstep.bench import SITE, Bench, Setup
from tests.lockstep.known_response import ROOT
from tests.parameter_records import record_of

LEARN_S = {"blocks": 2.5, "shape": 2.5, "iterative": 6.0}
"""Of the last one two passes at 200 FPM and a full roll, and a half."""
BOTH = {"unwind", "swrap_follower"}
Learned = Mapping[str, Mapping[tuple[str, int], complex]]


def learned(controller: Controller) -> Learned:
    """Return what the law of every actuator has learned."""
    return {
        actuator.name: dict(law.weights())
        for actuator, law in zip(controller.site.actuators, controller._laws, strict=True)
    }


def rolls_of(weights: Learned) -> set[str]:
    """Return the rolls of which something is known."""
    return {roll for law in weights.values() for (roll, _), w in law.items() if w != 0j}


class Service:
    """A line that has learned its rolls and was bypassed, with its keeper."""

    def __init__(self, law: str, responses: Mapping[str, Response]) -> None:
        file = ROOT / "config" / "euclid.yaml" if law == "shape" else SITE
        site = load_site(file)
        params = site_params(site)
        if law == "iterative":
            laws = tuple(replace(a, law="iterative") for a in params.actuators)
            params = replace(params, actuators=laws)
        self.bench = Bench(Setup(site=file, law=params, responses=responses))
        assert isinstance(self.bench.law, Controller)
        self.law = self.bench.law
        self.keeper = ShapeKeeper(record_of(site), tell=lambda *_: None, keep=lambda *_: None)
        self.bench.run(2.0)
        self.bench.arm(LEARN_S[law])
        self.bench.say(Bypass())
        self.bench.run(1.0)
        assert self.bench.guard.quiet

    def forget(self, *rolls: str) -> frozenset[str]:
        """Forget, and let a shape fade."""
        known = self.keeper.forget(self.law, rolls)
        self.bench.run(1.0)
        return known


@pytest.fixture(scope="module")
def with_blocks(responses: Mapping[str, Response]) -> Service:
    """Return a service that has learned in blocks; a test takes a copy."""
    return Service("blocks", responses)


@pytest.mark.parametrize("law", ["blocks", "iterative", "shape"])
@pytest.mark.sweep(every=2)
def test_the_roll_is_forgotten_under_every_law_and_the_roller_is_kept(
    law: str, responses: Mapping[str, Response], with_blocks: Service
) -> None:
    service = deepcopy(with_blocks) if law == "blocks" else Service(law, responses)
    before = learned(service.law)
    assert rolls_of(before) == BOTH
    assert service.forget() == {"unwind"}
    after = learned(service.law)
    assert rolls_of(after) == {"swrap_follower"}
    for actuator, weights in after.items():
        of_roller = {key: w for key, w in before[actuator].items() if key[0] == "swrap_follower"}
        assert {key: w for key, w in weights.items() if key[0] == "swrap_follower"} == of_roller
    assert service.forget() == set()  # nothing was left to forget


def test_a_roller_that_is_named_is_forgotten_by_every_actuator_and_the_roll_is_kept(
    with_blocks: Service,
) -> None:
    service = deepcopy(with_blocks)
    both = [name for name, w in learned(service.law).items() if rolls_of({"": w}) - {"unwind"}]
    assert both == ["unwind", "swrap_follower"]
    assert service.forget("swrap_follower") == {"swrap_follower"}
    assert rolls_of(learned(service.law)) == {"unwind"}
