"""P(jw) of the Euclid line from its frequency-domain model, so that no probe need run."""

from __future__ import annotations

import cmath
import math
from pathlib import Path

import numpy as np

from aff_runtime.core.response import Provenance, Response, ResponsePoint
from sim_plant.line.linear.frequency import response
from sim_plant.line.reading.load import load_declaration

ROOT = Path(__file__).parents[2]
LINE = ROOT / "config" / "lines" / "euclid_ripple.yaml"
SIGNALS = {"unwind": "unwind_tension_N", "swrap_follower": "pullroll_tension_N"}
CYCLE_S = 0.005
SPEED_M_S = 1.016  # 200 FPM
CYCLES_ON_THE_WAY = 2  # a value is sent one tick after its snapshot, and acts one scan later
DELAY_S = 0.05  # only unwinds the phase between the points
FREQUENCIES_HZ = np.geomspace(0.25, 12.0, 40)


def known_responses(
    line_speed_m_s: float = SPEED_M_S, cycle_s: float = CYCLE_S
) -> dict[str, Response]:
    """Return the response per actuator as a perfect probe would have measured it."""
    declaration = load_declaration(LINE)
    found = {}
    for actuator, signal in SIGNALS.items():
        values = response(declaration, actuator, signal, FREQUENCIES_HZ, line_speed_m_s)
        points = [
            ResponsePoint(
                frequency_Hz=float(f),
                gain=abs(p),
                phase_rad=cmath.phase(p) - math.tau * float(f) * CYCLES_ON_THE_WAY * cycle_s,
                relative_error=0.02,
                coherence=0.99,
            )
            for f, p in zip(FREQUENCIES_HZ, values, strict=True)
        ]
        about = Provenance(
            actuator=actuator, signal=signal, version="model", line_speed_m_s=line_speed_m_s
        )
        found[actuator] = Response(points=points, delay_s=DELAY_S, provenance=about)
    return found
