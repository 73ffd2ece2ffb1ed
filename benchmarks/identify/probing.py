"""A real probe in lockstep with a drawn line: no sockets, words at the PLC's resolution."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from aff_runtime.base.signals import Outcome, Permission, Snapshot
from aff_runtime.core.params import (
    ActuatorParams,
    BlockParams,
    DriveParams,
    ProbeParams,
    SiteParams,
)
from aff_runtime.core.probe.excitation import PERIOD_S
from aff_runtime.core.probe.probe import Probe, Stage
from aff_runtime.core.response import Provenance, Response
from benchmarks.control.lines import Hidden
from benchmarks.control.lockstep import CHANNELS, LineColumns, rolls_of, settled_line
from benchmarks.identify.drawn import DrawnLine
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.equations.kernel import log_frame, step_frame
from sim_plant.line.linear.frequency import response

CYCLE_S = 0.005
LARGEST_M_S, LARGEST_N = 0.03, 10.0
ORDERS = 16
TO_HZ, LOUDER_FROM_HZ, GRID, LOW_GRID, NUISANCE = 19.4, 7.6, 20, 7, 24
ABOUT = Provenance(actuator="unwind", signal="unwind_tension_N", cycle_s=CYCLE_S)


def amplitude_m_s(line: DrawnLine) -> float:
    """Return the bound of the excitation: 30 mm/s, less where that would pull more than 10 N."""
    known = without_effects(line.declaration)
    f = np.geomspace(0.3, 15.0, 40)
    answer = response(known, "unwind", "unwind_tension_N", f, line.speed_m_s)
    return min(LARGEST_M_S, LARGEST_N / float(np.abs(answer).max()))


def without_effects(declaration: Declaration) -> Declaration:
    """Return the line without what is wrong with its rollers."""
    return declaration.model_copy(update={"effects": ()})


def actuator(drive: DriveParams | None = None, transport_s: float = CYCLE_S) -> ActuatorParams:
    """Return the unwind's actuator; without a drive none is declared."""
    block = BlockParams(
        roll="unwind", orders=tuple(range(1, ORDERS + 1)), settle_s=6.0, amp_limit=0.1
    )
    return ActuatorParams(
        name="unwind",
        signal="unwind_tension_N",
        reference="tension_ref_N",
        transport_s=transport_s,
        law="blocks" if drive is None else "shape",
        drive=drive,
        blocks=(block,),
    )


def probe(line: DrawnLine, noise: int) -> tuple[Probe, list[float]]:
    """Return a probe that is done, run on the line with noise of its own, and what it sent (m/s).

    Raises
    ------
    RuntimeError
        When it was aborted.
    """
    size_m_s = amplitude_m_s(line)
    params = ProbeParams(
        actuators=("unwind",),
        amplitude=size_m_s,
        duration_s=line.duration_s,
        f_max_Hz=TO_HZ,
        louder_from_Hz=LOUDER_FROM_HZ,
        grid_points=GRID,
        low_points=LOW_GRID,
        nuisance_orders=NUISANCE,
        max_speed_m_s=1.6,
    )
    site = SiteParams(
        cycle_s=CYCLE_S,
        channels=CHANNELS,
        rolls=rolls_of(line.declaration),
        actuators=(actuator(),),
        line_speed="line_speed_m_s",
    )
    law = Probe(site, params)
    plant = settled_line(line.declaration, CYCLE_S, line.speed_m_s)
    columns = LineColumns(plant.declaration, plant.log, Hidden())
    state, arrays, lay, work = plant.state, plant.arrays, plant.layout, plant.work
    arrays.timing["noisy"] = 1
    rng = np.random.default_rng([line.seed, noise])
    drives = arrays.drives.size
    width = arrays.cells.size + drives * (1 + plant.timing.ticks_per_frame)
    theta0 = plant.angles().copy()
    tension_ref = np.full(arrays.loops.size, line.declaration.operating_point.tension_N)
    row = np.zeros(plant.log.width)
    log_frame(arrays, lay, state, work, row)
    late = deque([0.0] * (1 + round(line.delay_s / CYCLE_S)))
    sent, unwind = np.zeros(drives), plant.drive_index("unwind")
    played: list[float] = []
    whole = Permission(adapt=True, applied_ratio=(1.0,), limit_ratio=(1.0,))
    tick = 0
    while law.stage not in (Stage.DONE, Stage.ABORTED):
        values = columns.values(row, theta0, float(tension_ref[0]))
        snapshot = Snapshot(
            tick=tick,
            t_ns=0,
            outcome=Outcome.OK,
            fresh=True,
            age_s=0.0,
            plc_heartbeat=tick,
            status=255,
            roll_id=1,
            values=values,
        )
        played.append(law.step(snapshot, CYCLE_S, whole)[0].value)
        late.append(played[-1])
        sent[unwind] = late.popleft()
        step_frame(
            arrays,
            lay,
            state,
            work,
            line.speed_m_s,
            line.speed_m_s,
            tension_ref,
            sent,
            rng.standard_normal(width),
            row,
        )
        tick += 1
    if law.stage is Stage.ABORTED or not math.isfinite(float(row.sum())):
        raise RuntimeError(f"line {line.seed}: {law.reason}")
    return law, played


def measured(line: DrawnLine, noise: int) -> tuple[Response, str, float]:
    """Return what a probe finds, why it found nothing of the drive, and how far it pulled (N)."""
    law, played = probe(line, noise)
    (result,) = law.result({"unwind": replace(ABOUT, radius_m=line.radius_m)})
    return result.response, result.response.no_drive, _pulled_N(line, np.array(played))


def _pulled_N(line: DrawnLine, played: npt.NDArray[np.float64]) -> float:
    """Return the largest tension that the tones make, by the frequency response of the true line.

    They repeat in ``PERIOD_S``: one period from the middle has each tone in a bin of its own.
    """
    period = round(PERIOD_S / CYCLE_S)
    middle = played.size // 2
    lines = np.fft.rfft(played[middle : middle + period])
    tones = np.flatnonzero(np.abs(lines) > 1e-3 * np.abs(lines).max())
    answer = np.zeros_like(lines)
    answer[tones] = lines[tones] * response(
        without_effects(line.declaration),
        "unwind",
        "unwind_tension_N",
        tones / (period * CYCLE_S),
        line.speed_m_s,
    )
    return float(np.abs(np.fft.irfft(answer, period)).max())
