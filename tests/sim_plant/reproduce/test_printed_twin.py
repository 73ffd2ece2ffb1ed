"""The plant's printed law and the runtime's are the same law, written twice."""

import math

import pytest

from aff_runtime.core.law import Inputs
from aff_runtime.core.params import ActuatorParams, BlockParams, RollParams
from aff_runtime.core.phase import RollPhase
from benchmarks.control.printed import PrintedLaw
from sim_plant.reproduce.source_laws import PrintedAff

DT_S, SPEED_M_S, RADIUS_M, GAIN = 0.005, 1.0, 0.2, 0.002


def test_both_printed_laws_give_the_same_correction() -> None:
    roll = RollParams(name="unwind", angle="angle", radius_m=RADIUS_M, line_speed="speed")
    block = BlockParams(roll="unwind", orders=(1, 2, 3), settle_s=8.0, amp_limit=0.02)
    params = ActuatorParams(
        name="unwind", signal="tension", reference="reference", blocks=(block,)
    )
    runtime = PrintedLaw(
        params, phases={"unwind": RollPhase(roll, {"angle": 0, "speed": 1})}, gain=GAIN
    )
    plant = PrintedAff(orders=(1, 2, 3), gain=GAIN, limit=0.02)
    inputs = Inputs(
        reference=89.0,
        line_speed_m_s=SPEED_M_S,
        dt_s=DT_S,
        fresh=True,
        adapt=True,
        limit_ratio=1.0,
        applied_ratio=1.0,
    )
    psi = 0.0
    for k in range(4000):
        psi += SPEED_M_S / RADIUS_M * DT_S
        tension = 89.0 + math.cos(5.0 * k * DT_S + 0.3) + 0.4 * math.cos(10.0 * k * DT_S)
        inputs.signal = tension
        expected = runtime.step(inputs).value
        assert plant.step(89.0 - tension, psi, DT_S) == pytest.approx(expected, abs=1e-12)
    assert abs(expected) > 1e-3
