"""A site with a shape law around a plant of known response."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from aff_runtime.base.signals import Permission
from aff_runtime.core.impulse import LoopModel, from_taps
from aff_runtime.core.law import Inputs
from aff_runtime.core.params import ActuatorParams, BlockParams, DriveParams, ShapeParams
from aff_runtime.core.shape.law import ShapeLaw
from tests.aff_runtime.core.plants import ACTUATOR, CYCLE_S, SWRAP, UNWIND, LagDelay

DRIVE = DriveParams(roll="unwind", K_ref_rad_s=15.0, zeta=1.1, inertia_kg_m2=0.4, tension_N=90.0)
# no torque on the roll and no imbalance: the length rate alone
LENGTH_ONLY = replace(DRIVE, torque_term=False, imbalance=False)
GAIN_N_S_M = 400.0


def actuator(orders=(1, 2), extra=(), **kw) -> ActuatorParams:
    blocks = [BlockParams(roll="unwind", orders=tuple(orders), settle_s=8.0, amp_limit=0.3)]
    blocks += [BlockParams(roll=r, orders=o, settle_s=8.0, amp_limit=0.3) for r, o in extra]
    return replace(ACTUATOR, **{"law": "shape", "drive": DRIVE, "blocks": tuple(blocks), **kw})


def loop_of(plant: LagDelay, length: int = 200) -> LoopModel:
    """Impulse response by pushing a fresh copy of the plant once."""
    twin = LagDelay(plant.gain, len(plant._pipe), plant.lag)
    taps = [twin.step(1.0)] + [twin.step(0.0) for _ in range(length - 1)]
    return from_taps((0.2,), [np.array(taps)])


class Phase:
    """A roll that turns steadily, as the law sees it."""

    def __init__(self, omega_rad_s: float, radius_m: float, theta_rad: float = 0.0) -> None:
        from aff_runtime.core.phase import Quality

        self.omega_rad_s, self.radius_m, self.theta_rad = omega_rad_s, radius_m, theta_rad
        self.quality = Quality.GOOD

    def lead(self, lead_s: float) -> float:
        return self.theta_rad + self.omega_rad_s * lead_s

    def turn(self) -> None:
        self.theta_rad += self.omega_rad_s * CYCLE_S


class Rig:
    """Law, plant and ripple in lockstep: ``ripple`` is complex N by (roll, order)."""

    def __init__(
        self, params=None, *, plant=None, ripple=None, omega=5.0, known=None, seed=3, response=None
    ):
        self.params = params or actuator()
        self.plant = plant or LagDelay(GAIN_N_S_M, delay=2, lag=0.6)
        self.phases = {
            "unwind": Phase(omega, UNWIND.radius_m, 0.3),
            "swrap": Phase(omega * UNWIND.radius_m / SWRAP.radius_m, SWRAP.radius_m, 1.1),
        }
        self.ripple = ripple or {}
        self.law = ShapeLaw(
            self.params,
            drive=self.params.drive,
            phases=self.phases,
            loop=loop_of(known or self.plant),
            cycle_s=CYCLE_S,
            response=response,
        )
        self.inputs = Inputs(applied_ratio=1.0, limit_ratio=1.0)
        self.rng = np.random.default_rng(seed)
        self.noise_N = 0.0
        self.limit = self.slew_limit = np.inf
        self.u = 0.0
        self.last = None

    def disturbance(self) -> float:
        return sum(
            (c * np.exp(1j * n * self.phases[r].theta_rad)).real
            for (r, n), c in self.ripple.items()
        )

    def tick(self, *, adapt=True, fresh=True, signal=None) -> float:
        true = self.plant.step(self.u) + self.disturbance()
        given = self.inputs
        given.signal = 90.0 + true + self.noise_N * self.rng.standard_normal()
        if signal is not None:
            given.signal = signal
        given.reference = 90.0
        unwind = self.phases["unwind"]
        given.line_speed_m_s = unwind.omega_rad_s * unwind.radius_m
        given.dt_s, given.fresh, given.adapt = CYCLE_S, fresh, adapt
        given.limit, given.slew_limit = self.limit, self.slew_limit
        step = self.last = self.law.step(given)
        scale = min(1.0, self.limit / step.peak_bound) if step.peak_bound > 0 else 1.0
        scale = min(scale, self.slew_limit / step.slew_bound) if step.slew_bound > 0 else scale
        given.limit_ratio = given.applied_ratio = scale
        self.u = step.value * scale
        for phase in self.phases.values():
            phase.turn()
        return true

    def run(self, seconds: float, **kw) -> np.ndarray:
        return np.array([self.tick(**kw) for _ in range(round(seconds / CYCLE_S))])


FREE = Permission(adapt=True, applied_ratio=(1.0,), limit_ratio=(1.0,))
SHAPE = ShapeParams()
