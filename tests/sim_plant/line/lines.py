"""Lines to test on: the shipped declarations, exact instruments, frozen radii on demand."""

from functools import cache
from pathlib import Path

import numpy as np

from sim_plant.line.declared.declaration import Declaration, EffectEntry
from sim_plant.line.open import make_line
from sim_plant.line.reading.load import load_declaration
from sim_plant.line.running.simulation import LineSimulation

ROOT = Path(__file__).resolve().parents[3]
LINES = ROOT / "config" / "lines"
FPM_M_S = 0.3048 / 60.0
INCH_M = 0.0254


@cache
def declared(name: str) -> Declaration:
    return load_declaration(LINES / f"{name}.yaml")


def with_rolls(line: Declaration, unwind_m: float) -> Declaration:
    radii = line.initial_radii_m.model_copy(update={"unwind": unwind_m})
    return line.model_copy(update={"initial_radii_m": radii})


def with_effect(line: Declaration, effect: str, location: str, **parameters) -> Declaration:
    entry = EffectEntry(effect=effect, location=location, parameters=parameters)
    return line.model_copy(update={"effects": (*line.effects, entry)})


def exact_line(line: Declaration, *, frozen: bool = True, settle_s: float = 4.0, **options):
    """A noise-free line with exact speed signals; ``frozen`` winds a web without thickness."""
    simulation: LineSimulation = make_line(line, seed=None, **options)
    simulation.arrays.drives["noise_rad_s"] = 0.0
    simulation.arrays.drives["lsb_rad_s"] = 0.0
    if frozen:
        simulation.arrays.web["thickness_m"] = 0.0
    if settle_s:
        simulation.settle(settle_s)
    return simulation


def hold(
    simulation: LineSimulation, duration_s: float, speed_m_s=1.016, tension_N=88.9644, aff=None
):
    """Run at constant references."""
    samples = round(duration_s / simulation.sample_time_s)
    return simulation.simulate(np.full(samples, speed_m_s), np.full(samples, tension_N), aff or {})


def phasor(values, frequency_Hz: float, sample_time_s: float) -> complex:
    """Least-squares phasor of a sine with a mean and a slope in ``values``."""
    t = np.arange(values.size) * sample_time_s
    turn = 2.0 * np.pi * frequency_Hz * t
    basis = np.column_stack((np.cos(turn), -np.sin(turn), np.ones_like(t), t - t.mean()))
    a, b, *_ = np.linalg.lstsq(basis, values, rcond=None)[0]
    return complex(a, b)
