"""The plain law of one actuator: harmonic blocks in parallel on one error."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping

from aff_runtime.base.order_columns import STATE
from aff_runtime.base.signals import ActuatorStep
from aff_runtime.core.bandwidth import plain_limit_Hz
from aff_runtime.core.blocks.block import HarmonicBlock
from aff_runtime.core.blocks.sharing import gain_share
from aff_runtime.core.blocks.slot import Slot
from aff_runtime.core.gate import ANGLE_FADE_S, RAMP_S, AngleGate, SpeedGate
from aff_runtime.core.law import ActuatorLaw, Inputs
from aff_runtime.core.monitor import OrderState
from aff_runtime.core.order_status import Column, column_names, column_values
from aff_runtime.core.params import ActuatorParams
from aff_runtime.core.phase import Quality, RollPhase
from aff_runtime.core.residual import Residual
from aff_runtime.core.response import MAX_PHASE_ERROR_RAD, Response, arming_objections

FADE_FROM = 0.9
"""Of the highest frequency that goes out (``plain_limit_Hz``): over the last tenth an order fades.

The shape law fades below another frequency, and from 0.895 of it (``core/bandwidth.py``).
"""
MIN_OMEGA_RAD_S = 1e-3  # a roll or order that turns slower stands still
REFRESHED_PER_TICK = 4  # blocks
SLOWER = 0.02  # of a longer time between two readings that one of them makes believed
MAX_ELAPSED_S = 0.1  # the longest time that one sample moves a weight for
STEPS_SHARE = 0.5
"""Of the slew of weights that turn: what their own steps count beside it, at most.

