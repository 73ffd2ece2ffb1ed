"""What a load cell makes of its roller's mean tension, at the order of an exciting roller."""

from __future__ import annotations

import numpy as np

from sim_plant.base.order_tracking import order_amplitudes
from sim_plant.line.declared.declaration import EffectEntry
from tests.sim_plant.effects.running import SPEED_M_S, effect, run, span

EXCITER = effect("eccentric_roller", "R6", cos_m=2e-4)
FREQUENCY_HZ = SPEED_M_S / 0.0381 / 6.283185307179586


def cell_response(*effects: EffectEntry) -> complex:
    """Return reading over mean tension at R3 as phasors, R6 turning once per period."""
    made = run(EXCITER, *effects, seconds=8.0)
    angle = 2.0 * np.pi * FREQUENCY_HZ * 0.005 * np.arange(made["r3_tension_N"].size)
    tensions = made["span_tension_N"]
    mean = 0.5 * (tensions[:, span("R2-R3")] + tensions[:, span("R3-R4")])
    reading = order_amplitudes(made["r3_tension_N"], angle, [1])[0]
    return complex(reading / order_amplitudes(mean, angle, [1])[0])
