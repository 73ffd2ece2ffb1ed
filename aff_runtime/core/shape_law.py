"""The shape law of one actuator: weights are the roll's shape in metres."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from aff_runtime.base.signals import ActuatorStep
from aff_runtime.core.gate import RAMP_S, SpeedGate
from aff_runtime.core.impulse import LoopModel
from aff_runtime.core.law import ActuatorLaw, Inputs
from aff_runtime.core.params import ActuatorParams, DriveParams
from aff_runtime.core.phase import Quality, RollPhase
from aff_runtime.core.shape_basis import ShapeBasis
from aff_runtime.core.shape_bounds import PeakBound
from aff_runtime.core.shape_filter import LoopFilter
from aff_runtime.core.shape_room import Room
from aff_runtime.core.shape_kalman import ShapeFilter

NEWTON_TURNS = 0.5
GAIN_FROM, GAIN_TO = 1.0 / 3.0, 3.0
ABSURD = 1e6
SILENT = ActuatorStep(value=0.0, peak_bound=0.0, slew_bound=0.0)


class ShapeLaw:
    """Learns a shape per roll, and a correction of P per order; sends what cancels it.

    v_ff = Re sum_n W_n b_n with b_n of ``ShapeBasis``; the filter estimates what is left of every
    order, m_n = a_n + (1 + d_n) W_n, and the weight follows by Newton steps,
    W_n <- W_n - rate m_n / (1 + d_n), so an error of the gain correction slows but leaves nothing
    behind. The weights stay when the speed changes.
    """

    def __init__(
        self,
        params: ActuatorParams,
        *,
        drive: DriveParams,
        phases: Mapping[str, RollPhase],
        loop: LoopModel,
        cycle_s: float,
    ) -> None:
        self._p = params
        self._cycle_s = cycle_s
        columns = list(params.orders)
        self._phases = {name: phases[name] for name in dict.fromkeys(r for r, _ in columns)}
        self._own = phases[drive.roll]
        lead_s = 0.5 * cycle_s + params.transport_s
        self.basis = ShapeBasis(columns, dict(self._phases), drive, lead_s)
        count = self.basis.order.size
        self._roll_of = [r for r, _ in columns] + [drive.roll] * (count - len(columns))
        self.loop_filter = LoopFilter(loop, count)
        self.filter = ShapeFilter(count, params.shape.memory_turns, params.shape.signal_sd)
        self.weight = np.zeros(count, dtype=np.complex128)
        self._sent = np.zeros(count, dtype=np.complex128)
        self._bounds = PeakBound(self.basis.order, self._roll_of, drive.roll)
        self._room = Room(count)
        self._phi_size = np.zeros(count)
        self._gate = SpeedGate(params.active_above_m_s)
        self._tension_N = drive.tension_N
        self.adapting = False
        self._step_1_s = np.zeros(count)

    def step(self, inputs: Inputs) -> ActuatorStep:
        """Advance by one tick; weights move only on a fresh sample and with permission."""
        dt_s = inputs.dt_s
        if not 0.0 < dt_s < math.inf:
            return SILENT
        self._room.step(inputs.limit_ratio, self.basis.b, self.weight, self._phi_size, dt_s)
        ratio = inputs.applied_ratio if math.isfinite(inputs.applied_ratio) else 0.0
        ticks = round(dt_s / self._cycle_s)
        self.loop_filter.follow_radius(self._own.radius_m)
        self.loop_filter.push(self.basis.b, (ratio * self._sent) * self.basis.b, ticks)
        gate = self._gate.step(self._speed_m_s(inputs.line_speed_m_s), dt_s)
        self._learn(inputs, gate, dt_s)
        if inputs.reference > 0.0:
            self._tension_N = inputs.reference
        self.basis.step(inputs.line_speed_m_s, self._tension_N, dt_s)
        return self._send(gate)

    def _speed_m_s(self, line_speed_m_s: float) -> float:
        if math.isfinite(line_speed_m_s):
            return line_speed_m_s
        return abs(self._own.omega_rad_s * self._own.radius_m)

    def _learn(self, inputs: Inputs, gate: float, dt_s: float) -> None:
        error = inputs.signal - (inputs.reference if inputs.reference > 0.0 else self._tension_N)
        good = inputs.fresh and abs(error) < ABSURD
        seen = all(phase.quality is not Quality.LOST for phase in self._phases.values())
        self.adapting = inputs.adapt and gate == 1.0 and good and seen
        if not self.adapting:
            self._step_1_s[:] = 0.0
            return
        phi, psi = self.loop_filter.read()
        self._phi_size = np.abs(phi)
        turn_s = self.basis.turn_s
        self.filter.step(error, phi, psi, turn_s, dt_s)
        gain = 1.0 + self.filter.correction
        left = self.filter.deviation + gain * self.weight
        size = np.abs(gain)
        gain *= np.clip(size, GAIN_FROM, GAIN_TO) / np.maximum(size, 1e-9)
        share = -np.expm1(-dt_s / (NEWTON_TURNS * turn_s))
        move = share * left / gain
        self.weight -= move
        length = np.abs(self.weight)
        limit = self._p.shape.weight_limit_m
        self.weight *= limit / np.maximum(length, limit)
        self._step_1_s = np.abs(move) / dt_s

    def _send(self, gate: float) -> ActuatorStep:
        b = self.basis.b
        self._sent = (gate * self._room.share) * self.weight
        parts = self._sent * b
        value = float(parts.real.sum())
        peak, slew = self._bounds.of(parts, self.basis.omega_rad_s)
        peak = max(peak, abs(value))
        self._room.peak = peak
        slew += float(self._step_1_s @ np.abs(b))
        if self._gate.moving:
            slew += peak / (max(gate, 0.01) * RAMP_S)
        if not math.isfinite(value + slew):
            return SILENT
        return ActuatorStep(value=value, peak_bound=peak, slew_bound=slew)

    def reset_roll(self, roll: str) -> None:
        """Forget the shape of a roll that was changed; what was learned of P stays."""
        changed = np.array([name == roll for name in self._roll_of])
        self.weight[changed] = 0.0
        self._sent[changed] = 0.0
        self.filter.forget(changed)
        self.loop_filter.forget(changed)

    def weights(self) -> Mapping[tuple[str, int], complex]:
        """Return the shape by (roll, order), m; the imbalance is not among them."""
        return {key: complex(w) for key, w in zip(self._p.orders, self.weight, strict=False)}

    def adopt(self, old: ActuatorLaw) -> None:
        """Take over weights and what was learned; new orders start from zero."""

    def objections(self) -> tuple[str, ...]:
        """Return why this actuator may not arm at the present speed."""
        return ()

    def ripple(self) -> tuple[float, float]:
        """Return the root sum of squares of all orders' amplitudes, before and now."""
        return math.nan, math.nan

    def telemetry(self) -> tuple[float, ...]:
        """Return amplitude (mm) per column."""
        return tuple(float(x) for x in np.abs(self.weight))

    def telemetry_names(self) -> tuple[str, ...]:
        """Return the columns of ``telemetry``."""
        return tuple(f"{name}.weight_m" for name in self.basis.names)