A weight W that is wholly to be learned moves by 2 lam |W| = 8 |W| / settle_s and turns by
omega |W|: half of it where ``settle_s`` is 2.5 turns of the order.
"""
SILENT = ActuatorStep(value=0.0, peak_bound=0.0, slew_bound=0.0)
LOST = Quality.LOST
RATIO_EPS = 1e-9  # a limit ratio this close to 1 is none
BlockKind = Callable[[int, float, float], HarmonicBlock]
"""Order, settling time (s) and limit of amplitude to a block."""


class Bank:
    """Blocks of one actuator, their sum, and the bounds the guard needs.

    A limit in force comes back as ``limit_ratio`` and shortens every weight alike, so a limit
    neither winds up nor clips. P, phase bound and gain share of a few blocks are renewed per tick,
    in turn: frequencies move slowly, and the tick stays short with many blocks.

    Parameters
    ----------
    phases : angles of the rolls. ``response`` : measured; None: nothing adapts.
    block : how each element adapts; it bounds, holds and forgets as ``HarmonicBlock`` does.
    """

    def __init__(
        self,
        params: ActuatorParams,
        *,
        phases: Mapping[str, RollPhase],
        response: Response | None,
        cycle_s: float,
        block: BlockKind = HarmonicBlock,
    ) -> None:
        self._p = params
        self._response = response
        self._lead_s = 0.5 * cycle_s + params.transport_s
        self._cycle_s = cycle_s
        self._omega_max = math.tau * plain_limit_Hz(cycle_s)
        self._residual = Residual(params.mean_tau_s)
        self._gate = SpeedGate(params.active_above_m_s)
        rolls = list(dict.fromkeys(b.roll for b in params.blocks))
        self._rolls = [phases[roll] for roll in rolls]
        self._angles = [AngleGate() for _ in rolls]
        self.slots = [
            Slot(b.roll, rolls.index(b.roll), phases, block(n, b.settle_s, b.amp_limit))
            for b in params.blocks
            for n in b.orders
        ]
        self._omegas = [0.0] * len(self.slots)
        self._rates = [0.0] * len(self.slots)
        self._columns = _columns(params.unit)
        self._next = 0
        self._sent = SILENT
        self._stepping = 0.0  # of the slew bound that was sent: by steps of the weights
        self._interval_s = math.inf  # between two readings, but for the missing ones
        self._adapting = False

    def step(self, inputs: Inputs) -> ActuatorStep:
        """Advance by one tick; weights move only on a fresh sample and with permission."""
        if 0.0 < inputs.limit_ratio < 1.0 - RATIO_EPS:
            self._shorten(inputs)
        error = self._residual.step(
            signal=inputs.signal, reference=inputs.reference, dt_s=inputs.dt_s, fresh=inputs.fresh
        )
        gate = self._gate.step(self._speed_m_s(inputs.line_speed_m_s), inputs.dt_s)
        self._see_angles(inputs.dt_s)
        self._turn()
        self._refresh()
        may_learn = inputs.adapt and gate == 1.0
        if inputs.fresh or not may_learn:  # a tick without news says nothing about learning
            self._adapting = may_learn and math.isfinite(error)
        if math.isfinite(error):
            self._learn(error, gate > 0.0 and inputs.applied_ratio > 0.01)
        return self._sum(gate)

    def _shorten(self, inputs: Inputs) -> None:
        """Shorten every weight to what fits under the limits, as ``safety.limits`` scales.

        What a spike in the signal lets the weights' own steps take of the slew counts in part
        alone: it is over with its tick, and the guard bounds that one.
        """
        ratio, peak = inputs.limit_ratio, self._sent.peak_bound
        turning = self._sent.slew_bound - self._stepping
        if self._stepping > STEPS_SHARE * turning and inputs.slew_limit < math.inf:
            fits = inputs.limit / peak if peak > inputs.limit else 1.0
            slew = (1.0 + STEPS_SHARE) * turning
            if slew * fits > inputs.slew_limit:
                fits = inputs.slew_limit / slew
            ratio = max(ratio, fits)
        for slot in self.slots:
            slot.block.scale_weights(ratio)

    def _speed_m_s(self, line_speed_m_s: float) -> float:
        """Return the line speed, or that of the fastest roll's surface when it is not known."""
        if math.isfinite(line_speed_m_s):
            return line_speed_m_s
        fastest = 0.0
        for slot in self.slots:
            fastest = max(fastest, abs(slot.phase.omega_rad_s * slot.phase.radius_m))
        return fastest

    def _see_angles(self, dt_s: float) -> None:
        """Fade what goes out of every roll whose angle is lost, or has come back."""
        for at, (phase, angle) in enumerate(zip(self._rolls, self._angles, strict=True)):
            known = phase.quality is not LOST
            if known and angle.share == 1.0:
                angle.moving = False
                continue
            sends = any(slot.at == at and slot.block.weight != 0j for slot in self.slots)
            angle.step(known, sends, dt_s)

    def _turn(self) -> None:
        """Set carrier, scale, frequency and fade of every block by the angles of the rolls."""
        scaled, limit = self._p.scales_with_speed, self._omega_max
        fades_from = FADE_FROM * limit
        rolls = [(phase.lead(self._lead_s), phase.omega_rad_s) for phase in self._rolls]
        slowest = math.inf
        for i, slot in enumerate(self.slots):
            theta, turning = rolls[slot.at]
            block = slot.block
            block.turn(theta)
            slot.scale = turning if scaled else 1.0
            omega = self._omegas[i] = block.order * turning
            size = abs(omega)
            if size <= fades_from:
                slot.fade = 1.0
            else:
                slot.fade = min(1.0, max(0.0, (limit - size) / ((1.0 - FADE_FROM) * limit)))
            if MIN_OMEGA_RAD_S <= size < slowest:
                slowest = size
        self._residual.follow(slowest if slowest < math.inf else 0.0)

    def _refresh(self) -> None:
        """Renew what depends on frequency, a few blocks per tick."""
        count = len(self.slots)
        for _ in range(min(count, REFRESHED_PER_TICK)):
            i = self._next
            self._next = (i + 1) % count
            slot = self.slots[i]
            omega = self._omegas[i]
            if self._response is None or abs(omega) < MIN_OMEGA_RAD_S:
                slot.bound_rad = math.pi
                slot.share = 0.0
                continue
            frequency_Hz = omega / math.tau
            passed = self._residual.response(frequency_Hz)
            slot.passed = abs(passed)
            slot.response = self._response.at(frequency_Hz) * passed
            slot.bound_rad = self._response.phase_error_bound_rad(frequency_Hz)
            slot.rate_1_s = slot.block.adaptation_rate(self._response.memory_s(frequency_Hz))
            self._rates[i] = slot.rate_1_s
            slot.share = gain_share(i, self._omegas, self._rates)

    def _learn(self, error: float, correcting: bool) -> None:
        """Take one sample: into every monitor, and into the weights that may move."""
        elapsed_s, adapting = self._residual.elapsed_s, self._adapting
        if elapsed_s < self._interval_s:
            self._interval_s = elapsed_s
        else:
            self._interval_s += SLOWER * (elapsed_s - self._interval_s)
        dt_s = min(elapsed_s, MAX_ELAPSED_S)
        sure = [
            angle.share == 1.0 and abs(phase.omega_rad_s) >= MIN_OMEGA_RAD_S
            for phase, angle in zip(self._rolls, self._angles, strict=True)
        ]
        for slot in self.slots:
            block = slot.block
            slot.monitor.step(
                error=error / slot.passed,
                carrier=block.carrier,
                omega_rad_s=slot.phase.omega_rad_s,
                dt_s=elapsed_s,
                correcting=correcting,
            )
            known = slot.bound_rad <= MAX_PHASE_ERROR_RAD and slot.fade == 1.0
            if adapting and known and sure[slot.at]:
                block.adapt(
                    error=error,
                    response=slot.response,
                    scale=slot.scale,
                    rate_1_s=slot.rate_1_s * slot.share,
                    dt_s=dt_s,
                )
            else:
                block.hold()

    def _sum(self, gate: float) -> ActuatorStep:
        value = peak = slew = stepping = 0.0
        for slot, omega in zip(self.slots, self._omegas, strict=True):
            block, scale, angle = slot.block, slot.scale, self._angles[slot.at]
            whole = slot.fade * block.limit(scale)
            amplitude = angle.share * whole
            value += angle.share * slot.fade * block.output(scale)
            peak += amplitude
            step = block.weight_speed * abs(scale)
            stepping += step
            slew += abs(omega) * amplitude + step
            if angle.moving:
                slew += whole / ANGLE_FADE_S
        if self._gate.moving:
            slew = gate * slew + peak / RAMP_S
            stepping *= gate
        if not math.isfinite(value + slew):
            self._sent, self._stepping = SILENT, 0.0
            return SILENT
        self._stepping = stepping
        self._sent = ActuatorStep(value=gate * value, peak_bound=gate * peak, slew_bound=slew)
        return self._sent

    def reset_roll(self, roll: str) -> None:
        """Forget the blocks of a roll that was changed."""
        for slot in self.slots:
            if slot.roll == roll:
                slot.block.reset()
                slot.monitor.reset()

    def weights(self) -> Mapping[tuple[str, int], complex]:
        """Return the complex weights by (roll, order), m when scaled with speed."""
        return {(slot.roll, slot.block.order): slot.block.weight for slot in self.slots}

    def adopt(self, old: ActuatorLaw) -> None:
        """Take over weights, ripple, mean and gate; orders that ``old`` lacks start from zero."""
        if isinstance(old, Bank):
            self._follow(old)

    def _follow(self, old: Bank) -> None:
        if old._p.scales_with_speed != self._p.scales_with_speed:
            return
        learned = {(slot.roll, slot.block.order): slot for slot in old.slots}
        shares = {slot.roll: old._angles[slot.at].share for slot in old.slots}
        for slot in self.slots:
            before = learned.get((slot.roll, slot.block.order))
            if before is not None:
                self._angles[slot.at].share = shares[slot.roll]
                slot.block.weight = before.block.weight
                slot.monitor = before.monitor
        if (old._p.signal, old._p.reference) == (self._p.signal, self._p.reference):
            self._residual = old._residual
        self._gate.share = old._gate.share
        self._gate.opened = old._gate.opened

    def objections(self) -> tuple[str, ...]:
        """Return why this actuator may not arm at the present speed.

        Before the first probe of a drive that law shape waits for, no order is too fast: that law
        has another limit, and the probe is what is lacking.
        """
        wanted = [(slot.name, slot.omega_rad_s / math.tau) for slot in self.slots]
        sentences: list[str] = []
        if self._response is not None or not self._p.stands_in:
            sentences += self._too_fast()
            wanted = [one for one in wanted if not self._is_too_fast(one[1])]  # said already
        sentences += arming_objections(self._response, wanted)
        for slot in self.slots:
            if abs(slot.omega_rad_s) * self._interval_s > slot.block.widest_rad:
                sentences.append(
                    f"{slot.name}: {abs(slot.omega_rad_s) / math.tau:.2f} Hz is too fast to be "
                    f"learned from a reading every {1e3 * self._interval_s:.0f} ms"
                )
        phases = {slot.roll: slot.phase for slot in self.slots}
        for roll, phase in phases.items():
            if phase.quality is LOST and phase.omega_rad_s != 0.0:
                sentences.append(f"{roll}: its angle is lost")
        return tuple(sentences)

    def _is_too_fast(self, frequency_Hz: float) -> bool:
        return abs(frequency_Hz) > self._omega_max / math.tau

    def _too_fast(self) -> Iterator[str]:
        """Yield per roll the orders above what goes out, the slowest's Hz, and what to do."""
        limit_Hz, cycle_ms = self._omega_max / math.tau, 1e3 * self._cycle_s
        or_else = "shorten cycle_ms, run slower or take out that order"
        for roll in dict.fromkeys(slot.roll for slot in self.slots):
            fast = sorted(
                (abs(slot.omega_rad_s) / math.tau, slot.name)
                for slot in self.slots
                if slot.roll == roll and self._is_too_fast(slot.omega_rad_s / math.tau)
            )
            if not fast:
                continue
            names = " .. ".join(dict.fromkeys(name for _, name in (fast[0], fast[-1])))
            f = fast[0][0]
            if self._p.stands_in:
                yield (
                    f"{names}: {f:.2f} Hz is above the {limit_Hz:.4g} Hz of the plain law, "
                    f"which stands in, at a cycle of {cycle_ms:g} ms; identify the drive by a "
                    f"probe or declare it, else {or_else}"
                )
            else:
                yield (
                    f"{names}: {f:.2f} Hz is above the {limit_Hz:.4g} Hz of the plain law at a "
                    f"cycle of {cycle_ms:g} ms; {or_else}"
                )

    def ripple(self) -> tuple[float, float]:
        """Return the root sum of squares of all orders' amplitudes, before and now."""
        before = now = 0.0
        for slot in self.slots:
            before += slot.monitor.before**2
            now += slot.monitor.now**2
        return math.sqrt(before), math.sqrt(now)

    def telemetry(self) -> tuple[float, ...]:
        """Return amplitude, phase, state and ripple per block."""
        return column_values(self, self._columns)

    def telemetry_names(self) -> tuple[str, ...]:
        """Return five columns per block."""
        return column_names([slot.name for slot in self.slots], self._columns)

    def state_of(self, slot: Slot) -> OrderState:
        """Return the state of a block, for the record."""
        if self._gate.share == 0.0:
            return OrderState.IDLE
        if slot.fade < 1.0:
            return OrderState.HELD_FREQUENCY
        if slot.bound_rad > MAX_PHASE_ERROR_RAD:
            return OrderState.HELD_PHASE
        if slot.block.clamped:
            return OrderState.CLAMPED
        if self._angles[slot.at].share < 1.0:
            return OrderState.FROZEN
        return slot.monitor.state() if self._adapting else OrderState.FROZEN


def _columns(unit: str) -> tuple[Column[Bank], ...]:
    """Return the columns of a bank whose output has this unit (m_s or N_m)."""
    return (
        Column(f"amplitude_{unit}", lambda b: [s.block.amplitude(s.scale) for s in b.slots]),
        Column("phase_deg", lambda b: [s.phase_deg for s in b.slots]),
        Column(STATE, lambda b: [float(b.state_of(s)) for s in b.slots]),
        Column("ripple_before", lambda b: [s.monitor.before for s in b.slots]),
        Column("ripple", lambda b: [s.monitor.now for s in b.slots]),
    )
