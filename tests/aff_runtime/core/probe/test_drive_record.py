"""Lines on which a probe can know nothing of the drive: it says what is missing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from aff_runtime.core.params import ActuatorParams, BlockParams, OutputKind, RollParams, SiteParams
from aff_runtime.core.phase import RollPhase
from aff_runtime.core.probe.drive_record import DriveRecord
from aff_runtime.core.probe.estimate import Fit

CHANNELS = ("unwind_tension_N", "line_speed_m_s", "unwind_angle_rad", "unwind_radius_m")
ROLL = RollParams(
    name="unwind", angle="unwind_angle_rad", line_speed="line_speed_m_s", radius="unwind_radius_m"
)
ACTUATOR = ActuatorParams(
    name="unwind",
    signal="unwind_tension_N",
    blocks=(BlockParams(roll="unwind", orders=(1,), settle_s=6.0, amp_limit=0.1),),
)
SAMPLES = 200
CYCLE_S = 0.005


def said(
    actuator: ActuatorParams, roll: RollParams, *, radius_m: float = 0.2, every: int = 1
) -> str:
    """Return why nothing is found of a roll that turns evenly for a second.

    ``every``: the PLC has new readings in so many cycles once.
    """
    site = SiteParams(
        cycle_s=CYCLE_S,
        channels=CHANNELS,
        rolls=(roll,),
        actuators=(actuator,),
        line_speed="line_speed_m_s",
    )
    phase = RollPhase(roll, {name: k for k, name in enumerate(CHANNELS)})
    record = DriveRecord(site, actuator, {roll.name: phase}, SAMPLES)
    for k in range(SAMPLES):
        values = (89.0, 1.0, 5.0 * k * CYCLE_S, radius_m)
        fresh = k % every == 0
        phase.step(values, CYCLE_S, fresh=fresh)
        if fresh:
            record.take(k, values)
    time_s = np.arange(SAMPLES) * CYCLE_S
    found, why = record.identified(
        time_s=time_s,
        keep=np.arange(SAMPLES) % every == 0,
        signal=np.full(SAMPLES, 89.0),
        fit=Fit(points=(), strange=(), design=np.ones((SAMPLES, 1))),
        sent=(),
    )
    assert found is None
    return why


REFUSED = {
    "torque": (
        replace(ACTUATOR, output=OutputKind.TORQUE_REFERENCE),
        ROLL,
        "a torque goes in behind the speed loop",
    ),
    "speed signal": (
        replace(ACTUATOR, signal="follower_speed_m_s"),
        ROLL,
        "follower_speed_m_s is no tension",
    ),
    "roller": (ACTUATOR, replace(ROLL, radius=None, radius_m=0.15), "has no radius channel"),
    "no angle": (ACTUATOR, replace(ROLL, angle=None), "has no angle and no speed channel"),
    "other roll": (replace(ACTUATOR, turns="rewind"), ROLL, "rewind has no radius channel"),
}


@pytest.mark.parametrize(("actuator", "roll", "why"), REFUSED.values(), ids=REFUSED)
def test_what_cannot_be_known_is_said(actuator, roll, why):
    assert why in said(actuator, roll)


def test_an_angle_that_the_line_speed_stands_in_for_is_not_the_rolls_own():
    # an encoder that stands still while the roll turns is out; the line speed takes its place
    still = replace(ROLL, angle="unwind_radius_m")
    assert "was lost in 90.0% of the readings, 2% may be" in said(ACTUATOR, still)
    # a PLC that scans half as often: it is out from 0.11 s of the second on, 89 of 100 readings
    assert "was lost in 89.0% of the readings, 2% may be" in said(ACTUATOR, still, every=2)
