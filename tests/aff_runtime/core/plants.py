"""Discrete plants with a known response, and a site around them."""

from __future__ import annotations

import cmath
import math
from collections import deque
from dataclasses import replace

from aff_runtime.base.signals import Outcome, Permission, Snapshot
from aff_runtime.core.params import ActuatorParams, BlockParams, RollParams, SiteParams
from aff_runtime.core.response import Provenance, Response, ResponsePoint

CYCLE_S = 0.005
COUNT_RAD = math.tau / 4096
MODULUS_RAD = 2**32 * COUNT_RAD
FREE = Permission(adapt=True, applied_ratio=(1.0,), limit_ratio=(1.0,))
FROZEN = Permission(adapt=False, applied_ratio=(1.0,), limit_ratio=(1.0,))
DARK = Permission(adapt=False, applied_ratio=(0.0,), limit_ratio=(1.0,))
GRID_HZ = [0.4 * 1.3**k for k in range(12)]
RIPPLE = {("unwind", 1): 2.0 + 1.0j, ("unwind", 2): -0.8 + 0.5j}


class LagDelay:
    """y[k] = lag y[k-1] + (1 - lag) gain u[k-1-delay]."""

    def __init__(self, gain: float, delay: int = 0, lag: float = 0.0) -> None:
        self.gain, self.delay, self.lag = gain, delay, lag
        self._pipe = deque([0.0] * delay)
        self.y = 0.0

    def step(self, u: float) -> float:
        self._pipe.append(u)
        self.y = self.lag * self.y + (1 - self.lag) * self.gain * self._pipe.popleft()
        return self.y

    def at(self, frequency_Hz: float) -> complex:
        """Response from the value sent in tick k to the sample read in tick k."""
        z = cmath.exp(1j * math.tau * frequency_Hz * CYCLE_S)
        return self.gain * (1 - self.lag) * z ** (-1 - self.delay) / (1 - self.lag / z)


def measured(at, frequencies_Hz, *, delay_s=0.0, relative_error=0.01, coherence=0.99) -> Response:
    points = [
        ResponsePoint(
            frequency_Hz=f,
            gain=abs(at(f)),
            phase_rad=cmath.phase(at(f)),
            relative_error=relative_error,
            coherence=coherence,
        )
        for f in frequencies_Hz
    ]
    provenance = Provenance(actuator="unwind", signal="tension_N")
    return Response(points=points, delay_s=delay_s, provenance=provenance)


CHANNELS = ("tension_N", "tension_ref_N", "line_speed_m_s", "unwind_angle_rad", "swrap_angle_rad")
UNWIND = RollParams(
    name="unwind",
    angle="unwind_angle_rad",
    angle_modulus_rad=MODULUS_RAD,
    radius_m=0.2,
    line_speed="line_speed_m_s",
    resets_on_splice=True,
)
SWRAP = RollParams(name="swrap", angle="swrap_angle_rad", radius_m=0.15)
ACTUATOR = ActuatorParams(
    name="unwind",
    signal="tension_N",
    reference="tension_ref_N",
    blocks=(BlockParams(roll="unwind", orders=(1, 2), settle_s=8.0, amp_limit=0.02),),
)


def site(*actuators: ActuatorParams) -> SiteParams:
    return SiteParams(
        cycle_s=CYCLE_S,
        channels=CHANNELS,
        rolls=(UNWIND, SWRAP),
        actuators=actuators or (ACTUATOR,),
        line_speed="line_speed_m_s",
    )


def snapshot(tick: int, *values: float, fresh: bool = True, roll_id: int = 1) -> Snapshot:
    return Snapshot(
        tick=tick,
        t_ns=tick * 5_000_000,
        outcome=Outcome.OK,
        fresh=fresh,
        age_s=0.0,
        plc_heartbeat=tick,
        status=255,
        roll_id=roll_id,
        values=values,
    )


class Line:
    """A line of two rolls with given ripple (complex N per order) behind one actuator."""

    def __init__(self, plant: LagDelay, ripple, *, omega=5.0, swrap_omega=6.7, seed_noise=None):
        self.plant, self.ripple, self.noise = plant, ripple, seed_noise
        self.omega, self.swrap_omega = omega, swrap_omega
        self.theta, self.swrap_theta, self.tick = 0.3, 1.1, 0
        self.u = self.ripple_N = 0.0

    def disturbance(self) -> float:
        ripple_N = 0.0
        for (roll, n), c in self.ripple.items():
            angle = self.theta if roll == "unwind" else self.swrap_theta
            ripple_N += (c * cmath.exp(1j * n * angle)).real
        return ripple_N

    def read(self) -> tuple[float, ...]:
        self.ripple_N = self.disturbance()
        y = 90.0 + self.plant.step(self.u) + self.ripple_N
        y += self.noise() if self.noise else 0.0
        counts = round(self.theta / COUNT_RAD)
        wrapped = ((counts + 2**31) % 2**32 - 2**31) * COUNT_RAD
        return y, 90.0, self.omega * 0.2, wrapped, self.swrap_theta

    def advance(self, u: float) -> None:
        self.u = u
        self.tick += 1
        self.theta += self.omega * CYCLE_S
        self.swrap_theta += self.swrap_omega * CYCLE_S

    def run(self, law, seconds: float, permission: Permission = FREE, **kw) -> list[float]:
        """Close the loop; return the true tension ripple, sample by sample."""
        trace = []
        for _ in range(round(seconds / CYCLE_S)):
            values = self.read()
            (step,) = law.step(snapshot(self.tick, *values, **kw), CYCLE_S, permission)
            assert math.isfinite(step.value)
            assert abs(step.value) <= step.peak_bound + 1e-12
            trace.append(self.plant.y + self.ripple_N)
            self.advance(step.value)
        return trace


def rms(trace) -> float:
    return math.sqrt(sum(x * x for x in trace) / len(trace))


def with_blocks(*blocks: BlockParams, **kw) -> ActuatorParams:
    return replace(ACTUATOR, blocks=blocks, **kw)
