"""What one tick of a law costs, paced at the control period."""

from __future__ import annotations

import time

import numpy as np
import numpy.typing as npt

from aff_runtime.base.signals import Outcome, Snapshot
from aff_runtime.core.controller import RollPhases
from aff_runtime.core.law import Inputs
from aff_runtime.core.params import SiteParams
from benchmarks.control.laws import shape_law
from benchmarks.control.lockstep import CHANNELS, ROLLS

PERIOD_S = 0.005


def tick_times_us(orders: int, ticks: int, *, paced: bool = True) -> npt.NDArray[np.float64]:
    """Return the duration of each tick of the shape law on a line that turns, us, (ticks,)."""
    site = SiteParams(cycle_s=PERIOD_S, channels=CHANNELS, rolls=ROLLS, actuators=())
    phases = RollPhases(site)
    law = shape_law("tyvek", orders=orders)(phases.by_name, PERIOD_S)
    given = Inputs(dt_s=PERIOD_S, fresh=True, adapt=True, applied_ratio=1.0, limit_ratio=1.0)
    times = np.zeros(ticks)
    due = time.perf_counter()
    for k in range(ticks):
        values = (
            88.96 + float(np.sin(0.03 * k)), 88.96, 1.016, 0.2032, 90.0, 0.025 * k, 0.033 * k, 1.0,
        )  # fmt: skip
        snapshot = Snapshot(
            tick=k, t_ns=0, outcome=Outcome.OK, fresh=True, age_s=0.0, plc_heartbeat=k,
            status=255, roll_id=1, values=values,
        )  # fmt: skip
        phases.step(snapshot, PERIOD_S)
        given.signal, given.reference, given.line_speed_m_s = values[0], values[1], values[2]
        if paced:
            due += PERIOD_S
            pause = due - time.perf_counter()
            if pause > 0.0:
                time.sleep(pause)  # noqa: TID251
        start = time.perf_counter()
        law.step(given)
        times[k] = 1e6 * (time.perf_counter() - start)
    return times[ticks // 10 :]
