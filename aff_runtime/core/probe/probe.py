"""Measures P while the line runs: a law that plays tones, listens, and fits them at the end."""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np
import numpy.typing as npt

from aff_runtime.base.channel_units import unit_of_channel
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.probe_columns import EXCITING, PROGRESS, STAGE
from aff_runtime.base.signals import ActuatorStep, Permission, Snapshot
from aff_runtime.core.controller import RollPhases
from aff_runtime.core.params import ProbeParams, SiteParams
from aff_runtime.core.phase import Quality, Source
from aff_runtime.core.probe.bounds import Bounds
from aff_runtime.core.probe.choosing import Choosing
from aff_runtime.core.probe.drive_record import DriveRecord
from aff_runtime.core.probe.estimate import Tone, fit_delay, fit_tones, measured_sign
from aff_runtime.core.probe.excitation import PERIOD_S, ROUNDS, Waveform, step_Hz
from aff_runtime.core.probe.planning import TonePlan
from aff_runtime.core.probe.repeats import repeat_sigmas, same_operating_point
from aff_runtime.core.probe.scan_clock import scan_time_s
from aff_runtime.core.probe.strange_ripple import RippleLine
from aff_runtime.core.response import Provenance, Response

MIN_RATIO = 0.5
RATIO_SPREAD = 0.02
MIN_GOOD_SHARE = 0.7
"""Of a PLC as fast as the cycle that is read at the edge of its scans three of four reads are new;
of one that is half as fast, one of two."""
WITHDRAWN_S = 0.5
"""How long the tones of a probe that ends in the middle take to zero."""
ZERO = ActuatorStep(value=0.0, peak_bound=0.0, slew_bound=0.0)


class Stage(IntEnum):
    """Where the probe stands."""

    LISTENING = 0
    PREPARING = 1
    EXCITING = EXCITING
    DONE = 3
    ABORTED = 4
    RISING = 5
    WITHDRAWING = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class ProbeResult:
    """What the probe found for one actuator.

    ``sign`` of P at low frequency (0: undecided); ``remarks`` are reasons to distrust the
    response, empty when there is none.
    """

    actuator: str
    response: Response
    sign: int
    remarks: tuple[str, ...]


