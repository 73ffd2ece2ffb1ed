"""The source's law as printed, for side-by-side demonstrations only."""

from __future__ import annotations

import math
from collections.abc import Mapping

from aff_runtime.base.signals import ActuatorStep
from aff_runtime.core.law import ActuatorLaw, Inputs, LawBuilder
from aff_runtime.core.laws.catalogue import LAWS
from aff_runtime.core.params import ActuatorParams
from aff_runtime.core.phase import RollPhase


class PrintedLaw:
    """(5.10) and (5.14) to the letter: no sign of P, no phase of P, no angle of the roll.

    theta_1' = g1 e sin(n psi), theta_2' = g1 e cos(n psi), v_ff = -theta_1 sin - theta_2 cos,
    with psi the time integral of v / R (5.9). With (5.10), a velocity error, Re P > 0 and it
    diverges; with (5.14), a tension error upstream, Re P < 0 and it diverges where arg(-P)
    exceeds 90 degrees. The guard limits it like any law; weights stop at ``amp_limit``.
    ``gain`` is g1, output unit per signal unit, 1/s.
    """

    def __init__(
        self, params: ActuatorParams, *, phases: Mapping[str, RollPhase], gain: float
    ) -> None:
        self._p = params
        self._gain = gain
        self._orders = params.orders
        self._limits = [b.amp_limit for b in params.blocks for _ in b.orders]
        self._rolls = [phases[roll] for roll, _ in self._orders]
        self._psi = dict.fromkeys((roll for roll, _ in self._orders), 0.0)
        self._phases = {roll: phases[roll] for roll in self._psi}
        self._theta = [[0.0, 0.0] for _ in self._orders]

    def step(self, inputs: Inputs) -> ActuatorStep:
        """Advance by one tick of Euler integration."""
        speed = inputs.line_speed_m_s
        if not math.isfinite(speed):
            return ActuatorStep(value=0.0, peak_bound=0.0, slew_bound=0.0)
        for roll, phase in self._phases.items():
            if phase.radius_m > 0.0:
                self._psi[roll] += speed / phase.radius_m * inputs.dt_s
        reference = inputs.reference if math.isfinite(inputs.reference) else 0.0
        error = reference - inputs.signal
        adapt = inputs.adapt and inputs.fresh and math.isfinite(error)
        value = peak = slew = 0.0
        for i, (roll, order) in enumerate(self._orders):
            theta = self._theta[i]
            sine, cosine = math.sin(order * self._psi[roll]), math.cos(order * self._psi[roll])
            if adapt:
                gain = self._gain * inputs.dt_s
                theta[0] += gain * error * sine
                theta[1] += gain * error * cosine
            size = math.hypot(theta[0], theta[1])
            keep = min(1.0, self._limits[i] / size) if size > 0.0 else 1.0
            keep *= inputs.limit_ratio if 0.0 < inputs.limit_ratio < 1.0 else 1.0
            theta[0] *= keep
            theta[1] *= keep
            value -= theta[0] * sine + theta[1] * cosine
            peak += size * keep
            slew += size * keep * order * abs(speed) / max(self._rolls[i].radius_m, 1e-3)
            slew += abs(self._gain * error) if adapt else 0.0
        if not math.isfinite(value + slew):
            self._theta = [[0.0, 0.0] for _ in self._orders]
            return ActuatorStep(value=0.0, peak_bound=0.0, slew_bound=0.0)
        return ActuatorStep(value=value, peak_bound=peak, slew_bound=slew)

    def reset_roll(self, roll: str) -> None:
        """Forget a roll."""
        for theta, (name, _) in zip(self._theta, self._orders, strict=True):
            if name == roll:
                theta[0] = theta[1] = 0.0

    def weights(self) -> Mapping[tuple[str, int], complex]:
        """Return -theta_2 + j theta_1 by (roll, order)."""
        return {
            key: complex(-theta[1], theta[0])
            for key, theta in zip(self._orders, self._theta, strict=True)
        }

    def adopt(self, old: ActuatorLaw) -> None:
        """Go on with the old phases and weights; start at zero after another law."""
        if isinstance(old, PrintedLaw):
            self._follow(old)

    def _follow(self, old: PrintedLaw) -> None:
        learned = old.weights()
        for theta, key in zip(self._theta, self._orders, strict=True):
            weight = learned.get(key, 0j)
            theta[:] = [weight.imag, -weight.real]
        self._psi.update({k: v for k, v in old._psi.items() if k in self._psi})

    def objections(self) -> tuple[str, ...]:
        """Return nothing: the printed law asks for no response, which is its flaw."""
        return ()

    def ripple(self) -> tuple[float, float]:
        """Return NaN: it watches nothing."""
        return math.nan, math.nan

    def telemetry(self) -> tuple[float, ...]:
        """Return amplitude and phase per order."""
        row: list[float] = []
        for theta in self._theta:
            amplitude = math.hypot(theta[0], theta[1])
            row += (amplitude, math.degrees(math.atan2(theta[0], -theta[1])))
        return tuple(row)

    def telemetry_names(self) -> tuple[str, ...]:
        """Return two columns per order."""
        columns = (f"amplitude_{self._p.unit}", "phase_deg")
        return tuple(f"{roll}_{n}x.{column}" for roll, n in self._orders for column in columns)


def with_printed(gain: float) -> Mapping[str, LawBuilder]:
    """Return the product's laws, and this one as ``printed``."""
    return {
        **LAWS,
        "printed": lambda setup: PrintedLaw(setup.params, phases=setup.phases, gain=gain),
    }
