"""P(jw) of the simulated line, measured as on a machine: a sum of sines on one correction."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sim_plant.base.arrays import Array
from sim_plant.line.running.simulation import LineSimulation

ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantResponse:
    """Points of P; between them log gain and unwrapped phase are linear in frequency."""

    frequency_Hz: tuple[float, ...]
    log_gain: tuple[float, ...]
    phase_rad: tuple[float, ...]

    def at(self, frequency_Hz: float) -> complex:
        """Return P at a frequency; the end points stand in outside."""
        f = self.frequency_Hz
        k = min(max(bisect_right(f, frequency_Hz) - 1, 0), len(f) - 2)
        share = min(max((frequency_Hz - f[k]) / (f[k + 1] - f[k]), 0.0), 1.0)
        gain = self.log_gain[k] + share * (self.log_gain[k + 1] - self.log_gain[k])
        phase = self.phase_rad[k] + share * (self.phase_rad[k + 1] - self.phase_rad[k])
        return complex(np.exp(gain + 1j * phase))

    def values(self) -> ComplexArray:
        """Return P at its points."""
        return np.exp(np.array(self.log_gain) + 1j * np.array(self.phase_rad))


def response_of(frequency_Hz: Array, values: ComplexArray) -> PlantResponse:
    """Return the interpolating response through measured points."""
    return PlantResponse(
        frequency_Hz=tuple(float(f) for f in frequency_Hz),
        log_gain=tuple(float(g) for g in np.log(np.abs(values))),
        phase_rad=tuple(float(p) for p in np.unwrap(np.angle(values))),
    )


def measure_response(
    open_line: Callable[[], LineSimulation],
    roller: str,
    channel: str,
    frequency_Hz: Array,
    speed_m_s: float,
    tension_N: float,
    *,
    amplitude_m_s: float = 1e-3,
    duration_s: float = 40.0,
) -> PlantResponse:
    """Return P from corrections at ``roller`` to ``channel``, PI and delays as they are.

    All frequencies at once with spread phases; the same run without them is subtracted, so
    ripple and drift cancel, and least squares reads the phasors after 10 s. The sines must be
    larger than the encoders' resolution, or its steps change the drives' gain: 0.2 mm/s errs by
    11 %, 1 mm/s by 2 %.
    """
    phases = np.pi * np.arange(frequency_Hz.size) ** 2 / frequency_Hz.size
    base, driven = open_line(), open_line()
    time = base.sample_time_s * np.arange(round(duration_s / base.sample_time_s))
    angles = 2.0 * np.pi * frequency_Hz[:, None] * time + phases[:, None]
    speed, tension = np.full(time.size, speed_m_s), np.full(time.size, tension_N)
    quiet = base.simulate(speed, tension)["true_" + channel]
    wave = amplitude_m_s * np.sum(np.cos(angles), axis=0)
    moved = driven.simulate(speed, tension, {roller: wave})["true_" + channel] - quiet
    late = time >= 10.0
    columns = np.vstack((np.cos(angles), np.sin(angles), np.ones(time.size)))[:, late].T
    found = np.linalg.lstsq(columns, moved[late], rcond=None)[0]
    count = frequency_Hz.size
    phasors = (found[:count] - 1j * found[count : 2 * count]) / amplitude_m_s
    return response_of(frequency_Hz, phasors)