class Probe:
    """Implements ``base.ports.Law``: silent, then tones, then silent.

    While it is silent it learns how signals and speed are. Where the amplitude is to be chosen it
    takes the noise from there, and ``Choosing`` says how loud; where no response is known that
    takes steps. What leaves its bound under the tones ends the probe, and they fade to zero.

    The clock of the probe runs only while the guard permits adaptation (the loop is active); a
    permission lost during the tones aborts. ``result`` may be called, outside the control cycle,
    when ``stage`` is DONE.

    Parameters
    ----------
    former : the response of actuators that have been probed before.
    """

    def __init__(
        self, site: SiteParams, params: ProbeParams, former: Mapping[str, Response] | None = None
    ) -> None:
        self._site = site
        self._p = params
        self._phases = RollPhases(site)
        index = {name: i for i, name in enumerate(site.channels)}
        self._probed = [a for a in site.actuators if a.name in params.actuators]
        self._positions = [site.actuators.index(a) for a in self._probed]
        self._signals = [index[a.signal] for a in self._probed]
        self._samples = round(params.duration_s / site.cycle_s)
        waves = len(self._probed)
        step = step_Hz(site.cycle_s, max(1, waves))
        self._plan = TonePlan(site, params, self._probed, self._phases.by_name, step)
        self._waves = [Waveform(self._samples, site.cycle_s, waves) for _ in self._probed]
        self._record = [_column(self._samples) for _ in self._probed]
        self._ratio = [_column(self._samples) for _ in self._probed]
        self._theta = [_column(self._samples) for _ in site.rolls]
        self._counted = [True] * len(site.rolls)  # by an encoder, all along
        self._heartbeat = _column(self._samples)
        self._drives = [
            DriveRecord(site, actuator, self._phases.by_name, self._samples)
            for actuator in self._probed
        ]
        self._line_speed = index.get(site.line_speed or "", -1)
        self._former = former or {}
        are_N = [unit_of_channel(a.signal) == "N" for a in self._probed]
        self.bounds = Bounds(
            [a.signal for a in self._probed],
            [params.bound_N if is_N else math.inf for is_N in are_N],
            [params.bound_share if is_N else math.inf for is_N in are_N],
            site.cycle_s,
        )
        self._choosing: Choosing | None = None
        if params.is_chosen and self._probed:
            self._choosing = Choosing(site, params, self._probed, self._waves, self._former)
        is_bounded = math.isfinite(params.bound_N) or math.isfinite(params.bound_share)
        # long enough for a roll to show all of its own ripple
        self._quiet_s = max(params.listen_s, PERIOD_S) if is_bounded else params.listen_s
        self._levels = [params.amplitude] * waves
        self._withdrawn_s = 0.0
        self._sample = -1
        self._heard_s = 0.0
        self._filling = 0
        self.stage = Stage.LISTENING
        self.reason = ""
        self.waiting = ""

    def step(
        self, snapshot: Snapshot, dt_s: float, permission: Permission
    ) -> tuple[ActuatorStep, ...]:
        """Advance by ``dt_s``; see ``base.ports.Law``."""
        new_roll = self._phases.step(snapshot, dt_s)
        if self.stage is Stage.LISTENING:
            self._listen(snapshot, dt_s, permission.adapt)
        elif self.stage is Stage.PREPARING:
            self._prepare()
        elif self.stage in (Stage.RISING, Stage.EXCITING, Stage.WITHDRAWING):
            if new_roll or not permission.adapt:
                self.stage = Stage.ABORTED
                withdrawn = "new roll" if new_roll else "the guard withdrew its permission"
                self.reason = self.reason or withdrawn
                return (ZERO,) * len(self._site.actuators)
            return self._sending(snapshot, dt_s, permission)
        return (ZERO,) * len(self._site.actuators)

    def _sending(
        self, snapshot: Snapshot, dt_s: float, permission: Permission
    ) -> tuple[ActuatorStep, ...]:
        """Send tones while the line stays within its bounds; else fade them to zero."""
        why = self.bounds.look(*self._seen(snapshot)) if snapshot.fresh else ""
        if why and self.stage is not Stage.WITHDRAWING:
            self.reason, self.stage = why, Stage.WITHDRAWING
            if self._choosing is not None:
                self._choosing.hold()
        withdrawing = self.stage is Stage.WITHDRAWING
        choosing = self._choosing
        if choosing is not None and choosing.is_at_work:
            steps = self._rise(choosing, snapshot, dt_s)
        else:
            steps = self._excite(snapshot, dt_s, permission)
        if not withdrawing or self.stage is not Stage.WITHDRAWING:
            return steps
        self._withdrawn_s += dt_s
        left = 1.0 - self._withdrawn_s / WITHDRAWN_S
        if left <= 0.0:
            self.stage = Stage.ABORTED
            return (ZERO,) * len(self._site.actuators)
        return tuple(
            ActuatorStep(
                value=left * one.value,
                peak_bound=one.peak_bound,
                slew_bound=one.slew_bound + one.peak_bound / WITHDRAWN_S,
            )
            for one in steps
        )

    def _seen(self, snapshot: Snapshot) -> tuple[list[float], float]:
        """Return the signals and the line speed of a snapshot, NaN where it has none."""
        speed = snapshot.values[self._line_speed] if self._line_speed >= 0 else math.nan
        return [snapshot.values[at] for at in self._signals], speed

    def _heard(self, snapshot: Snapshot) -> list[float]:
        """Return the signals of a snapshot; of one that is not new, NaN."""
        return self._seen(snapshot)[0] if snapshot.fresh else [math.nan] * len(self._signals)

    def _rise(
        self, choosing: Choosing, snapshot: Snapshot, dt_s: float
    ) -> tuple[ActuatorStep, ...]:
        """Send what the choice of the amplitude wants, and go on when it is made."""
        sent = choosing.sound(self._ticks(dt_s), self._heard(snapshot), self._angles())
        steps = [ZERO] * len(self._site.actuators)
        for i, one in zip(self._positions, sent, strict=True):
            steps[i] = one
        if choosing.has_ended and self.stage is Stage.RISING:
            self._take_choice(choosing)
        return tuple(steps)

    def _take_choice(self, choosing: Choosing) -> None:
        self._levels, self.reason = list(choosing.levels), choosing.reason
        self.stage = Stage.ABORTED if self.reason else Stage.EXCITING

    def _ticks(self, dt_s: float) -> int:
        return max(1, round(dt_s / self._site.cycle_s))

    def _angles(self) -> list[float]:
        return [phase.theta_rad for phase in self._phases.by_name.values()]

    def _listen(self, snapshot: Snapshot, dt_s: float, permitted: bool) -> None:
        """Count up good ticks; one predicted over counts nothing, a lost angle starts anew.

        Where the bus beats with the PLC's scan every tenth tick brings no new angle.
        """
        worst = min((p.quality for p in self._phases.by_name.values()), default=Quality.GOOD)
        why = self.bounds.listen(*self._seen(snapshot)) if snapshot.fresh else ""
        if worst is Quality.LOST or not permitted or why:
            self._heard_s = 0.0
            self.waiting = why or self.waiting
            self.bounds.begin()
            if self._choosing is not None:
                self._choosing.window.begin()
        elif worst is Quality.GOOD:
            self._heard_s += dt_s
        if self._choosing is not None and self._heard_s > 0.0:
            self._choosing.window.pass_on(self._ticks(dt_s), self._heard(snapshot), self._angles())
            if not self._choosing.window.is_full:
                return
        if self._heard_s >= self._quiet_s:
            for wave, tones in zip(self._waves, self._plan.tones_Hz(), strict=True):
                wave.plan(tones, self._p.fade_s, self._p.louder_from_Hz)
            self.stage = Stage.PREPARING

    def _prepare(self) -> None:
        if self._filling >= len(self._waves):
            if self._choosing is None:
                self.stage = Stage.EXCITING
            elif self._choosing.weigh_quiet(
                [self.bounds.most(j) for j in range(len(self._probed))], self._plan.lowest_Hz()
            ):
                if self._choosing.reason or self._choosing.is_known(self.bounds.speed_m_s):
                    self._take_choice(self._choosing)
                else:
                    self._choosing.begin_steps()
                    self.stage = Stage.RISING
        elif self._waves[self._filling].fill():
            self._filling += 1

    def _excite(
        self, snapshot: Snapshot, dt_s: float, permission: Permission
    ) -> tuple[ActuatorStep, ...]:
        """Write down what this tick saw beside the index of the sample it sends."""
        self._sample += self._ticks(dt_s) if self._sample >= 0 else 1
        k = self._sample
        steps = [ZERO] * len(self._site.actuators)
        if k >= self._samples:
            self.stage = Stage.DONE
            return tuple(steps)
        for i, phase in enumerate(self._phases.by_name.values()):
            self._theta[i][k] = phase.theta_rad
            self._counted[i] &= phase.source is Source.ENCODER
        self._heartbeat[k] = snapshot.plc_heartbeat
        for j, wave in enumerate(self._waves):
            i = self._positions[j]
            self._ratio[j][k] = permission.applied_ratio[i]
            if snapshot.fresh:
                self._record[j][k] = snapshot.values[self._signals[j]]
                self._drives[j].take(k, snapshot.values)
            level = self._levels[j]
            steps[i] = ActuatorStep(
                value=wave.sample(k, level), peak_bound=level, slew_bound=wave.slew(level)
            )
        return tuple(steps)

    @property
    def expected_s(self) -> float:
        """How long it takes where nothing disturbs it: silent, a wave a round each tick, tones."""
        preparing_s = len(self._waves) * (ROUNDS + 1) * self._site.cycle_s
        if self._choosing is None:
            return self._quiet_s + preparing_s + self._p.duration_s
        return self._choosing.at_most_s + preparing_s + self._p.duration_s

    def result(self, provenance: Mapping[str, Provenance]) -> tuple[ProbeResult, ...]:
        """Fit the record; outside the control cycle.

        Raises
        ------
        RefusedError
            When the probe did not finish, or too little of its record is usable.
        """
        if self.stage is not Stage.DONE:
            raise RefusedError(f"the probe did not finish: {self.reason or self.stage.name}")
        return tuple(self._fit(j, provenance[a.name]) for j, a in enumerate(self._probed))

    def _fit(self, j: int, provenance: Provenance) -> ProbeResult:
        name = self._probed[j].name
        time_s = np.arange(self._samples, dtype=np.float64) * self._site.cycle_s
        signal = np.asarray(self._record[j])
        angles = [np.asarray(column) for column in self._theta]
        keep = time_s >= self._p.fade_s + self._p.settle_s
        keep &= time_s <= self._p.duration_s - self._p.fade_s
        planned = int(keep.sum())
        keep &= np.isfinite(signal)
        for angle in angles:
            keep &= np.isfinite(angle)
        if keep.sum() < MIN_GOOD_SHARE * planned:
            used = keep.sum() / max(planned, 1)
            raise RefusedError(
                f"{name}: {used:.0%} of readings can be used, {MIN_GOOD_SHARE:.0%} are needed. "
                f"Does the PLC scan more slowly than every {1e3 * self._site.cycle_s:g} ms "
                "(cycle_ms)? Else the wire loses them; probe again"
            )
        tones = [self._sent(i, keep) for i in range(len(self._probed))]
        foreign = [tone for i, group in enumerate(tones) if i != j for tone in group]
        columns = 2 * (len(tones[j]) + len(foreign))
        columns += 4 * self._p.nuisance_orders * len(angles) + 3
        if keep.sum() < 2 * columns or not tones[j]:
            raise RefusedError(f"{name}: no tones, or too many for this duration")
        counted = [a[keep] for a, is_so in zip(angles, self._counted, strict=True) if is_so]
        time_s[keep] = scan_time_s(time_s[keep], np.asarray(self._heartbeat)[keep], counted)
        fit = fit_tones(
            time_s=time_s[keep],
            signal=signal[keep],
            angles_rad=[angle[keep] for angle in angles],
            nuisance_orders=self._p.nuisance_orders,
            own=tones[j],
            foreign=foreign,
        )
        points = fit.points
        delay_s = fit_delay(points)
        ratio = np.asarray(self._ratio[j])[keep]
        drive, no_drive = self._drives[j].identified(
            time_s=time_s, keep=keep, signal=signal, fit=fit, sent=tones[j]
        )
        former = self._former.get(name)
        again = former is not None and same_operating_point(former.provenance, provenance)
        response = Response(points=points, delay_s=delay_s, provenance=provenance, drive=drive)
        apart = repeat_sigmas(former, response) if former is not None and again else math.nan
        about = replace(
            provenance,
            amplitude=self._levels[j],
            amplitude_needed=self._choosing.needed_of(j) if self._choosing else math.nan,
            repeat_sigmas=apart,
        )
        chosen = self._choosing.remarks[j] if self._choosing is not None else ()
        limited = float(np.ptp(ratio)) > RATIO_SPREAD
        return ProbeResult(
            actuator=name,
            response=Response(
                points=points, delay_s=delay_s, provenance=about, drive=drive, no_drive=no_drive
            ),
            sign=measured_sign(points, delay_s),
            remarks=(*_remarks(limited, fit.strange), *chosen),
        )

    def _sent(self, j: int, keep: npt.NDArray[np.bool_]) -> list[Tone]:
        """Return the tones as they went out, the guard's share included."""
        share = float(np.nanmean(np.asarray(self._ratio[j])[keep]))
        if not share >= MIN_RATIO:
            raise RefusedError(f"{self._probed[j].name}: the excitation did not go out")
        amplitude = self._waves[j].amplitude(self._levels[j]) * share
        return [
            Tone(omega_rad_s=omega, phase_rad=phase, amplitude=amplitude * size)
            for omega, phase, size in self._waves[j].tones
        ]

    def telemetry(self) -> tuple[float, ...]:
        """Return stage and progress."""
        return float(self.stage), min(1.0, max(0.0, self._sample / self._samples))

    def telemetry_names(self) -> tuple[str, ...]:
        """Return the columns of ``telemetry``."""
        return STAGE, PROGRESS


def _remarks(limited: bool, strange: Sequence[RippleLine]) -> Iterator[str]:
    """Yield what a technician should know of a probe before he trusts it."""
    if limited:
        yield "a limit changed the excitation while it was measured"
    if strange:
        largest = max(strange, key=lambda line: line.amplitude)
        yield (
            f"ripple near {largest.frequency_Hz:.1f} Hz belongs to no roll of the site file; "
            "declare that roll and probe again to know the response there"
        )


def _column(samples: int) -> array[float]:
    return array("d", [math.nan]) * samples
