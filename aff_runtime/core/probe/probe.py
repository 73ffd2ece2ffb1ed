"""Measures P while the line runs: a law that plays tones, listens, and fits them at the end."""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import numpy.typing as npt

from aff_runtime.base.errors import RefusedError
from aff_runtime.base.probe_columns import EXCITING, PROGRESS, STAGE
from aff_runtime.base.signals import ActuatorStep, Permission, Snapshot
from aff_runtime.core.controller import RollPhases
from aff_runtime.core.params import ActuatorParams, ProbeParams, RollParams, SiteParams
from aff_runtime.core.phase import Quality
from aff_runtime.core.probe.drive_record import DriveRecord
from aff_runtime.core.probe.estimate import Tone, fit_delay, fit_tones, measured_sign
from aff_runtime.core.probe.excitation import ROUNDS, Waveform, log_grid, place_tones, step_Hz
from aff_runtime.core.probe.strange_ripple import RippleLine
from aff_runtime.core.response import Provenance, Response

BINS_APART = 1.5
LOW_SHARE = 0.6
LOW_PERIODS = 3.0  # of the lowest tone in what is measured
MIN_RATIO = 0.5
RATIO_SPREAD = 0.02
MIN_GOOD_SHARE = 0.8
ZERO = ActuatorStep(value=0.0, peak_bound=0.0, slew_bound=0.0)


class Stage(IntEnum):
    """Where the probe stands."""

    LISTENING = 0
    PREPARING = 1
    EXCITING = EXCITING
    DONE = 3
    ABORTED = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class ProbeResult:
    """What the probe found for one actuator.

    ``sign`` of P at low frequency (0: undecided); ``remarks`` are reasons to distrust the
    response, empty when there is none; ``no_drive`` says why the response holds no numbers of the
    drive.
    """

    actuator: str
    response: Response
    sign: int
    remarks: tuple[str, ...]
    no_drive: str = ""


