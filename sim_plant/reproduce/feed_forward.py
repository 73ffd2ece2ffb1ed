"""The line in closed loop with a feed-forward law, sample by sample, as on a machine."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.base.order_tracking import order_amplitudes
from sim_plant.line.running.simulation import LineSimulation
from sim_plant.reproduce.euclid import TENSION_N, set_torque, times

Readings = Mapping[str, float]


class Law(Protocol):
    """Any law of ``source_laws``."""

    def step(self, error: float, psi_rad: float, dt_s: float) -> float:
        """Return the output for this sample."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Loop:
    """One law at one drive.

    Attributes
    ----------
    roller : the drive that gets the output, as velocity (m/s) or, with ``torque``, as torque.
    error : readings -> error of the law, reference minus measured.
    psi_rate_rad_s : readings -> speed of the law's own angle (time-based, 5.9); None to use
        ``angle`` (channel name of the roll's angle) instead.
    """

    roller: str
    law: Law
    error: Callable[[Readings], float]
    angle: str = ""
    psi_rate_rad_s: Callable[[Readings], float] | None = None
    torque: bool = False


def unwind_tension_error(readings: Readings) -> float:
    """Return reference minus measured tension of the unwind span, N."""
    return TENSION_N - readings["unwind_tension_N"]


def run(
    line: LineSimulation,
    loop: Loop | None,
    duration_s: float,
    speed_m_s: float | Callable[[float], float],
    keep: Sequence[str],
) -> dict[str, Array]:
    """Return the kept channels and ``time_s`` of a run; a web that breaks ends the run early.

    A broken web is a line that diverges: its record is what was recorded until then.
    """
    dt = line.sample_time_s
    rows = round(duration_s / dt)
    table = np.empty((rows, len(keep)))
    readings: Readings = line.readings()
    psi, output, done = 0.0, 0.0, rows
    inputs = {"tension_ref_N": TENSION_N}
    for k in range(rows):
        if loop is not None:
            if loop.psi_rate_rad_s is not None:
                psi += loop.psi_rate_rad_s(readings) * dt
            else:
                psi = readings[loop.angle]
            output = loop.law.step(loop.error(readings), psi, dt)
            if loop.torque:
                set_torque(line, output)
            else:
                inputs[f"aff_{loop.roller}_m_s"] = output
        inputs["line_speed_ref_m_s"] = speed_m_s(k * dt) if callable(speed_m_s) else speed_m_s
        try:
            readings = line.step(inputs)
        except PlantError:
            done = k
            break
        table[k] = [readings[name] for name in keep]
        if not np.all(np.isfinite(table[k])):
            done = k
            break
    record = {name: table[:done, i] for i, name in enumerate(keep)}
    record["time_s"] = times(done, dt)
    return record


def orders_after(
    record: Mapping[str, Array], signal: str, angle: str, orders: Sequence[int], from_s: float
) -> Array:
    """Return peak amplitudes of the orders of one roll in a signal from ``from_s`` on."""
    late = record["time_s"] >= from_s
    return np.abs(order_amplitudes(record[signal][late], record[angle][late], orders))


def decibels(before: Array, after: Array) -> list[float]:
    """Return attenuation, dB, order by order."""
    return [
        float(v) for v in 20.0 * np.log10(np.maximum(before, 1e-12) / np.maximum(after, 1e-12))
    ]
