"""What one tick of a law costs, paced at the control period."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial

import numpy as np
import numpy.typing as npt

from aff_runtime.base.signals import ActuatorStep, Outcome, Snapshot
from aff_runtime.core.controller import RollPhases
from aff_runtime.core.law import Inputs
from aff_runtime.core.params import SiteParams
from benchmarks.control.laws import plain_blocks, shape_law
from benchmarks.control.lines import nominal
from benchmarks.control.lockstep import CHANNELS, LawBuilder, rolls_of

PERIOD_S = 0.005
LAWS: dict[str, Callable[[], LawBuilder]] = {
    "shape law, 16 orders and S-wrap 1x": partial(shape_law, "tyvek", orders=16),
    "shape law, 24 orders and S-wrap 1x": partial(shape_law, "tyvek", orders=24),
    "plain blocks, 16 orders": partial(plain_blocks, "tyvek", 0.005, 16, 6.0),
}


class Steady:
    """A line that turns steadily, as a law and its rolls' angles see it; no plant."""

    def __init__(self, build: LawBuilder, seed: int = 0) -> None:
        rolls = rolls_of(nominal("tyvek", 0.2032))
        site = SiteParams(cycle_s=PERIOD_S, channels=CHANNELS, rolls=rolls, actuators=())
        self._phases = RollPhases(site)
        self.law = build(self._phases.by_name, PERIOD_S)
        self._given = Inputs(
            dt_s=PERIOD_S, fresh=True, adapt=True, applied_ratio=1.0, limit_ratio=1.0
        )
        self._noise = np.random.default_rng(seed).standard_normal(4096)
        self._tick = 0

    def prepare(self) -> None:
        """Set the signals of the next tick; the rolls' angles follow."""
        k = self._tick
        self._tick += 1
        theta = 0.025 * k
        tension = 88.96 + float(np.sin(theta)) + 0.25 * float(self._noise[k % 4096])
        values = (tension, 88.96, 1.016, 0.2032, 90.0, theta, 0.033 * k, 1.0)
        snapshot = Snapshot(
            tick=k,
            t_ns=0,
            outcome=Outcome.OK,
            fresh=True,
            age_s=0.0,
            plc_heartbeat=k,
            status=255,
            roll_id=1,
            values=values,
        )
        self._phases.step(snapshot, PERIOD_S)
        given = self._given
        given.signal, given.reference, given.line_speed_m_s = values[0], values[1], values[2]

    def step(self) -> ActuatorStep:
        """Advance the law."""
        return self.law.step(self._given)


def tick_times_us(build: LawBuilder, ticks: int, *, paced: bool = True) -> npt.NDArray[np.float64]:
    """Return the duration of each tick of a law on a line that turns, us, (ticks,)."""
    line = Steady(build)
    times = np.zeros(ticks)
    due = time.perf_counter()
    for k in range(ticks):
        line.prepare()
        if paced:
            due += PERIOD_S
            pause = due - time.perf_counter()
            if pause > 0.0:
                time.sleep(pause)  # noqa: TID251
        start = time.perf_counter()
        line.step()
        times[k] = 1e6 * (time.perf_counter() - start)
    return times[ticks // 10 :]
