"""Small real records: the search's own objects over a line that a formula stands for.

Nothing here is a stand-in for what is tested: pool, objective, noise and fits are the product's.
Only the simulation of the line is a formula, so a test knows what each number does.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import declared_objective
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Twin
from sim_plant.refine.report.verdict import EffectFinding, Verdict
from sim_plant.refine.spectra.coordinates import RecordAxes
from sim_plant.refine.spectra.spectral_lines import SpectralLines

LINE_FILE = Path(__file__).parents[3] / "config/lines/euclid.yaml"
STEP_S = 0.01
MODULUS = {"*": 0.0, "web.EA_N": 0.02}
"""Tolerances of a line of which one number alone is not known for certain."""
LINE = load_declaration(LINE_FILE).model_copy(update={"sample_time_s": STEP_S})


def line_with(tolerances=None, **more):
    """Return the Euclid line with these tolerances, the modulus alone if none are given."""
    return LINE.model_copy(
        update={"tolerances": MODULUS if tolerances is None else tolerances} | more
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FormulaTwin(Twin):
    """A twin whose channels (channels, samples) are a formula of the case, plus white noise.

    ``noise_sd`` is per channel. ``simulated`` are all cases that were asked for, in order.
    """

    formula: Callable
    noise_sd: tuple[float, ...]
    simulated: list = field(default_factory=list)

    def simulate(self, case):
        self.simulated.append(case)
        clean = np.asarray(self.formula(case), dtype=np.float64)
        if case.seed is None:
            return clean
        sd = np.array(self.noise_sd)[:, None]
        return clean + sd * np.random.default_rng(1000 + case.seed).standard_normal(clean.shape)


def formula_twin(formula, channels, samples, *, noise_sd=1.0, line=None, speed_m_s=1.0):
    """Return a twin of ``channels`` whose every noise has this standard deviation."""
    sd = (noise_sd,) * len(channels) if np.isscalar(noise_sd) else tuple(noise_sd)
    return FormulaTwin(
        declaration=line or line_with(),
        channels=tuple(channels),
        speed_m_s=np.broadcast_to(np.asarray(speed_m_s, dtype=np.float64), (samples,)).copy(),
        tension_N=np.full(samples, 89.0),
        aff_m_s={},
        formula=formula,
        noise_sd=sd,
    )


def pool_of(*twins):
    """Return a pool that simulates in this process."""
    return SimulationPool(twins, workers=1)


def objective_of(twin, measured):
    """Return the objective of one record."""
    return declared_objective(pool_of(twin), [np.asarray(measured, dtype=np.float64)])


def axes_at(speed_m_s, line=None):
    """Return the axes of a record at this speed (samples,), no roll wound up or off."""
    line, speed = line or line_with(), np.asarray(speed_m_s, dtype=np.float64)
    metres = np.cumsum(speed) * STEP_S
    radii = np.array([roller.radius_m for roller in line.rollers])
    return RecordAxes(
        declaration=line,
        sample_time_s=STEP_S,
        time_s=np.arange(speed.size) * STEP_S,
        travel_m=metres,
        angles_rad=metres[None, :] / radii[:, None],
        speed_m_s=speed,
    )


def one_peak(chi2_reduction=0.0):
    """Return the spectra of one record with one line of this strength, at 1 Hz."""
    line = SpectralLines(
        axis="time",
        roll="",
        frequency=np.array([1.0, 1.1]),
        chi2_reduction=np.array([chi2_reduction, 0.0]),
        degrees=72,
    )
    return ((line,),)


def white(shape, seed=1):
    """Return white noise of unit size."""
    return np.random.default_rng(seed).standard_normal(shape)


def fit_of(*hypotheses, values=None, cost=0.0, residual=None, shifts=None):
    """Return a fit that was not made by fitting, with this cost."""
    return Fit(
        hypotheses=tuple(hypotheses),
        values=tuple(values if values is not None else (h.start for h in hypotheses)),
        shifts=shifts or {},
        cost=cost,
        residual=np.zeros(0) if residual is None else residual,
        covariance=np.zeros((0, 0)),
    )


def quiet(_text):
    """Say nothing."""


def finding(effect, location, parameters, **more):
    """Return an effect of a verdict."""
    given = {
        "interval95": {},
        "score": 1000.0,
        "runner_up": None,
        "margin": 1000.0,
        "cancel": True,
        "text": BY_NAME[effect].text,
    }
    return EffectFinding(place=EffectAt(effect, location), parameters=parameters, **(given | more))


def verdict_with(*effects, unknown=(), ambiguous=(), answer="traced"):
    """Return a verdict that nothing was judged on."""
    return Verdict(
        answer=answer,
        effects=effects,
        unknown=tuple(unknown),
        ambiguous=tuple(ambiguous),
        residual_rms={},
        holdout="b.csv",
    )
