"""Finds how loud a probe is to be: from a quiet stretch, and by steps where nothing is known."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from enum import IntEnum

import numpy as np
import numpy.typing as npt

from aff_runtime.base.signals import ActuatorStep
from aff_runtime.core.params import ActuatorParams, OutputKind, ProbeParams, SiteParams
from aff_runtime.core.probe.excitation import Waveform
from aff_runtime.core.probe.loud import (
    FIRST_SHARE,
    STEEPEST,
    Complexes,
    Floats,
    Heard,
    allowed,
    peak_of,
    unbiased,
)
from aff_runtime.core.probe.quiet import QuietWindow
from aff_runtime.core.probe.repeats import alike
from aff_runtime.core.response import Response

FIT_NOISE = 1.3
"""Noise of a tone in the fit over that in a spectrum: ripple beside it takes its part."""
HOLES = (
    "too few readings were new to choose the amplitude. Does the PLC scan more slowly than "
    "cycle_ms? Else the wire loses them; probe again"
)
HELD_UP = 1.1
"""Of a stretch: ticks that bring no new angle, and those that work on what was heard."""
LONGEST_S = 600.0
"""What ``probe.duration_s`` takes."""
AS_GOOD = 1.1
"""Times what is sent: who needs no more than that needs no other bound."""
ROUNDED = 1.0 + 1e-9


class Step(IntEnum):
    """Where the rise stands."""

    FADING = 0
    SETTLING = 1
    HEARING = 2
    WEIGHING = 3
    ENDING = 4
    ENDED = 5
    HELD = 6


class Choosing:
    """The amplitude of every wave, within ``params.amplitude`` and the bounds of the signals.

    Parameters
    ----------
    former : the response of an actuator as it was measured before; with one of every actuator,
        at the present speed, nothing has to be tried.

    Attributes
    ----------
    window : that hears the signals of the probed actuators; the quiet stretch is passed to it.
    levels : peak of every wave. ``needed`` : what the noise asks for.
    steps : how many were heard. ``reason`` : why nothing is to be measured, empty for nothing.
    remarks : per actuator, what is not heard within the bounds.
    """

    def __init__(
        self,
        site: SiteParams,
        params: ProbeParams,
        probed: Sequence[ActuatorParams],
        waves: Sequence[Waveform],
        former: Mapping[str, Response],
    ) -> None:
        self._p, self._probed, self._waves = params, probed, waves
        self._cycle_s = site.cycle_s
        self.window = QuietWindow(
            waves[0].period,
            site.cycle_s,
            signals=len(probed),
            angles=len(site.rolls),
            orders=params.nuisance_orders,
        )
        self._former = [former.get(one.name) for one in probed]
        self._shorter = self.window.seconds / params.measured_s * FIT_NOISE
        self._bounds: list[float] = [math.inf] * len(probed)
        self._counts: list[npt.NDArray[np.bool_]] = []
        self._noise: list[list[Floats]] = []
        self._work: Iterator[bool] | None = None
        self._step, self._k, self._began, self._waited = Step.FADING, 0, 0, 0
        self._from = [0.0] * len(probed)
        self.levels = [0.0] * len(probed)
        self.needed = [math.nan] * len(probed)
        self.steps = 0
        self.reason = ""
        self.remarks: list[tuple[str, ...]] = [()] * len(probed)

    # --- the quiet stretch ----------------------------------------------------------------------

    def weigh_quiet(self, bounds: Sequence[float], lowest_Hz: Sequence[float]) -> bool:
        """Work on the noise for one tick; True when it is known.

        Parameters
        ----------
        bounds : by how much each signal may be moved.
        lowest_Hz : per wave, above which its tones stand where orders lie.
        """
        if self._work is None:
            self._work = self.window.weigh()
            self._bounds = list(bounds)
            self._counts = [
                wave.at * self.window.turn_Hz >= low_Hz
                for wave, low_Hz in zip(self._waves, lowest_Hz, strict=True)
            ]
        if not next(self._work):
            return False
        self._work = None
        self._noise = [
            [self.window.noise(j, wave.at) for wave in self._waves]
            for j in range(len(self._probed))
        ]
        if not all(np.isfinite(one).all() for row in self._noise for one in row):
            self.reason = HOLES
        return True

    def is_known(self, line_speed_m_s: float) -> bool:
        """Choose from what former probes measured; False where one is missing, or not of here.

        At another speed a line may answer several times as strongly.
        """
        answers = []
        for former, wave in zip(self._former, self._waves, strict=True):
            if former is None or not alike(former.provenance.line_speed_m_s, line_speed_m_s):
                return False
            answers.append(np.array([former.at(float(k) * self.window.turn_Hz) for k in wave.at]))
        own = [
            peak_of(answer * wave.phasors, wave.at, wave.period)
            for answer, wave in zip(answers, self._waves, strict=True)
        ]
        wanted = self._wanted(answers, math.inf)
        self.levels = allowed(wanted, np.diag(own), self._bounds)
        self._judge(answers, np.diag(own))
        return True

    # --- by steps -------------------------------------------------------------------------------

    def begin_steps(self) -> None:
        """Begin at a small part of the bound."""
        self._k = 1
        self._go_to([FIRST_SHARE * self._p.amplitude] * len(self._probed), Step.FADING)

    def sound(
        self, ticks: int, signals: Sequence[float], angles: Sequence[float]
    ) -> tuple[ActuatorStep, ...]:
        """Return what one tick sends; ``has_ended`` says when it was the last.

        Parameters
        ----------
        ticks : cycles since the last call.
        signals, angles : of the snapshot; NaN for what is missing.
        """
        self._k += ticks
        self._waited += ticks
        waited_s = self._waited * self._cycle_s
        if self._step is Step.FADING and waited_s >= self._p.fade_s:
            self._step, self._waited = Step.SETTLING, 0
        elif self._step is Step.SETTLING and waited_s >= self._p.settle_s:
            self._step, self._began = Step.HEARING, self._k
            self.window.begin()
        if self._step is Step.HEARING:
            self._hear(ticks, signals, angles)
        elif self._step is Step.WEIGHING and self._work is not None and next(self._work):
            self._work = None
            self._decide()
        elif self._step is Step.ENDING and waited_s >= self._p.fade_s:
            self._step = Step.ENDED
        return self._sent()

    def hold(self) -> None:
        """Go no further: what is sent stays as loud as it is, and is faded by who withdraws it."""
        self.levels = [level for _, level in self._now()]
        self._step, self._work = Step.HELD, None

    def needed_of(self, j: int) -> float:
        """Return the peak that one wave needs; NaN where none would do."""
        return self.needed[j] if math.isfinite(self.needed[j]) else math.nan

    @property
    def is_at_work(self) -> bool:
        """Whether steps are being taken."""
        return self._k > 0 and not self.has_ended

    @property
    def has_ended(self) -> bool:
        """Whether the steps are over and nothing is sent any more."""
        return self._step is Step.ENDED

    @property
    def at_most_s(self) -> float:
        """How long the choice takes at most: the quiet stretch, and steps where needed."""
        quiet_s = self._p.listen_s + HELD_UP * self.window.seconds
        steps = 1 + math.ceil(math.log(1.0 / FIRST_SHARE, STEEPEST))
        step_s = self._p.fade_s + self._p.settle_s + HELD_UP * self.window.seconds
        return quiet_s + steps * step_s + self._p.fade_s

    def _hear(self, ticks: int, signals: Sequence[float], angles: Sequence[float]) -> None:
        """Take one sample; a tick that was missed is one without a reading."""
        self.window.pass_on(ticks if self._k > self._began else 1, signals, angles)
        if self.window.is_full:
            self._step, self._work = Step.WEIGHING, self.window.weigh()

    def _decide(self) -> None:
        """Go on louder, or end with what is chosen."""
        self.steps += 1
        if not all(self.window.is_told(j) for j in range(len(self._probed))):
            self.reason = HOLES
            self._go_to(self.levels, Step.ENDING)
            return
        moved = np.zeros((len(self._probed), len(self._waves)))
        answers: list[Complexes] = []
        for j in range(len(self._probed)):
            for i, wave in enumerate(self._waves):
                seen = unbiased(self.window.phasors(j, wave.at), self._noise[j][i])
                level = self.levels[i]
                moved[j, i] = peak_of(seen, wave.at, wave.period) / level
                if i == j:
                    ahead = np.exp(2j * math.pi * wave.at * (self._began / wave.period))
                    answers.append(seen / (level * wave.phasors * ahead))
        wanted = self._wanted(answers, STEEPEST)
        louder = allowed(wanted, moved, self._bounds)
        is_steep = any(
            one * ROUNDED >= STEEPEST * level and need > one and one * ROUNDED < self._p.amplitude
            for one, level, need in zip(louder, self.levels, self.needed, strict=True)
        )
        if is_steep:
            self._go_to(louder, Step.FADING)
            return
        self._go_to(louder, Step.ENDING)
        self._judge(answers, moved)

    def _wanted(self, answers: Sequence[Complexes], steepest: float) -> list[float]:
        """Return the peaks that the tones need, within the bound and one step."""
        heard = [self._heard(j, answer) for j, answer in enumerate(answers)]
        self.needed = [max(one.needed(), self._p.louder_than) for one in heard]
        now = [level * steepest if math.isfinite(steepest) else math.inf for level in self.levels]
        return [
            min(need, self._p.amplitude, most) for need, most in zip(self.needed, now, strict=True)
        ]

    def _heard(self, j: int, answers: Complexes) -> Heard:
        return Heard(
            sizes=np.abs(self._waves[j].phasors),
            answers=answers,
            noise=self._noise[j][j] * self._shorter,
            counts=self._counts[j],
        )

    def _judge(self, answers: Sequence[Complexes], moved: Floats) -> None:
        """Say what is not heard within the bounds, and what to do."""
        for j, answer in enumerate(answers):
            heard, level = self._heard(j, answer), self.levels[j]
            least = heard.least()
            if level * ROUNDED < least:
                self.reason = self.reason or f"{self._probed[j].name}: {self._unheard(j, least)}"
            elif level * AS_GOOD < self.needed[j]:
                said = f"{heard.sure(level)} of {int(self._counts[j].sum())}"
                self.remarks[j] = (
                    f"within its bound {said} tones of orders are heard surely; "
                    f"{self._way_out(j, self.needed[j])}",
                )

    def _unheard(self, j: int, least: float) -> str:
        return f"the probe is not heard within its bound; {self._way_out(j, least)}"

    def _way_out(self, j: int, peak: float) -> str:
        """Return the amplitude that would be needed, and which keys to change."""
        of_speed = self._probed[j].output is OutputKind.VELOCITY_REFERENCE
        unit, key = ("m/s", "bound_m_s") if of_speed else ("N m", "bound_N_m")
        level = self.levels[j]
        if not math.isfinite(peak):
            return (
                f"nothing answers {level:.2g} {unit}: is the correction wired and let in at the "
                f"drive? Else raise probe.{key}"
            )
        is_signal = level * ROUNDED < self._p.amplitude
        which = "probe.bound_N" if is_signal else f"probe.{key}"
        longer_s = self._p.duration_s * (peak / level) ** 2
        longer = f", or probe.duration_s to {longer_s:.0f}" if longer_s <= LONGEST_S else ""
        return f"{peak:.2g} {unit} would be needed, {level:.2g} may be: raise {which}{longer}"

    # --- what goes out --------------------------------------------------------------------------

    def _go_to(self, levels: Sequence[float], step: Step) -> None:
        """Fade from the present levels to others; to none where the steps end."""
        self._from = list(self.levels)
        self.levels = list(levels)
        self._step, self._waited = step, 0

    def _sent(self) -> tuple[ActuatorStep, ...]:
        if self._step is Step.ENDED:
            return (ActuatorStep(value=0.0, peak_bound=0.0, slew_bound=0.0),) * len(self._waves)
        sent = []
        for wave, before, (goal, level) in zip(self._waves, self._from, self._now(), strict=True):
            most = max(before, goal)
            sent.append(
                ActuatorStep(
                    value=wave.turn(self._k, level),
                    peak_bound=most,
                    slew_bound=wave.steepness(most) + abs(goal - before) / self._p.fade_s,
                )
            )
        return tuple(sent)

    def _now(self) -> Iterator[tuple[float, float]]:
        """Yield where the level of every wave goes, and what it is."""
        is_fading = self._step in (Step.FADING, Step.ENDING)
        share = min(1.0, self._waited * self._cycle_s / self._p.fade_s) if is_fading else 1.0
        for before, after in zip(self._from, self.levels, strict=True):
            goal = 0.0 if self._step is Step.ENDING else after
            yield goal, before + share * (goal - before)
