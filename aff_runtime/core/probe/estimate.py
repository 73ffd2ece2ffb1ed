"""Least squares on a probe's record: P at every tone, its error, the delay, the sign."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from aff_runtime.core.identify.regression import Regression
from aff_runtime.core.probe.strange_ripple import RippleLine, drifting, strange_lines
from aff_runtime.core.response import ResponsePoint

Floats = npt.NDArray[np.float64]
MAX_DELAY_S = 1.0
DELAY_STEPS = 501
FIRST_TONE = 3
ON_BINS, BESIDE_BINS, HIDES = 1.5, 4.5, 0.5
SIGN_BAND = 3.0
CLEAR_SIGN = 0.2


@dataclass(frozen=True, slots=True, kw_only=True)
class Tone:
    """One tone that went out: output = amplitude cos(omega t + phase)."""

    omega_rad_s: float
    phase_rad: float
    amplitude: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Fit:
    """P at every tone that is to be believed, and the strange ripple that hid the others."""

    points: tuple[ResponsePoint, ...]
    strange: tuple[RippleLine, ...]
    design: Floats
    """Columns of the regression; those of the tones begin at ``FIRST_TONE``."""


def fit_tones(
    *,
    time_s: Floats,
    signal: Floats,
    angles_rad: Sequence[Floats],
    nuisance_orders: int,
    own: Sequence[Tone],
    foreign: Sequence[Tone],
) -> Fit:
    """Return P at every tone of ``own`` that no strange ripple stands beside.

    Columns of the regression: every tone (of other actuators too), orders 1..``nuisance_orders``
    on each roll's angle with amplitudes that drift (a roll that shrinks by 2 % in the record
    otherwise leaves its ripple beside the tones), and a parabola for drift. Ripple of rolls that
    the site does not know becomes columns as well, see ``strange_ripple``: one newton of an idler
    otherwise spoils tones of a twentieth of that for half a hertz on both sides. A tone right
    beside such ripple is left out: neither P nor its error could be told there. The standard
    error of a tone comes from the residual beside it (``Regression.noise``), so coloured noise
    and unmodelled ripple count where they are.

    Parameters
    ----------
    time_s, signal : one entry per good sample; ``angles_rad`` likewise, per roll.
    own, foreign : tones of the actuator in question and of the others.
    """
    span_s = float(time_s[-1] - time_s[0])
    drift = (time_s - 0.5 * (time_s[0] + time_s[-1])) / span_s
    columns: list[Floats] = [np.ones_like(drift), drift, drift**2]
    for tone in (*own, *foreign):
        argument = tone.omega_rad_s * time_s + tone.phase_rad
        columns += [np.cos(argument), -np.sin(argument)]
    for angle in angles_rad:
        for n in range(1, nuisance_orders + 1):
            columns += drifting(n * angle, drift)
    highest_Hz = max(tone.omega_rad_s for tone in (*own, *foreign)) / math.tau
    lines = strange_lines(time_s, signal, np.column_stack(columns), highest_Hz)
    for line in lines:
        columns += drifting(math.tau * line.frequency_Hz * time_s, drift)
    design = np.column_stack(columns)
    solution = np.linalg.lstsq(design, signal, rcond=1e-9)[0]
    residual = (signal - design @ solution)[:, None]
    regression = Regression(time_s, design)
    points: list[ResponsePoint] = []
    strange: dict[RippleLine, None] = {}
    for k, tone in enumerate(own):
        at = FIRST_TONE + 2 * k
        seen = complex(solution[at], solution[at + 1])
        if hiding := [line for line in lines if _hides(line, tone, abs(seen), span_s)]:
            strange |= dict.fromkeys(hiding)
            continue
        noise, _ = regression.noise(residual, tone.omega_rad_s, at)
        error = math.sqrt(noise[0, 0].real)
        gain = abs(seen) / tone.amplitude
        if gain > 0.0:
            points.append(
                ResponsePoint(
                    frequency_Hz=tone.omega_rad_s / math.tau,
                    gain=gain,
                    phase_rad=math.atan2(seen.imag, seen.real),
                    relative_error=error / abs(seen),
                    coherence=abs(seen) ** 2 / (abs(seen) ** 2 + error**2),
                )
            )
    return Fit(points=tuple(points), strange=tuple(strange), design=design)


def _hides(line: RippleLine, tone: Tone, seen: float, span_s: float) -> bool:
    """Return whether a line stands on a tone, or as large as it right beside it."""
    bins = abs(line.frequency_Hz - tone.omega_rad_s / math.tau) * span_s
    return bins < ON_BINS or (bins < BESIDE_BINS and line.amplitude > HIDES * seen)


def fit_delay(points: Sequence[ResponsePoint]) -> float:
    """Return the delay (s) after whose removal the phase turns least from point to point.

    Lags count as delay where they look like one; the rest stays in the points.
    """
    if len(points) < 3:
        return 0.0
    ordered = sorted(points, key=lambda point: point.frequency_Hz)
    omega = np.array([math.tau * p.frequency_Hz for p in ordered])
    phase = np.array([p.phase_rad for p in ordered])
    error = np.array([p.relative_error for p in ordered])
    weight = 1.0 / (0.05**2 + error[1:] ** 2 + error[:-1] ** 2)
    delays = np.linspace(0.0, MAX_DELAY_S, DELAY_STEPS)
    turned = np.diff(phase[None, :] + delays[:, None] * omega[None, :], axis=1)
    turned = np.angle(np.exp(1j * turned))
    cost = (weight * turned**2).sum(axis=1)
    return float(delays[int(np.argmin(cost))])


def measured_sign(points: Sequence[ResponsePoint], delay_s: float) -> int:
    """Return the sign of P: +1, -1, 0 for undecided.

    Low frequencies decide (up to three times the lowest): delay removed, the mean of
    cos(arg P), weighted by quality, must exceed 0.2.
    """
    mean = low_direction(points, delay_s).real
    return 0 if abs(mean) < CLEAR_SIGN else int(math.copysign(1.0, mean))


def low_direction(points: Sequence[ResponsePoint], delay_s: float) -> complex:
    """Return the mean of P / abs(P) at low frequencies, delay removed, weighted by quality.

    Low are those up to ``SIGN_BAND`` times the lowest; 0 where there is no point.
    """
    lowest = min((p.frequency_Hz for p in points), default=0.0)
    low = [p for p in points if p.frequency_Hz <= SIGN_BAND * lowest]
    weight = sum(p.coherence for p in low)
    turned = (
        cmath.rect(p.coherence, p.phase_rad + math.tau * p.frequency_Hz * delay_s) for p in low
    )
    return sum(turned, 0j) / weight if weight > 0.0 else 0j
