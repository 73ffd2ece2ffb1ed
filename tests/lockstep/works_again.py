"""A correction that is to be back: looked for until it is there, not as long as it may take."""

from __future__ import annotations

from aff_runtime.base.signals import State
from tests.lockstep.bench import Bench
from tests.lockstep.fault_table import WORKING_M_S, peak

LOOK_S = 0.3


def assert_works_again(bench: Bench, within_s: float) -> None:
    """Run until the correction is at work, ``within_s`` at most."""
    peak_m_s, latest_s = 0.0, bench.now_s + within_s
    while peak_m_s <= WORKING_M_S and bench.now_s < latest_s:
        bench.run(LOOK_S)
        peak_m_s = peak(bench.applied, bench.now_s - LOOK_S, bench.now_s)
    assert bench.guard.state is State.ACTIVE
    assert peak_m_s > WORKING_M_S
