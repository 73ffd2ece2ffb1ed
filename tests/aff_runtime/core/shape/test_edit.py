"""An edit of the site file while the shape law runs: what is not edited goes on untouched."""

from __future__ import annotations

import numpy as np
import pytest

from aff_runtime.core.phase import Quality
from aff_runtime.core.shape.columns import common
from aff_runtime.core.shape.filter import LoopFilter
from tests.aff_runtime.core.shape_site import Rig, actuator, loop_of

RIPPLE = {("unwind", 1): 3.0 + 1.0j, ("unwind", 2): 1.0 - 0.5j, ("swrap", 1): 0.8j}
BEFORE = {"orders": (1, 2), "extra": (("swrap", (1,)),)}


def running() -> Rig:
    """Return a law at its limit, whose orders 2x of the unwind and 1x of the S-wrap meet."""
    rig = Rig(actuator(**BEFORE), ripple=RIPPLE)
    unwind, swrap = rig.phases["unwind"], rig.phases["swrap"]
    swrap.omega_rad_s, swrap.radius_m = 2.0 * unwind.omega_rad_s, 0.5 * unwind.radius_m
    rig.run(5.0)
    rig.limit = 0.7 * rig.last.peak_bound
    rig.run(2.0)
    assert rig.law.monitor.meets.any()
    assert (rig.law.allocation.share < 1.0).any()
    return rig


def edited(rig: Rig, **blocks) -> Rig:
    """Put a changed law in the place of the one that runs, with angles of its own."""
    made = Rig(actuator(**blocks))
    for name, phase in made.phases.items():
        phase.__dict__.update(rig.phases[name].__dict__)
    made.law.adopt(rig.law)
    rig.law, rig.phases = made.law, made.phases
    return rig


@pytest.mark.parametrize(
    "blocks",
    [
        {"orders": (1, 2, 3, 4), "extra": (("swrap", (1, 2)),)},
        {"orders": (4, 2, 1), "extra": (("swrap", (1,)),)},
        BEFORE,
    ],
)
def test_the_output_goes_on_as_if_nothing_was_edited(blocks):
    on, new = running(), edited(running(), **blocks)
    for _ in range(20):
        on.tick()
        new.tick()
        assert new.u == pytest.approx(on.u, abs=1e-3 * abs(on.last.peak_bound))
    both = common(new.law.basis.names, on.law.basis.names)
    assert both.mine.size == on.law.weight.size
    for part in (
        "weight",
        "allocation.share",
        "monitor.share",
        "monitor.now",
        "filter.response_ratio",
    ):
        mine, theirs = new.law, on.law
        for name in part.split("."):
            mine, theirs = getattr(mine, name), getattr(theirs, name)
        close = 2e-3 if part == "allocation.share" else 1e-6  # the fit samples other angles
        assert mine[both.mine] == pytest.approx(theirs[both.theirs], rel=2e-2, abs=close), part


def test_an_order_that_rests_rests_on_and_one_that_is_taken_out_is_gone():
    rig = running()
    learned = rig.law.weights()
    rig.law.monitor._rest[1] = 7.0
    rig.law.monitor.share[1] = 0.0
    rig.law.monitor.calm = False
    new = edited(rig, orders=(2, 3))
    assert new.law.monitor._rest.tolist()[:2] == [7.0, 0.0]
    assert new.law.monitor.share.tolist()[:2] == [0.0, 1.0]
    assert not new.law.monitor.calm
    assert new.law.weights() == {("unwind", 2): learned["unwind", 2], ("unwind", 3): 0j}
    new.run(1.0)
    assert np.isfinite(new.u)


def test_after_an_edit_a_lost_angle_is_still_seen():
    new = edited(running(), **BEFORE)
    new.run(0.1)
    assert new.u != 0.0
    for phase in new.phases.values():
        phase.quality = Quality.LOST
    new.run(1.0)
    assert new.u == 0.0
    assert not new.law.adapting


def test_a_longer_memory_of_the_loop_begins_with_the_past_there_is():
    rig = running()
    old, names = rig.law._loop, rig.law.basis.names
    longer = LoopFilter(loop_of(rig.plant, 260), old._count)
    longer.adopt(old, common(names, names))
    phi, psi = (part.copy() for part in old.read())
    assert longer.read()[0] == pytest.approx(phi, rel=1e-3)
    assert longer.read()[1] == pytest.approx(psi, rel=1e-3, abs=1e-6)
