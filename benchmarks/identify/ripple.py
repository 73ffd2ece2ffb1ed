"""What the shape law leaves of the ripple with one drive's numbers or another's."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from aff_runtime.core.identified import IdentifiedDrive
from aff_runtime.core.impulse import from_response
from aff_runtime.core.law import ActuatorLaw
from aff_runtime.core.params import DriveParams
from aff_runtime.core.phase import RollPhase
from aff_runtime.core.response import Response
from aff_runtime.core.shape.law import ShapeLaw
from benchmarks.control.lines import Hidden
from benchmarks.control.lockstep import Recording, run
from benchmarks.identify.drawn import DrawnLine
from benchmarks.identify.probing import CYCLE_S, actuator

ON_S, LASTS_S, JUDGED_S = 5.0, 50.0, 20.0
MEMORY_S = 4.0


def filled_in(line: DrawnLine, found: IdentifiedDrive) -> DriveParams:
    """Return the identified drive; the web is declared, as it stands on the roll's label."""
    true = line.drive()
    web_kg_m2 = true.inertia_at(found.radius_m) - true.inertia_kg_m2
    gain, time_s = found.speed_gain_rad_s.value, found.integral_time_s.value
    return DriveParams(
        roll="unwind",
        K_ref_rad_s=gain,
        zeta=0.5 * math.sqrt(gain * time_s),
        inertia_kg_m2=max(1e-3, found.inertia_kg_m2.value - web_kg_m2),
        web_density_kg_m3=true.web_density_kg_m3,
        web_width_m=true.web_width_m,
        core_radius_m=true.core_radius_m,
        tension_N=true.tension_N,
        web_leaves_rad=true.web_leaves_rad,
    )


def left_N(
    line: DrawnLine, drive: DriveParams | None, transport_s: float, response: Response
) -> float:
    """Return the tension ripple (rms, N) under the shape law; without a drive under PI alone."""
    laws: dict[str, object] = {}
    if drive is not None:
        loop = from_response(response, cycle_s=CYCLE_S, memory_s=MEMORY_S)
        params = actuator(drive, transport_s)

        def build(phases: Mapping[str, RollPhase], cycle_s: float) -> ActuatorLaw:
            return ShapeLaw(
                params, drive=drive, phases=phases, loop=loop, cycle_s=cycle_s, response=response
            )

        laws["unwind"] = build
    speed = np.full(round(LASTS_S / CYCLE_S), line.speed_m_s)
    record: Recording = run(
        line.declaration,
        laws,  # type: ignore[arg-type]
        speed,
        seed=line.seed,
        on_s=ON_S,
        cycle_s=CYCLE_S,
        hidden=Hidden(delay_s=line.delay_s),
    )
    judged = record.tension_N[-round(JUDGED_S / CYCLE_S) :]
    return float(np.std(judged))
