"""Work on the runtime's own ticker in a process with the runtime's own rights.

``python -m benchmarks.runtime.paced wake SECONDS``, ``... law BLOCKS SECONDS`` and ``... shape
ORDERS SECONDS`` print JSON; ``... shape-hot ORDERS SECONDS`` does not wait between ticks.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from collections.abc import Callable
from typing import Any

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.python_child import module_command
from aff_runtime.base.signals import Outcome, Permission, Snapshot
from aff_runtime.core.controller import Controller
from aff_runtime.core.params import ActuatorParams, BlockParams, RollParams, SiteParams
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from aff_runtime.loop.realtime import RealtimeRequest, ask
from aff_runtime.loop.ticker import Ticker
from benchmarks.runtime.child import environment

PERIOD_NS = 5_000_000
WARM_UP_TICKS = 50
ORDERS_PER_ROLL = 16


def nothing(_tick: int) -> None:
    """Prepare nothing."""


def pace(
    work: Callable[[int], None], seconds: float, prepare: Callable[[int], None] = nothing
) -> dict[str, Any]:
    """Do ``work`` on the grid, what it needs before; return lateness and its duration, ns."""
    clock = MonotonicClock()
    rights = ask(RealtimeRequest(cpus=(own_processor(),)))
    ticker = Ticker(clock, PERIOD_NS)
    wake_ns: list[int] = []
    work_ns: list[int] = []
    ticker.start()
    for tick in range(WARM_UP_TICKS + round(seconds * 1e9 / PERIOD_NS)):
        ticker.wait()
        prepare(tick)
        begun_ns = clock.now_ns()
        work(tick)
        if tick >= WARM_UP_TICKS:
            wake_ns.append(ticker.wake_ns)
            work_ns.append(clock.now_ns() - begun_ns)
    return {
        "wake_ns": wake_ns,
        "work_ns": work_ns,
        "missed": ticker.missed,
        "fifo": rights.grants[-1].granted,
        "refused": [line for line in rights.lines() if "refused" in line],
    }


def back_to_back(
    work: Callable[[int], None], seconds: float, prepare: Callable[[int], None] = nothing
) -> dict[str, Any]:
    """Do ``work`` again and again, what it needs before; return its duration per tick, ns."""
    clock = MonotonicClock()
    ask(RealtimeRequest(cpus=(own_processor(),)))
    ends_ns = clock.now_ns() + round(seconds * 1e9)
    work_ns: list[int] = []
    tick = 0
    while clock.now_ns() < ends_ns:
        prepare(tick)
        begun_ns = clock.now_ns()
        work(tick)
        if tick >= WARM_UP_TICKS:
            work_ns.append(clock.now_ns() - begun_ns)
        tick += 1
    return {"work_ns": work_ns}


def own_processor() -> int:
    """Return the processor that the control process would take: the last one."""
    return max(os.sched_getaffinity(0))


def law_of(blocks: int) -> Controller:
    """Return a law of ``blocks`` orders on as many rolls as they need, with responses."""
    rolls = math.ceil(blocks / ORDERS_PER_ROLL)
    names = [f"roll_{k}" for k in range(rolls)]
    channels = ("tension_N", "line_speed_m_s", *(f"{name}_angle_rad" for name in names))
    site = SiteParams(
        cycle_s=PERIOD_NS * 1e-9,
        channels=channels,
        line_speed="line_speed_m_s",
        rolls=tuple(
            RollParams(name=name, angle=f"{name}_angle_rad", radius_m=0.2) for name in names
        ),
        actuators=(
            ActuatorParams(
                name="unwind",
                signal="tension_N",
                blocks=tuple(
                    BlockParams(
                        roll=name,
                        orders=tuple(range(1, 1 + min(ORDERS_PER_ROLL, blocks))),
                        settle_s=10.0,
                        amp_limit=0.01,
                    )
                    for name in names
                ),
            ),
        ),
    )
    points = [
        ResponsePoint(
            frequency_Hz=0.1 * 1.3**k,
            gain=200.0,
            phase_rad=-0.1 * k,
            relative_error=0.02,
            coherence=0.99,
        )
        for k in range(20)
    ]
    provenance = Provenance(actuator="unwind", signal="tension_N")
    response = Response(points=points, delay_s=0.0, provenance=provenance)
    return Controller(site, {"unwind": response})


def law_step(blocks: int) -> Callable[[int], None]:
    """Return one tick of a law that adapts every block on fresh readings."""
    law = law_of(blocks)
    rolls = math.ceil(blocks / ORDERS_PER_ROLL)
    free = Permission(adapt=True, applied_ratio=(1.0,), limit_ratio=(1.0,))

    def step(tick: int) -> None:
        angles = tuple(0.005 * tick * (2.0 + 0.1 * k) for k in range(rolls))
        snapshot = Snapshot(
            tick=tick,
            t_ns=tick * PERIOD_NS,
            outcome=Outcome.OK,
            fresh=True,
            age_s=0.0,
            plc_heartbeat=tick & 0xFFFF,
            status=0xFF,
            roll_id=1,
            values=(90.0 + math.sin(0.1 * tick), 1.0, *angles),
        )
        law.step(snapshot, 0.005, free)
        law.telemetry()

    return step


def in_child(*arguments: str, **more: str) -> dict[str, Any]:
    """Run this module in a process of its own, ``more`` in its environment; what it measured."""
    command = [*module_command("benchmarks.runtime.paced"), *arguments]
    env = {**environment(), **more}
    done = subprocess.run(command, check=True, capture_output=True, text=True, env=env)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def main(arguments: list[str]) -> None:
    """Measure what the command line names."""
    kind, *numbers = arguments
    prepare: Callable[[int], None] = nothing
    work: Callable[[int], None] = nothing
    if kind.startswith("shape"):
        from benchmarks.runtime.shape_time import shape_work

        _, prepare, work = shape_work(int(numbers[0]))
    elif kind == "law":
        work = law_step(int(numbers[0]))
    measure = back_to_back if kind == "shape-hot" else pace
    json.dump(measure(work, float(numbers[-1]), prepare), sys.stdout)


if __name__ == "__main__":
    main(sys.argv[1:])
