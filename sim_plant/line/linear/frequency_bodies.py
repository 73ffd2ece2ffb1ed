"""Dancers, accumulators and warm spans in the frequency domain: rows beside those of the line.

Small signals about the steady state, written apart from the kernel. The turning of a span about
contact points that carriages move is left out of the transport of strain alone: it is a product
of two strains there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sim_plant.elements.carriage import CREEP_M_S
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.rest.operating_point import SteadyLine, declared_line
from sim_plant.line.rest.resting_bodies import (
    RestingBodies,
    SpansAtRest,
    carriage_forces,
    spans_at,
)

ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SmallBodies:
    """Where the unknowns of moving and warm parts stand, and the spans that they change.

    Attributes
    ----------
    size : unknowns in all: speeds (n), strains (n - 1), travels (g), warming of parts (h).
    travel, heat : first column of travels and of parts.
    """

    line: Declaration
    rest: SteadyLine
    bodies: RestingBodies
    spans: SpansAtRest
    s: complex
    size: int
    travel: int
    heat: int

    @classmethod
    def at(cls, line: Declaration, rest: SteadyLine, s: complex) -> SmallBodies | None:
        """Return them for a line that has some."""
        bodies = declared_line(line).bodies
        if bodies is None:
            return None
        n = rest.radius_m.size
        heat = 2 * n - 1 + bodies.carriages.size
        return cls(
            line=line,
            rest=rest,
            bodies=bodies,
            spans=spans_at(bodies, rest.radius_m, rest.travel_m),
            s=s,
            size=heat + bodies.heats.size,
            travel=2 * n - 1,
            heat=heat,
        )

    def lever(self, i: int) -> ComplexArray:
        """Return the row that takes travels to what they add to the length of span ``i``, m."""
        row = np.zeros(self.size, dtype=np.complex128)
        for k, lever, sign in (
            (i, self.spans.lever_a[i], -1.0),
            (i + 1, self.spans.lever_b[i], 1.0),
        ):
            if self.bodies.carriage[k] >= 0:
                row[self.travel + self.bodies.carriage[k]] += sign * lever
        return row

    def mean_warming(self, i: int) -> ComplexArray:
        """Return the row that takes the parts of span ``i`` to its free strain."""
        row = np.zeros(self.size, dtype=np.complex128)
        first, count = int(self.bodies.first[i]), int(self.bodies.parts[i])
        if count:
            at = self.heat + first
            row[at : at + count] = self.bodies.expansion_1_K / count
        return row

    def flow(self, i: int) -> ComplexArray:
        """Return the row that takes unknowns to v_A / L of span ``i``, 1/s."""
        radius, length = self.rest.radius_m[i], self.spans.length_m[i]
        row: ComplexArray = -self.rest.speed_m_s[i] / length**2 * self.lever(i)
        row[i] += radius / length
        return row

    def part(self, i: int, number: int) -> tuple[ComplexArray, float]:
        """Return warming at the end of a part: the row of small signals, and its value at rest.

        W_out = air + (W - air) B(a), B = a / (e^a - 1), a = L / (parts v tau).
        """
        j = int(self.bodies.first[i]) + number
        air, time_s = (float(self.bodies.heats[name][j]) for name in ("air_K", "time_s"))
        renewal = self.bodies.parts[i] * self.rest.speed_m_s[i] / self.spans.length_m[i]
        share = 1.0 / (renewal * time_s)
        grown = math.exp(share)
        kept = share / (grown - 1.0)
        slope = (grown - 1.0 - share * grown) / (grown - 1.0) ** 2
        over = float(self.rest.parts_K[j]) - air
        turned = self.bodies.parts[i] * self.flow(i)
        row = over * slope * -share / renewal * turned
        row[self.heat + j] += kept
        return row, air + over * kept

    def leaving(self, i: int) -> tuple[ComplexArray, float]:
        """Return warming at the end of span ``i``, row and value; 0 before the first warm one."""
        if i < 0 or self.bodies.parts[i] == 0:
            return np.zeros(self.size, dtype=np.complex128), 0.0
        return self.part(i, int(self.bodies.parts[i]) - 1)

    def end_strain(self, i: int) -> tuple[ComplexArray, float]:
        """Return the strain with which web leaves span ``i``, row and value; -1: the unwind's."""
        row = np.zeros(self.size, dtype=np.complex128)
        if i < 0:
            return row, self.line.web.wound_in_tension_N / self.line.web.EA_N
        row[self.rest.radius_m.size + i] = 1.0
        row += self.bodies.expansion_1_K * self.leaving(i)[0] - self.mean_warming(i)
        return row, float(self.rest.strain[i] + self.rest.warm_step[i])

    def add_span(self, A: ComplexArray, i: int) -> None:
        """Add d/dt L/(1 + eps) = v_A/(1 + eps_up) - v_B/(1 + eps_end), times -(1 + eps)."""
        radius, speed, s = self.rest.radius_m, self.rest.speed_m_s, self.s
        row, grown = radius.size + i, 1.0 + float(self.rest.strain[i])
        upstream, before = self.end_strain(i - 1)
        end, after = self.end_strain(i)
        A[row, row] += self.spans.length_m[i] * s / grown
        A[row] -= s * self.lever(i)
        A[row, i + 1] -= grown * radius[i + 1] / (1.0 + after)
        A[row] += grown * speed[i + 1] / (1.0 + after) ** 2 * end
        A[row, i] += grown * radius[i] / (1.0 + before)
        A[row] -= grown * speed[i] / (1.0 + before) ** 2 * upstream

    def add_heat(self, A: ComplexArray) -> None:
        """Add s W = n v/L (W_in - W_out) - W / tau of every part."""
        for i, count in enumerate(self.bodies.parts):
            entering, value = self.leaving(i - 1)
            for number in range(count):
                j = int(self.bodies.first[i]) + number
                row = self.heat + j
                leaving, at_end = self.part(i, number)
                renewal = count * self.rest.speed_m_s[i] / self.spans.length_m[i]
                A[row, row] += self.s + 1.0 / float(self.bodies.heats["time_s"][j])
                A[row] -= renewal * (entering - leaving)
                A[row] -= count * self.flow(i) * (value - at_end)
                entering, value = leaving, at_end

    def add_carriages(self, A: ComplexArray, tensions: ComplexArray) -> None:
        """Add M s2 q + (c + friction's slope) s q - dF/dq q + sum(T lever) = 0."""
        web, rest, s = self.line.web, self.rest, self.s
        pull_N = web.EA_N * (rest.strain - rest.warm_strain)
        step_m, tick = 1e-6, self.line.control.drive_sample_time_s
        shift = 1.0 - np.exp(-s * tick)
        for c, carriage in enumerate(self.bodies.carriages):
            row, mass = self.travel + c, float(carriage["mass_kg"])
            slope = float(carriage["damping_N_s_m"] + carriage["friction_N"] / CREEP_M_S)
            gain = float(carriage["gain_rad_s"])
            if gain > 0.0:
                corner = gain / (4.0 * float(carriage["drive_damping"]) ** 2)
                law = mass * gain * (1.0 + corner * tick / shift)
                slope = slope + law * shift / (s * tick)
            A[row, row] += mass * s * s + slope * s
            for d in range(self.bodies.carriages.size):
                moved = np.zeros((2, rest.travel_m.size))
                moved[:, d] = (step_m, -step_m)
                force = carriage_forces(self.bodies, rest.radius_m, rest.travel_m + moved, pull_N)
                A[row, self.travel + d] -= (force[0, c] - force[1, c]) / (2.0 * step_m)
            for i in range(tensions.shape[0]):
                A[row] += self.lever(i)[row] * tensions[i]

    def travel_row(self, carriage: int) -> ComplexArray:
        """Return the row that takes the unknowns to a travel, m."""
        row = np.zeros(self.size, dtype=np.complex128)
        row[self.travel + carriage] = 1.0
        return row


def tension_rows(line: Declaration, s: complex, more: SmallBodies | None) -> ComplexArray:
    """Return the rows that take the unknowns to every tension, N (n - 1, unknowns).

    T = EA (1 + eta s) (eps - free), Hooke with Kelvin-Voigt damping.
    """
    n = len(line.rollers)
    pull = line.web.EA_N * (1.0 + line.web.kelvin_voigt_eta_s * s)
    found = np.zeros((n - 1, 2 * n - 1 if more is None else more.size), dtype=np.complex128)
    found[:, n : 2 * n - 1] = pull * np.eye(n - 1)
    if more is not None:
        for i in range(n - 1):
            found[i] -= pull * more.mean_warming(i)
    return found
