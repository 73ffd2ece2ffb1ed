"""What is left when the library has nothing more to say: its class and its coordinate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.search.coherence import oddest_coupling
from sim_plant.refine.search.outside_prior import joint_conflict
from sim_plant.refine.spectra.line_spectrum import LineSpectrum

LINE_THRESHOLD = 260.0
"""Free-line drop (72 degrees of freedom, best of all bins) of healthy records stays below this."""
LOUD = 1.12
"""Power over noise above which a channel holds something broadband.

Records without an effect, of other code with coloured noise and late scans: up to 1.05.
"""
COUPLED = 20.0
"""Score of ``coupling.oddest_pair`` above which something pushes the line that is no noise.

Of 36 records without an effect, of other code, the oddest pair has 10.2.
"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Unknown:
    """A residual that no effect of the library explains."""

    kind: str
    coordinate: dict[str, float | str]
    strength: float

    def like(self, other: Unknown) -> bool:
        """Return whether both are orders of the same roll."""
        roll = self.coordinate.get("roll")
        return self.kind == other.kind == "angle" and roll == other.coordinate.get("roll")

    @property
    def text(self) -> str:
        """Class and coordinate, for people."""
        where = ", ".join(
            f"{key} {value:.5g}" if isinstance(value, float) else f"{key} {value}"
            for key, value in self.coordinate.items()
        )
        return f"{self.kind} ({where})"


def strongest_line(found: Sequence[Sequence[LineSpectrum]]) -> tuple[LineSpectrum, float, float]:
    """Return the strongest free line of all records: spectrum, coordinate, drop."""
    best = max((s for record in found for s in record), key=lambda s: s.peak[1])
    return best, *best.peak


def unexplained_parts(
    objective: Objective, nominal: Fit, fit: Fit, after: Sequence[Sequence[LineSpectrum]]
) -> list[Unknown]:
    """Return the class and coordinate of what is left, nothing when it is noise."""
    spectrum, coordinate, chi2_reduction = strongest_line(after)
    excess = fit.cost - objective.expected_cost
    if fit.hypotheses and excess < 0.02 * (nominal.cost - objective.expected_cost):
        return []
    if chi2_reduction > LINE_THRESHOLD and chi2_reduction > 0.12 * excess:
        where = _coordinate(spectrum, coordinate)
        return [Unknown(kind=spectrum.kind, strength=chi2_reduction, coordinate=where)]
    pull = _pulled(objective, fit)
    if pull is not None:
        return [pull]
    if loudest(objective, fit) > LOUD:
        return [Unknown(kind="broadband", strength=excess, coordinate={})]
    return _coupled(objective, fit)


def loudest(objective: Objective, fit: Fit) -> float:
    """Return what is left over noise, as power, in the channel where it is most.

    Coarse words do not count: the noise of a word depends on how it happens to be passed.
    """
    found = [
        float(np.mean(row**2))
        for noise, part in zip(objective.noise, objective.split(fit.residual), strict=True)
        for row in part[noise.analogue]
    ]
    return max(found)


def _coordinate(spectrum: LineSpectrum, at: float) -> dict[str, float | str]:
    if spectrum.kind == "time":
        return {"frequency_Hz": at}
    if spectrum.kind == "travel":
        return {"wavenumber_1_m": at, "equivalent_radius_m": 1.0 / (2.0 * np.pi * at)}
    return {"roll": spectrum.roll, "order": at}


def _coupled(objective: Objective, fit: Fit) -> list[Unknown]:
    """Return a broadband unknown where channels are coupled otherwise than by their noise.

    Not beside free terms: what they leave of a line is coupled as the line is.
    """
    if any(terms is not None for terms in objective.basis):
        return []
    pair = oddest_coupling(objective, fit)
    if pair.score <= COUPLED:
        return []
    where: dict[str, float | str] = {
        "channels": " and ".join(pair.channels),
        "from_Hz": pair.from_Hz,
        "to_Hz": pair.to_Hz,
    }
    return [Unknown(kind="broadband", strength=pair.score, coordinate=where)]


def _pulled(objective: Objective, fit: Fit) -> Unknown | None:
    """Return a state-dependent unknown when declared numbers are pulled beyond tolerance."""
    found = joint_conflict(objective, fit)
    if found is None:
        return None
    name, z, strength = found
    where: dict[str, float | str] = {"declared": name, "standard_deviations": z}
    return Unknown(kind="state", strength=strength, coordinate=where)
