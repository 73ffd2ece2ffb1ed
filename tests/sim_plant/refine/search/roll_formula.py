"""A line of one roll: what its orders do to a tension, by a formula."""

from contextlib import contextmanager

import numpy as np
import pytest

from sim_plant.effects import out_of_round_roll
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.effects.out_of_round_roll import profile
from tests.sim_plant.refine.small import LINE

ROLL = BY_NAME["out_of_round_roll"]
SAMPLES, ORDERS = 2000, 12
RADIUS_M = LINE.rollers[0].radius_m
SPEED_RAD_S = np.linspace(4.0, 8.0, SAMPLES)
"""At one speed alone a delay is an angle."""
TURN_RAD = 0.01 * np.cumsum(SPEED_RAD_S)
DEFAULTS = {name: row.default for name, row in ROLL.accepts.items()}


COARSE = 2048
"""Points of an outline: enough for the orders here, in an eighth of the time."""


@contextmanager
def coarse_outlines():
    """Make profiles of fewer points, and forget them at the end."""

    def forget():
        out_of_round_roll._at_angle_0.cache_clear()
        out_of_round_roll._profile.cache_clear()

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sim_plant.geometry.roll_profiles.POINTS", COARSE)
        forget()
        yield
    forget()


def tension(case):
    """Return what a roll's orders do to a tension, turned back by the delay of its loop."""
    found, delay_s = np.zeros(SAMPLES), 0.0
    for effect in case.effects:
        delay_s += float(dict(effect.parameters).get("delay_s", 0.0))
    for effect in case.effects:
        if effect.effect != "out_of_round_roll":
            continue
        shape = profile(RADIUS_M, DEFAULTS | dict(effect.parameters)).deviation_m
        turn = np.exp(1j * (TURN_RAD - SPEED_RAD_S * delay_s))
        of_orders = np.zeros(SAMPLES, dtype=np.complex128)
        for size_m in shape[:ORDERS][::-1]:  # order n: size_m * turn ** n
            of_orders = (of_orders + size_m) * turn
        found += 5e4 * of_orders.real
    return found[None, :]
