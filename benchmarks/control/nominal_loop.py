"""P of a declared line: the answer of its nominal, noise-free simulation to one short push."""

from __future__ import annotations

import functools
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from aff_runtime.core.impulse import LoopModel, from_taps
from benchmarks.control.lines import INCH_M, nominal
from sim_plant.line.open import make_line

PUSH_M_S = 2e-3
RADII_M = tuple(r * INCH_M for r in (2.3, 3.0, 3.8, 4.75, 6.375, 8.05))
SPEED_M_S = {"film": 10.0}
OTHER_SPEED_M_S = 1.016
FILM_RADII_M = (0.09, 0.12, 0.15, 0.2, 0.25, 0.3)


def impulse_response(
    material: str, radius_m: float, *, drive: str, channel: str, cycle_s: float, memory_s: float
) -> npt.NDArray[np.float64]:
    """Return taps from a correction at ``drive`` to a tension channel, one sample of transport.

    The line moves, so its resting answer is taken out by a second run without the push.
    """
    count = round(memory_s / cycle_s)
    speed_m_s = SPEED_M_S.get(material, OTHER_SPEED_M_S)
    signals = []
    for push in (0.0, PUSH_M_S):
        line = make_line(
            nominal(material, radius_m), seed=None, sample_time_s=cycle_s, speed_m_s=speed_m_s
        )
        # a small push would see the single steps of the sensors
        line.arrays.drives["lsb_rad_s"] = line.arrays.cells["lsb_N"] = 0.0
        line.settle()
        steps = count + 2
        aff = np.zeros(steps)
        aff[1] = push  # asked for in tick 0
        found = line.simulate(
            np.full(steps, speed_m_s),
            np.full(steps, line.declaration.operating_point.tension_N),
            {drive: aff},
        )
        signals.append(found["true_" + channel])
    return np.asarray((signals[1] - signals[0])[1 : count + 1] / PUSH_M_S)


@functools.cache
def nominal_loop(
    material: str,
    drive: str = "unwind",
    channel: str = "unwind_tension_N",
    cycle_s: float = 0.005,
    memory_s: float = 4.0,
    radii_m: Sequence[float] = RADII_M,
) -> LoopModel:
    """Return P of the nominal line at several radii."""
    taps = [
        impulse_response(
            material, r, drive=drive, channel=channel, cycle_s=cycle_s, memory_s=memory_s
        )
        for r in radii_m
    ]
    return from_taps(tuple(radii_m), taps)
