"""What a line may begin a record with otherwise than at rest: integrals of drives, web in zones.

Two drives that grip the web close to each other, as those of an S-wrap, hold torque against each
other: the stiff web between them lets either change its speed only slowly, whatever its loop asks.
What a probe, a ramp or a step left there is seen in the tension behind them for half a minute
(Euclid line, 0.62 m/s: 0.1 N after 30 s, ADR 0038).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Literal

from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.rest.start import add_torque
from sim_plant.line.running.simulation import LineSimulation
from sim_plant.refine.criteria.criteria import CRITERIA


@dataclass(frozen=True, slots=True, kw_only=True)
class StartOffset:
    """One number that a line begins with otherwise than at rest.

    Attributes
    ----------
    roller : a driven one.
    of : ``drive``: the integral of its drive holds more torque, by ``tension_N`` times its radius;
        ``zone``: the strain of each span from it to the next driven one is higher by
        ``tension_N`` / EA.
    tension_N : how much.
    """

    roller: str
    of: Literal["drive", "zone"]
    tension_N: float

    def put(self, line: LineSimulation) -> None:
        """Put the offset on a line that has settled."""
        p, lay, state = line.arrays, line.layout, line.state
        if self.of == "drive":
            add_torque(p, lay, state, line.drive_index(self.roller), self.tension_N)
            return
        first, last = next(z for z in _zones(line.declaration) if z[0] == self.roller)
        body = line.declaration.body
        spans = slice(body(first), body(last))
        strain = lay.strain + body(first), lay.strain + body(last)
        state.y[slice(*strain)] += self.tension_N / p.spans["EA_N"][spans]


def start_offsets(line: Declaration) -> tuple[StartOffset, ...]:
    """Return every number that the line may begin with otherwise, at a size to be simulated."""
    size_N = CRITERIA.model.start_offset_share * line.operating_point.tension_N
    drives = [
        StartOffset(roller=drive.roller, of="drive", tension_N=size_N)
        for drive in line.control.drives
    ]
    zones = [StartOffset(roller=first, of="zone", tension_N=size_N) for first, _ in _zones(line)]
    return (*drives, *zones)


def _zones(line: Declaration) -> list[tuple[str, str]]:
    """Return the driven rollers at both ends of every zone, in the web's order."""
    driven = sorted((drive.roller for drive in line.control.drives), key=line.body)
    return list(itertools.pairwise(driven))
