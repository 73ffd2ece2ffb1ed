"""Lines drawn by seed: web, drive, inertia, delays, noise; what the probe has to find out."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from aff_runtime.core.params import DriveParams
from benchmarks.control.laws import drive_in
from benchmarks.control.lines import FPM_M_S, INCH_M, nominal, spoilt, with_hidden
from benchmarks.control.lines import Hidden as OnTheLine
from benchmarks.control.lockstep import run
from sim_plant.line.declared.declaration import Declaration, LoadCell

WEBS = {
    # EA (N), density (kg/m3), thickness (m)
    "Tyvek": (9300.0, 395.0, 0.00019),
    "PE": (3960.0, 920.0, 0.0001),
    "film": (16000.0, 1390.0, 0.00005),
    "foil": (50000.0, 2700.0, 0.00003),
}
SHAPES = ("flat", "bulge", "asym")
CALM_S, CALM_N = 20.0, 2.0


@dataclass(frozen=True, slots=True, kw_only=True)
class DrawnLine:
    """One line as it really is, and the numbers that are to be found."""

    seed: int
    web: str
    declaration: Declaration
    speed_m_s: float
    delay_s: float

    @property
    def radius_m(self) -> float:
        """Radius of the unwind at the start."""
        return self.declaration.initial_radii_m.unwind

    def drive(self) -> DriveParams:
        """Return the true drive."""
        return drive_in(self.declaration)

    @property
    def duration_s(self) -> float:
        """How long a probe may last: a minute, less where the roll shrinks by 4 % before."""
        area_m2_s = self.declaration.web.thickness_m * self.speed_m_s
        return min(60.0, max(25.0, 0.04 * math.tau * self.radius_m**2 / area_m2_s))

    @property
    def stiffness_N_m(self) -> float:
        """Stiffness from the unwind to the S-wrap, EA / L."""
        names = [roller.name for roller in self.declaration.rollers]
        spans = self.declaration.spans[: names.index("swrap_lead")]
        return self.declaration.web.EA_N / sum(span.length_m for span in spans)


def draw(seed: int) -> DrawnLine:
    """Return line ``seed``; one whose own tension loop is not stable is drawn anew."""
    for again in itertools.count():
        line = _drawn(seed, np.random.default_rng([seed, 2121 + again]))
        if _is_stable(line):
            return line
    raise AssertionError("counting ends never")


def _is_stable(line: DrawnLine) -> bool:
    """Return whether the tension of the line, without what is wrong with it, comes to rest."""
    calm = line.declaration.model_copy(update={"effects": ()})
    speed = np.full(round(CALM_S / 0.005), line.speed_m_s)
    left = run(calm, {}, speed, seed=line.seed, on_s=math.inf).tension_N
    return float(np.std(left[left.size // 2 :])) < CALM_N


def _drawn(seed: int, rng: np.random.Generator) -> DrawnLine:
    """Return a line: webs in turn, the rest by chance."""
    web = tuple(WEBS)[seed % len(WEBS)]
    radius_m = float(rng.uniform(5.0, 8.0)) * INCH_M
    line = nominal("tyvek", radius_m)
    EA_N, density, thickness_m = WEBS[web]
    EA_N *= _around(rng, 1.3)
    update = {"EA_N": EA_N, "density_kg_m3": density, "thickness_m": thickness_m}
    gain = float(np.exp(rng.uniform(math.log(5.0), math.log(60.0))))
    drive = line.control.drives[0].model_copy(
        update={"K_ref_rad_s": gain, "zeta": float(rng.uniform(0.7, 1.5))}
    )
    length_m = sum(span.length_m for span in line.spans[:10])
    crossover = min(4.0, gain * float(rng.uniform(0.1, 0.25)))
    loop = line.control.tension_pi[0].model_copy(
        update={
            "gain_m_s_per_N": crossover * length_m / EA_N,
            "corner_rad_s": crossover * float(rng.uniform(0.3, 1.2)),
        }
    )
    inertia = line.inertia_kg_m2.unwind_core_and_drive * _around(rng, 2.0)
    rollers = tuple(
        roller.model_copy(update={"inertia_kg_m2": roller.inertia_kg_m2 * _around(rng, 1.6)})
        if roller.kind == "idler"
        else roller
        for roller in line.rollers
    )
    unwind = rollers[0].model_copy(update={"inertia_kg_m2": inertia})
    cell_Hz, noise_N = float(rng.uniform(5.0, 30.0)), float(rng.uniform(0.1, 0.4))
    rewind_gain = line.control.tension_pi[1].gain_m_s_per_N * min(1.0, 9300.0 / EA_N)
    second = line.control.tension_pi[1].model_copy(update={"gain_m_s_per_N": rewind_gain})
    line = line.model_copy(
        update={
            "web": line.web.model_copy(update=update),
            "rollers": (unwind, *rollers[1:]),
            "inertia_kg_m2": line.inertia_kg_m2.model_copy(
                update={"unwind_core_and_drive": inertia}
            ),
            "control": line.control.model_copy(
                update={"drives": (drive, *line.control.drives[1:]), "tension_pi": (loop, second)}
            ),
            "sensors": tuple(
                s.model_copy(update={"low_pass_Hz": cell_Hz, "noise_sd_N": noise_N})
                if isinstance(s, LoadCell)
                else s
                for s in line.sensors
            ),
        }
    )
    shape = SHAPES[int(rng.integers(len(SHAPES)))]
    line = spoilt(line, shape=shape, lead_m=2e-4, follower_m=3e-4)
    return DrawnLine(
        seed=seed,
        web=web,
        declaration=with_hidden(line, OnTheLine()),
        speed_m_s=float(rng.uniform(100.0, 300.0)) * FPM_M_S,
        delay_s=0.005 * int(rng.integers(0, 13)),
    )


def _around(rng: np.random.Generator, factor: float) -> float:
    """Return a ratio between 1 / factor and factor."""
    return float(np.exp(rng.uniform(-1.0, 1.0) * math.log(factor)))
