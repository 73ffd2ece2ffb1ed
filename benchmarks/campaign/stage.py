"""A healthy machine under its references, ready to run with any fault put on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.campaign import line as short
from benchmarks.campaign.cases import ROWS, Case
from benchmarks.campaign.contact import Array, Bodies
from benchmarks.campaign.effect_table import BY_NAME
from benchmarks.campaign.fault import Fault
from benchmarks.campaign.machine import CENTRE_M, IDLER_ECCENTRICITY_M, Scatter, scattered
from benchmarks.campaign.record import References, references, simulate
from benchmarks.campaign.state import Machine

RADII = {"a": short.NOMINAL_RADII, "b": (0.162, 0.166)}
JUDGED_FROM_S = 15.0
SIZED_BY = (*short.CELLS, *short.SPEEDS)
"""Channels in which a signal-to-noise ratio is taken; angles drift without bound."""


def with_faults(m: Machine, faults: tuple[Fault, ...]) -> Machine:
    """Return a copy of the machine with these faults as record a has them."""
    bodies = Bodies._make(part.copy() for part in m.bodies)
    found = Machine._make([bodies, *(part.copy() for part in m[1:])])
    for fault in sorted(faults, key=lambda f: BY_NAME[f.effect].put_last):
        found = BY_NAME[fault.effect].put_on(found, fault)
    return found


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Stage:
    """One record to be, ``a`` or ``b``: a healthy machine, its references and start angles."""

    which: str
    machine: Machine
    told: References
    angles: Array
    seed: int
    colour: float

    def quiet(self, faults: tuple[Fault, ...] = ()) -> dict[str, Array]:
        """Return the channels without noise."""
        m = self.guilty(faults)
        return simulate(m, self.told, self.angles, self.seed, noise=False).even()

    def guilty(self, faults: tuple[Fault, ...]) -> Machine:
        """Return the machine with these faults as this record has them."""
        return with_faults(self.machine, tuple(f.in_record(self.which) for f in faults))


def stage(case: Case, which: str, nudged: int = -1) -> Stage:
    """Return record ``a`` or ``b`` of a case, healthy; the machine is the same in both.

    One number of the machine, the draw ``nudged``, may be a standard deviation higher.
    """
    rng = np.random.default_rng([case.seed, ord(which)])
    declared = short.declaration(RADII[which])
    told = references(ROWS, rng, speeds=case.speeds, commensurate=case.commensurate)
    machine = scattered(declared, Scatter(np.random.default_rng([case.seed, 7]), 1.0, nudged))
    angles = rng.uniform(0.0, 2.0 * np.pi, size=machine.radius.size)
    return Stage(
        which=which,
        machine=machine,
        told=told,
        angles=angles,
        seed=int(rng.integers(1 << 31)),
        colour=case.colour,
    )


def tolerances(case: Case) -> list[int]:
    """Return the draws of the machine that move it as a whole (not an axis or half a micron)."""
    draws = Scatter(np.random.default_rng([case.seed, 7]), 1.0)
    scattered(short.declaration(RADII["a"]), draws)
    small = (CENTRE_M, IDLER_ECCENTRICITY_M)
    return [k for k, width in enumerate(draws.widths) if width not in small]


def rms(values: Array) -> float:
    """Return the rms of the judged part."""
    return float(np.sqrt(np.mean(values[round(JUDGED_FROM_S / short.SAMPLE_S) :] ** 2)))