class Probe:
    """Implements ``base.ports.Law``: silent, then tones, then silent.

    The clock of the probe runs only while the guard permits adaptation (the loop is active); a
    permission lost during the tones aborts. ``result`` may be called, outside the control cycle,
    when ``stage`` is DONE.
    """

    def __init__(self, site: SiteParams, params: ProbeParams) -> None:
        self._site = site
        self._p = params
        self._phases = RollPhases(site)
        index = {name: i for i, name in enumerate(site.channels)}
        self._probed = [a for a in site.actuators if a.name in params.actuators]
        self._positions = [site.actuators.index(a) for a in self._probed]
        self._signals = [index[a.signal] for a in self._probed]
        self._samples = round(params.duration_s / site.cycle_s)
        waves = len(self._probed)
        self._step_Hz = step_Hz(site.cycle_s, max(1, waves))
        self._waves = [Waveform(self._samples, site.cycle_s, waves) for _ in self._probed]
        self._record = [_column(self._samples) for _ in self._probed]
        self._ratio = [_column(self._samples) for _ in self._probed]
        self._theta = [_column(self._samples) for _ in site.rolls]
        self._drives = [
            DriveRecord(site, actuator, self._phases.by_name, self._samples)
            for actuator in self._probed
        ]
        self._sample = -1
        self._heard_s = 0.0
        self._filling = 0
        self.stage = Stage.LISTENING
        self.reason = ""

    def step(
        self, snapshot: Snapshot, dt_s: float, permission: Permission
    ) -> tuple[ActuatorStep, ...]:
        """Advance by ``dt_s``; see ``base.ports.Law``."""
        new_roll = self._phases.step(snapshot, dt_s)
        if self.stage is Stage.LISTENING:
            self._listen(dt_s, permission.adapt)
        elif self.stage is Stage.PREPARING:
            self._prepare()
        elif self.stage is Stage.EXCITING:
            if new_roll or not permission.adapt:
                self.stage = Stage.ABORTED
                self.reason = "new roll" if new_roll else "the guard withdrew its permission"
            else:
                return self._excite(snapshot, dt_s, permission)
        return (ZERO,) * len(self._site.actuators)

    def _listen(self, dt_s: float, permitted: bool) -> None:
        """Count up good ticks; one predicted over counts nothing, a lost angle starts anew.

        Where the bus beats with the PLC's scan every tenth tick brings no new angle.
        """
        worst = min((p.quality for p in self._phases.by_name.values()), default=Quality.GOOD)
        if worst is Quality.LOST or not permitted:
            self._heard_s = 0.0
        elif worst is Quality.GOOD:
            self._heard_s += dt_s
        if self._heard_s >= self._p.listen_s:
            for wave, tones in zip(self._waves, self._plan_tones_Hz(), strict=True):
                wave.plan(tones, self._p.fade_s, self._p.louder_from_Hz)
            self.stage = Stage.PREPARING

    def _prepare(self) -> None:
        if self._filling >= len(self._waves):
            self.stage = Stage.EXCITING
        elif self._waves[self._filling].fill():
            self._filling += 1

    def _excite(
        self, snapshot: Snapshot, dt_s: float, permission: Permission
    ) -> tuple[ActuatorStep, ...]:
        """Write down what this tick saw beside the index of the sample it sends."""
        self._sample += max(1, round(dt_s / self._site.cycle_s)) if self._sample >= 0 else 1
        k = self._sample
        steps = [ZERO] * len(self._site.actuators)
        if k >= self._samples:
            self.stage = Stage.DONE
            return tuple(steps)
        for column, phase in zip(self._theta, self._phases.by_name.values(), strict=True):
            column[k] = phase.theta_rad
        for j, wave in enumerate(self._waves):
            i = self._positions[j]
            self._ratio[j][k] = permission.applied_ratio[i]
            if snapshot.fresh:
                self._record[j][k] = snapshot.values[self._signals[j]]
                self._drives[j].take(k, snapshot.values)
            steps[i] = ActuatorStep(
                value=wave.sample(k, self._p.amplitude),
                peak_bound=self._p.amplitude,
                slew_bound=wave.slew(self._p.amplitude),
            )
        return tuple(steps)

    @property
    def expected_s(self) -> float:
        """How long it takes where nothing disturbs it: silent, a wave a round each tick, tones."""
        preparing_s = len(self._waves) * (ROUNDS + 1) * self._site.cycle_s
        return self._p.listen_s + preparing_s + self._p.duration_s

    def _plan_tones_Hz(self) -> list[list[float]]:
        """Return tones per actuator, clear of all ripple and of each other.

        The tones beside the orders of every actuator find their places first: these are what its
        blocks live on. The grids for other speeds and radii share what room is left; who wants
        the fewest tones chooses first.
        """
        p = self._p
        spacing_Hz = BINS_APART / self._measured_s
        rolls = self._phases.by_name
        turns_Hz = {name: abs(phase.omega_rad_s) / math.tau for name, phase in rolls.items()}
        taken = [n * f for f in turns_Hz.values() for n in range(1, p.nuisance_orders + 1)]
        plan: list[list[float]] = [[] for _ in self._probed]
        for wanted_of in (self._beside_orders_Hz, self._grid_Hz):
            wanted = [
                wanted_of(actuator, [n * turns_Hz[roll] for roll, n in actuator.orders])
                for actuator in self._probed
            ]
            for j in sorted(range(len(plan)), key=lambda j: len(wanted[j])):
                placed = place_tones(wanted[j], taken, spacing_Hz, self._step_Hz)
                taken += placed
                plan[j] += placed
        return plan

    def _beside_orders_Hz(self, _: ActuatorParams, now_Hz: list[float]) -> list[float]:
        """Return one tone beside every order, and the extra ones the site asks for."""
        offset_Hz, highest_Hz = self._p.offset_Hz, self._p.f_max_Hz
        beside = [f + offset_Hz for f in now_Hz if f + offset_Hz <= highest_Hz]
        return [*beside, *self._p.extra_frequencies_Hz]

    def _grid_Hz(self, actuator: ActuatorParams, now_Hz: list[float]) -> list[float]:
        """Return a log grid from below the lowest order to the highest it will sweep.

        The integral time of a speed loop and the inertia show below all orders, where what a
        drive does about a correction is no more hidden by what it does about the web: for them
        some tones stand there too, where the drive turns a roll whose radius is seen.
        """
        p = self._p
        low_Hz = LOW_SHARE * min((f for f in now_Hz if f > 0.0), default=0.0)
        high_Hz = min(p.f_max_Hz, max([*now_Hz, *self._swept_Hz(actuator)], default=0.0))
        grid = log_grid(low_Hz, high_Hz, p.grid_points)
        turned = next((r for r in self._site.rolls if r.name == actuator.turned_roll), None)
        if turned is None or turned.radius is None:
            return grid
        lowest_Hz = max(self._step_Hz, LOW_PERIODS / self._measured_s)
        return [*log_grid(lowest_Hz, low_Hz, p.low_points + 1)[:-1], *grid]

    @property
    def _measured_s(self) -> float:
        return self._p.duration_s - 2.0 * self._p.fade_s - self._p.settle_s

    def _swept_Hz(self, actuator: ActuatorParams) -> list[float]:
        """Return the highest frequency of every order: smallest radius, highest speed."""
        by_name = {roll.name: roll for roll in self._site.rolls}
        return [
            n * self._p.max_speed_m_s / (math.tau * _smallest_radius_m(by_name[roll]))
            for roll, n in actuator.orders
        ]

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
        return ProbeResult(
            actuator=name,
            response=Response(points=points, delay_s=delay_s, provenance=provenance, drive=drive),
            sign=measured_sign(points, delay_s),
            remarks=tuple(_remarks(float(np.ptp(ratio)) > RATIO_SPREAD, fit.strange)),
            no_drive=no_drive,
        )

    def _sent(self, j: int, keep: npt.NDArray[np.bool_]) -> list[Tone]:
        """Return the tones as they went out, the guard's share included."""
        share = float(np.nanmean(np.asarray(self._ratio[j])[keep]))
        if not share >= MIN_RATIO:
            raise RefusedError(f"{self._probed[j].name}: the excitation did not go out")
        amplitude = self._waves[j].amplitude(self._p.amplitude) * share
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


def _smallest_radius_m(roll: RollParams) -> float:
    return roll.radius_min_m if roll.radius is not None else roll.radius_m or roll.radius_min_m
