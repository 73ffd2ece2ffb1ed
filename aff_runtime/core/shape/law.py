"""The shape law of one actuator: weights are the roll's shape in metres."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import repeat
from typing import Protocol

import numpy as np
import numpy.typing as npt

from aff_runtime.base.order_columns import RESPONSE_RATIO, STATE
from aff_runtime.base.signals import ActuatorStep
from aff_runtime.core.bandwidth import band_of
from aff_runtime.core.gate import RAMP_S, SpeedGate
from aff_runtime.core.impulse import LoopModel
from aff_runtime.core.law import ActuatorLaw, Inputs
from aff_runtime.core.monitor import OrderState
from aff_runtime.core.order_status import Column, column_names, column_values
from aff_runtime.core.params import ActuatorParams, DriveParams
from aff_runtime.core.phase import RollPhase
from aff_runtime.core.response import Response
from aff_runtime.core.shape.allocation import Headroom, OutputAllocation
from aff_runtime.core.shape.availability import RollAvailability
from aff_runtime.core.shape.basis import ShapeBasis
from aff_runtime.core.shape.bounds import PeakBound
from aff_runtime.core.shape.columns import common
from aff_runtime.core.shape.confidence import ResponseConfidence
from aff_runtime.core.shape.filter import LoopFilter
from aff_runtime.core.shape.kalman import ShapeFilter
from aff_runtime.core.shape.monitor import ShapeMonitor
from aff_runtime.core.shape.newton import NewtonSteps
from aff_runtime.core.shape.profile import ShapeProfile
from aff_runtime.core.shape.sending import Sending
from aff_runtime.core.shape.wish import wish_of

IMBALANCE_DRIFT = 0.1  # process noise of an imbalance over that of a shape
ABSURD = 1e6  # no error and no reference is that large
CHECK_TICKS = 100  # from one check of the filter, and for orders that meet, to the next
GIVES_WAY = 0.95  # share below which the state of an order is CLAMPED: it gives way to the limit
SILENT = ActuatorStep(value=0.0, peak_bound=0.0, slew_bound=0.0)


class Sharing(Protocol):
    """A part that says how much of every column may go out, 0..1, (columns,)."""

    share: npt.NDArray[np.float64]


class ShapeLaw:
    """Learns a shape per roll, and a response ratio per order; sends what cancels it.

    v_ff = Re sum_n W_n b_n with b_n of ``ShapeBasis``; the filter estimates what is left of every
    order, m_n = a_n + (1 + d_n) W_n, and the weight follows by Newton steps,
    W_n <- W_n - rate m_n / (1 + d_n), so an error of the response ratio slows but leaves nothing
    behind. The weights stay when the speed changes. What goes out of a column is its weight times
    shares: of the speed gate, of the roll's presence (its angle is known, it was not changed), of
    the monitor's trust, and times the factor that the limit's headroom leaves; the filter takes in
    what went out, so none of these is mistaken for the roll.
    """

    def __init__(
        self,
        params: ActuatorParams,
        *,
        drive: DriveParams,
        phases: Mapping[str, RollPhase],
        loop: LoopModel,
        cycle_s: float,
        response: Response | None = None,
    ) -> None:
        self._p = params
        self._drive = drive
        self._cycle_s = cycle_s
        self._keys = params.orders
        self._own = phases[drive.roll]
        lead_s = 0.5 * cycle_s + params.transport_s
        used = {name: phases[name] for name in dict.fromkeys(r for r, _ in self._keys)}
        band = band_of(drive.K_ref_rad_s, drive.corner_rad_s, cycle_s)
        self.basis = ShapeBasis(list(self._keys), used, drive, lead_s, band)
        self.state = state = self.basis.state
        count = state.count
        self._roll_of = [r for r, _ in self._keys] + [drive.roll] * (count - len(self._keys))
        self._model = loop
        self._loop = LoopFilter(loop, count)
        self._first, self._imbalance = self.basis.imbalance_pair
        drift = np.ones(count)
        if self._imbalance >= 0:
            drift[self._imbalance] = IMBALANCE_DRIFT
        memory_turns, signal_sd = params.shape.memory_turns, params.shape.signal_sd
        pair = self.basis.imbalance_pair
        self.filter = ShapeFilter(count, memory_turns, signal_sd, drift, pair)
        self.monitor = ShapeMonitor(state, self._roll_of, signal_sd, pair)
        self.availability = RollAvailability(state, self._roll_of, used)
        self.confidence = ResponseConfidence(state, response, self.monitor)
        self._gate = SpeedGate(params.active_above_m_s)
        self.weight = state.array("law.weight_m", dtype=np.complex128, of_roll=True)
        self._sent = state.array("law.sent_m", dtype=np.complex128, of_roll=True)
        self._signal_per_m = state.array("law.signal_per_m")
        self._newton = NewtonSteps(
            self.weight,
            self.filter,
            turn_s=self.basis.turn_s,
            monitor=self.monitor,
            held=None if response is None else self.confidence.held,
            limit_m=params.shape.weight_limit_m,
        )
        self._tension_N = drive.tension_N
        self._ticks = 0
        self._binds = False
        self.adapting = False
        bounds = PeakBound(self.basis.order, self._roll_of, drive.roll)
        own = drive.roll
        self.allocation = OutputAllocation(state, self.basis.order, self._roll_of, own, bounds)
        self._sending = Sending(
            self.basis,
            bounds,
            weight_m=self.weight,
            factor=self.allocation.factor,
            sent_m=self._sent,
            step_1_s=self._newton.step_1_s,
            shares=[part.share for part in self._sharing()],
        )

    def step(self, inputs: Inputs) -> ActuatorStep:
        """Advance by one tick; weights move only on a fresh sample and with permission."""
        dt_s = inputs.dt_s
        if not 0.0 < dt_s < math.inf:
            return SILENT
        self._ticks += 1
        ratio = inputs.applied_ratio if 0.0 <= inputs.applied_ratio <= 1.0 else 0.0
        headroom = Headroom(inputs.limit, inputs.slew_limit)
        self._binds = self.allocation.binds(headroom)
        self._loop.follow_radius(self._own.radius_m)
        self._loop.push(self.basis.b, self._sent, ratio, round(dt_s / self._cycle_s))
        self._settle_availability(dt_s)
        self.confidence.step(self.basis.frequency_Hz, dt_s)
        speed_m_s = self._speed_m_s(inputs.line_speed_m_s)
        gate = self._gate.step(speed_m_s, dt_s)
        self._learn(inputs, gate, dt_s)
        if 0.0 < inputs.reference < ABSURD:
            self._tension_N = inputs.reference
        self.basis.step(speed_m_s, self._tension_N, dt_s)
        if self._binds:
            self._allocate(headroom, dt_s)
        return self._send(gate)

    def _speed_m_s(self, line_speed_m_s: float) -> float:
        if math.isfinite(line_speed_m_s):
            return line_speed_m_s
        speed = self._own.omega_rad_s * self._own.radius_m
        return speed if math.isfinite(speed) else 0.0

    def _settle_availability(self, dt_s: float) -> None:
        gone = self.availability.step(dt_s)
        if gone is not None:
            self._forget(gone)

    def _forget(self, columns: npt.NDArray[np.bool_]) -> None:
        self.state.forget(columns)
        self.filter.forget(columns)
        self._loop.forget(columns)
        self.monitor.judge_at_once()

    def _learn(self, inputs: Inputs, gate: float, dt_s: float) -> None:
        reference = inputs.reference if math.isfinite(inputs.reference) else self._tension_N
        error = inputs.signal - reference
        good = inputs.fresh and abs(error) < ABSURD
        may_learn = inputs.adapt and gate == 1.0 and self.availability.known
        if inputs.fresh or not may_learn:  # a tick without news says nothing about learning
            self.adapting = may_learn and good
        if not (may_learn and good):
            self._newton.stay()
            if inputs.applied_ratio == 0.0 and gate == 1.0 and good and self.availability.known:
                self.monitor.listen(error, self._loop.read()[0], self.basis.turn_s, dt_s)
            return
        phi, psi = self._loop.read()
        turn_s = self.basis.turn_s
        self.filter.update(error, phi, psi, turn_s, dt_s)
        self.monitor.step(error, phi, self.filter, turn_s, dt_s)
        if not self.monitor.calm and self.monitor.dropped.any():
            self._start_anew(self.monitor.dropped)
        if self._ticks % CHECK_TICKS == 0:
            memory = self._p.shape.memory_turns
            self.monitor.compare(self.basis.frequency_Hz, turn_s, memory)
            self.filter.check()
        if self._binds:
            np.abs(phi, out=self._signal_per_m)
        self._newton.step(dt_s)

    def _start_anew(self, columns: npt.NDArray[np.bool_]) -> None:
        """Forget columns that lost their effect, and what was learned of P: it led them astray."""
        self.weight[columns] = 0.0
        self._sent[columns] = 0.0
        self.filter.forget(columns, response=True)

    def _allocate(self, headroom: Headroom, dt_s: float) -> None:
        moving = self.weight, self._newton.step_1_s, self._others()
        wish = wish_of(self.basis, *moving, self._signal_per_m)
        self.allocation.step(headroom, wish, dt_s)

    def _send(self, gate: float) -> ActuatorStep:
        moving = self._gate.moving or self.availability.share_changes or self.confidence.moving
        step = self._sending.step(gate, min(RAMP_S, self.availability.fade_s) if moving else 0.0)
        if not math.isfinite(step.value + step.slew_bound):
            self._restart()
            return SILENT
        if self._binds:
            slew = step.slew_bound + self.allocation.moved_1_s
            step = ActuatorStep(value=step.value, peak_bound=step.peak_bound, slew_bound=slew)
        self.allocation.peak, self.allocation.slew = step.peak_bound, step.slew_bound
        return step

    def _sharing(self) -> tuple[Sharing, ...]:
        return self.availability, self.monitor, self.confidence

    def _others(self) -> npt.NDArray[np.float64]:
        of_angle, of_help, of_response = (part.share for part in self._sharing())
        return np.asarray(of_angle * of_help * of_response)

    def shares(self) -> npt.NDArray[np.float64]:
        """Return how much of every column's ripple may be taken off, 0..1, the gate apart."""
        return np.asarray(self._others() * self.allocation.share)

    def _restart(self) -> None:
        """Start from nothing: a number stopped being one."""
        self._forget(np.ones(self.weight.size, dtype=bool))
        self.filter.restart()
        self.basis.restart()
        self.allocation.restart()

    def reset_roll(self, roll: str) -> None:
        """Let the shape of a changed roll fade, then forget it; its response ratios stay."""
        self.availability.leave(roll)

    def weights(self) -> Mapping[tuple[str, int], complex]:
        """Return the shape by (roll, order), m; an imbalance is not among them."""
        return {key: complex(w) for key, w in zip(self._keys, self.weight, strict=False)}

    def profile(self) -> ShapeProfile:
        """Return what is worth keeping.

        Left out are orders that meet another roll's now, and what fades to be forgotten.
        """
        ratio_less_1 = self.filter.response_ratio_less_1
        left_out = self.monitor.meets | self.availability.leaving
        kept = [i for i in range(len(self._keys)) if not left_out[i]]
        known = self._imbalance >= 0 and not left_out[self._imbalance]
        return ShapeProfile(
            weight_m={self._keys[i]: complex(self.weight[i]) for i in kept},
            response_ratio_less_1={self._keys[i]: complex(ratio_less_1[i]) for i in kept},
            imbalance_m={self._drive.roll: complex(self.weight[self._imbalance])} if known else {},
        )

    def start_from(self, profile: ShapeProfile) -> None:
        """Start with known shapes: a saved profile, or ``start`` of the site file."""
        for i, key in enumerate(self._keys):
            if key in profile.weight_m:
                self.weight[i] = profile.weight_m[key]
                self.filter.expect(i, self.weight[i], profile.response_ratio_less_1.get(key))
        imbalance_m = profile.imbalance_m.get(self._drive.roll)
        if self._imbalance >= 0 and imbalance_m is not None:
            self.weight[self._imbalance] = imbalance_m
            known = profile.response_ratio_less_1.get(self._keys[self._first])
            self.filter.expect(self._imbalance, imbalance_m, known)

    def adopt(self, old: ActuatorLaw) -> None:
        """Go on where ``old`` stands, column by column; orders that it lacks start from zero."""
        if isinstance(old, ShapeLaw):
            self._follow(old)

    def _follow(self, old: ShapeLaw) -> None:
        self._gate.share, self._gate.opened = old._gate.share, old._gate.opened
        self._tension_N = old._tension_N
        if old._drive.roll != self._drive.roll:
            self.start_from(old.profile())
            return
        both = common(self.basis.names, old.basis.names)
        self.basis.adopt(old.basis, both)  # every array per column with it
        self.filter.adopt(old.filter, both)
        self._loop.adopt(old._loop, both)
        self.monitor.adopt(old.monitor)
        self.allocation.adopt(old.allocation)
        self.availability.adopt(old.availability)
        self.confidence.adopt()
        self._change_P(old._model, both.mine)

    def _change_P(self, old: LoopModel, columns: npt.NDArray[np.int_]) -> None:
        """Turn what was learned of P from an old response to the present one; shapes stay."""
        if np.array_equal(old.taps, self._model.taps):
            return
        at = self.basis.frequency_Hz
        radius_m = self._own.radius_m
        for i in columns[self.basis.fade[columns] > 0.0]:
            now = self._model.response(float(at[i]), self._cycle_s, radius_m)
            ratio = old.response(float(at[i]), self._cycle_s, radius_m) / now if now else 1.0
            self.filter.expect(
                int(i), self.weight[i], complex(self.filter.response_ratio[i] * ratio) - 1.0
            )

    def objections(self) -> tuple[str, ...]:
        """Return why this actuator may not arm now.

        An order whose response is not sure is held and does not stand against the others; one
        of the drive's own roll must be sure.
        """
        return self.confidence.objections(self.basis, self._roll_of, self._drive.roll)

    def ripple(self) -> tuple[float, float]:
        """Return the root sum of squares of all orders' amplitudes, without and now.

        An imbalance has the frequency of order 1 and is in it. NaN before two turns are through.
        Without correction counts at least what is there now: what the filter has not yet told from
        noise is no proof that the roll was quiet.
        """
        monitor = self.monitor
        if not monitor.has_two_turns:
            return math.nan, math.nan
        now = monitor.now[: len(self._keys)]
        without = np.fmax(monitor.without[: len(self._keys)], now)
        return float(np.sqrt((without**2).sum())), float(np.sqrt((now**2).sum()))

    def seen(self) -> npt.NDArray[np.complex128]:
        """Return P[b_n] now, (columns,): what a metre of each column does to the signal."""
        return np.asarray(self._loop.read()[0], dtype=np.complex128)

    @property
    def is_open(self) -> bool:
        """Whether the line is fast enough for this law."""
        return self._gate.share == 1.0

    @property
    def signal_sd(self) -> float:
        """How far one reading may be off, in the signal's unit."""
        return self._p.shape.signal_sd

    @property
    def keys(self) -> tuple[tuple[str, int], ...]:
        """(roll, order) of every column that is a shape; they come before an imbalance."""
        return self._keys

    def telemetry(self) -> tuple[float, ...]:
        """Return shape, state, ripple, response ratio and share per column."""
        return column_values(self, COLUMNS)

    def telemetry_names(self) -> tuple[str, ...]:
        """Return seven columns per order; a shape is in millimetres, as a technician reads it."""
        return column_names(self.basis.names, COLUMNS)

    def states(self) -> list[float]:
        """Return the state of every column as the record keeps it."""
        if self._gate.share == 0.0:
            return [float(OrderState.IDLE)] * self.state.count
        learning = self.monitor.states() if self.adapting else repeat(OrderState.FROZEN)
        fade, held = self.basis.fade.tolist(), self.confidence.held.tolist()
        columns = zip(fade, held, self.allocation.share.tolist(), learning, strict=False)
        return [float(_state(*column)) for column in columns]


def _state(fade: float, is_held: bool, share: float, learning: OrderState) -> OrderState:
    """Return the state of an order that goes out: why it may not, else how its learning goes."""
    if fade < 1.0:
        return OrderState.HELD_FREQUENCY
    if is_held:
        return OrderState.HELD_PHASE
    return OrderState.CLAMPED if share < GIVES_WAY else learning


COLUMNS: tuple[Column[ShapeLaw], ...] = (
    Column("shape_mm", lambda law: (1e3 * np.abs(law.weight)).tolist()),
    Column(
        "phase_deg", lambda law: np.degrees(np.arctan2(law.weight.imag, law.weight.real)).tolist()
    ),
    Column(STATE, lambda law: law.states()),
    Column("ripple_before", lambda law: law.monitor.without.tolist()),
    Column("ripple", lambda law: law.monitor.now.tolist()),
    Column(RESPONSE_RATIO, lambda law: np.abs(law.filter.response_ratio).tolist()),
    Column("share", lambda law: law.shares().tolist()),
)
