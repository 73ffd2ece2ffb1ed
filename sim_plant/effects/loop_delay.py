"""A correction that reaches its drive late."""

from __future__ import annotations

from collections.abc import Mapping

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import DELAY_RING_TICKS, LineArrays
from sim_plant.base.effects import Effect, Parameter, Value


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Delay every correction (tension loop and AFF) to drive ``place`` by whole drive ticks.

    Phase -2 pi f delay, magnitude unchanged. It counts from the scan that works a correction out
    to the tick that takes it; without delay that is the tick at the scan's own instant. Where
    scans are not in step with ticks a correction waits for the next one, up to a tick and half a
    tick on average: a record shows that as delay.
    """
    ticks = round(float(parameters["delay_s"]) / float(arrays.timing["drive_tick_s"][0]))
    total = int(arrays.drives["delay_ticks"][place]) + ticks
    if not 0 <= total < DELAY_RING_TICKS:
        raise PlantError(
            f"loop_delay.delay_s: {total} drive ticks; expected 0 to {DELAY_RING_TICKS - 1}"
        )
    arrays.drives["delay_ticks"][place] = total
    return arrays


EFFECT = Effect(
    name="loop_delay",
    place="drive",
    candidates="trimmed_drive",
    accepts={
        "delay_s": Parameter(
            default=0.0,
            unit="s",
            typical=0.03,
            low=0.0,
            high=0.5,
            step=0.01,
            tries=(0.01, 0.02, 0.03, 0.045, 0.06, 0.08, 0.11),
            known_to="drive tick",  # scans and ticks are not in step: a correction waits up to one
        )  # the step is a whole number of any usual drive tick
    },
    fitted=("delay_s",),
    apply=apply,
    text="corrections reach their drive late: the tension loop rings more",
    shows=None,
    remedy="look for what is slow between load cell and drive {place}: task period, bus, filters",
)
