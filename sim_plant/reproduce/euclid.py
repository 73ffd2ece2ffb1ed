"""The Euclid line as the experiments use it: webs, radii, speeds, shapes, settled."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

import numpy as np

from sim_plant.base.arrays import RIPPLE, Array, LineArrays
from sim_plant.line.arrays.build import build_arrays, timing_of
from sim_plant.line.arrays.with_effects import apply_effects
from sim_plant.line.declared.declaration import Declaration, EffectEntry
from sim_plant.line.reading.load import load_declaration
from sim_plant.line.running.simulation import LineSimulation

DECLARATION = Path(__file__).resolve().parents[2] / "config" / "lines" / "euclid.yaml"
FPM_M_S = 0.00508
INCH_M = 0.0254
LBF_N = 4.4482216
LBF_FT_N_M = 1.3558179
TENSION_N = 20.0 * LBF_N
SWRAP_RADIUS_M = 0.15367

PE_EA_N, PE_DENSITY_KG_M3 = 3950.0, 920.0
"""Polyethylene: chosen so that 10 N steps overshoot 50 % in 3.7 s and the printed law is unstable
from 1.2 to 3.9 Hz and above 7.1 Hz, as measured on an independent model of this line."""

Change = Callable[[LineArrays], LineArrays]


@cache
def nominal() -> Declaration:
    """Return the declared line, Tyvek at 8 in."""
    return load_declaration(DECLARATION)


def declaration(web: str = "tyvek", radius_m: float = 8.0 * INCH_M) -> Declaration:
    """Return the line with a web, "tyvek" or "pe", and an unwind radius."""
    line = nominal()
    if web == "pe":
        material = line.web.model_copy(update={"EA_N": PE_EA_N, "density_kg_m3": PE_DENSITY_KG_M3})
        line = line.model_copy(update={"web": material})
    radii = line.initial_radii_m.model_copy(update={"unwind": radius_m})
    return line.model_copy(update={"initial_radii_m": radii})


def effect(name: str, location: str, **parameters: float | str) -> EffectEntry:
    """Return one thing that is wrong with the line."""
    return EffectEntry(effect=name, location=location, parameters=parameters)


def open_euclid(
    *,
    web: str = "tyvek",
    radius_m: float = 8.0 * INCH_M,
    speed_m_s: float = 100.0 * FPM_M_S,
    tension_N: float = TENSION_N,
    effects: Sequence[EffectEntry] = (),
    change: Change | None = None,
    seed: int | None = None,
    sample_time_s: float = 0.005,
    substeps: int = 1,
    torque_input: str = "",
    settle_s: float = 40.0,
) -> LineSimulation:
    """Return a settled line.

    ``change`` edits the arrays; ``torque_input`` names a driven roller that gets a torque input
    (``set_torque``), a ripple term of order 0 that the caller holds from sample to sample.
    """
    line = declaration(web, radius_m)
    arrays = build_arrays(line, timing_of(line, sample_time_s), substeps)
    arrays = apply_effects(line, arrays, effects)
    if torque_input:
        row = np.zeros(1, RIPPLE)
        row["drive"] = [d.roller for d in line.control.drives].index(torque_input)
        arrays = arrays._replace(ripples=np.concatenate((arrays.ripples, row)))
    if change is not None:
        arrays = change(arrays)
    simulation = LineSimulation(
        line,
        sample_time_s=sample_time_s,
        seed=seed,
        arrays=arrays,
        substeps=substeps,
        line_speed_m_s=speed_m_s,
        tension_N=tension_N,
    )
    simulation.settle(settle_s)
    return simulation


def set_torque(simulation: LineSimulation, torque_N_m: float) -> None:
    """Hold a torque on the roller named ``torque_input`` from now on."""
    simulation.arrays.ripples["cos_N_m"][-1] = torque_N_m


def body(simulation: LineSimulation, name: str) -> int:
    """Return the index of a roller."""
    return simulation.declaration.body(name)


def steady(
    simulation: LineSimulation, duration_s: float, speed_m_s: float, tension_N: float = TENSION_N
) -> dict[str, Array]:
    """Return the record of ``duration_s`` at constant references, with ``time_s``."""
    rows = round(duration_s / simulation.sample_time_s)
    found = simulation.simulate(np.full(rows, speed_m_s), np.full(rows, tension_N))
    found["time_s"] = times(rows, simulation.sample_time_s)
    return found


def spectrum(signal: Array, sample_time_s: float, highest_Hz: float) -> tuple[Array, Array]:
    """Return frequencies and peak amplitudes (Hann window) up to ``highest_Hz``."""
    window = np.hanning(signal.size)
    time = np.linspace(-1.0, 1.0, signal.size)
    flat = signal - np.polyval(np.polyfit(time, signal, 1), time)
    padded = 8 * signal.size
    amplitude = np.abs(np.fft.rfft(flat * window, padded)) * 2.0 / window.sum()
    frequency = np.asarray(np.fft.rfftfreq(padded, sample_time_s), dtype=np.float64)
    keep = frequency <= highest_Hz
    return frequency[keep], amplitude[keep]


def peak_near(
    frequency_Hz: Array, amplitude: Array, around_Hz: float, width: float = 0.12
) -> float:
    """Return the frequency of the largest amplitude within ``width`` (relative) of a frequency."""
    inside = np.flatnonzero(np.abs(frequency_Hz - around_Hz) <= width * around_Hz)
    return float(frequency_Hz[inside[int(np.argmax(amplitude[inside]))]])


def turning_Hz(speed_m_s: float, radius_m: float) -> float:
    """Return v / (2 pi R) (2.47): the source writes v[FPM] / (10 pi R[in])."""
    return speed_m_s / (2.0 * np.pi * radius_m)


def turned(omega_rad_s: Array, sample_time_s: float) -> Array:
    """Return the angle since the first row, from speeds (trapezia)."""
    steps = 0.5 * sample_time_s * (omega_rad_s[1:] + omega_rad_s[:-1])
    return np.concatenate(([0.0], np.cumsum(steps)))


def times(rows: int, sample_time_s: float) -> Array:
    """Return the instants of a record, from 0 on."""
    return np.asarray(sample_time_s * np.arange(rows), dtype=np.float64)
