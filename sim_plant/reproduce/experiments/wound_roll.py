"""(4.38), (4.39): centre of gravity and inertia of an out-of-round roll, two ways."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.integrate import quad

from sim_plant.base.arrays import Array
from sim_plant.geometry.shapes import eccentric, ellipse
from sim_plant.geometry.wound_mass import WoundMass, wound_mass
from sim_plant.reproduce.drawing import Panel, draw
from sim_plant.reproduce.entry import Disagreement, Experiment, Result, row_of_claim

Profile = Callable[[float], float]
CORE_M, DENSITY, WIDTH_M, RADIUS_M, OFFSET_M = 0.04445, 395.0, 0.1524, 0.2032, 0.003


def polar_ellipse(phi: float) -> float:
    """Return r of an ellipse of 206.2 x 200.2 mm."""
    return float(0.2062 * 0.2002 / np.hypot(0.2002 * np.cos(phi), 0.2062 * np.sin(phi)))


def polar_offset(phi: float) -> float:
    """Return r of a circle whose centre lies 3 mm off the rotation centre."""
    return float(OFFSET_M * np.cos(phi) + np.sqrt(RADIUS_M**2 - (OFFSET_M * np.sin(phi)) ** 2))


def polar_mass(radius: Profile) -> tuple[float, float, float]:
    """Return mass, offset and inertia by (4.38), (4.39) in polar form with the width put in."""

    def integral(power: int, weight: Profile) -> float:
        value, _ = quad(
            lambda phi: weight(phi) * radius(phi) ** power,
            0.0,
            2.0 * np.pi,
            epsabs=1e-15,
            epsrel=1e-13,
            limit=200,
        )
        return float(value)

    per_area = DENSITY * WIDTH_M
    mass = per_area * (0.5 * integral(2, lambda _phi: 1.0) - np.pi * CORE_M**2)
    first = complex(integral(3, math.cos), integral(3, math.sin)) / 3.0 * per_area
    inertia = per_area * (0.25 * integral(4, lambda _phi: 1.0) - 0.5 * np.pi * CORE_M**4)
    return mass, abs(first) / mass, inertia


def run() -> Result:
    """Compare polar integrals with the integrals along the support function."""
    shapes = (
        ("ellipse", polar_ellipse, ellipse(0.2062, 0.2002)),
        ("off-centre circle", polar_offset, eccentric(RADIUS_M, OFFSET_M)),
    )
    gaps, rows, panels = [], [], []
    for name, radius, shape in shapes:
        ours: WoundMass = wound_mass(
            shape, core_radius_m=CORE_M, density_kg_m3=DENSITY, width_m=WIDTH_M
        )
        mass, offset, inertia = polar_mass(radius)
        gaps += [
            Disagreement(
                what=f"{name}: {what}",
                first="polar integral",
                second="support integral",
                difference=abs(a - b),
                unit=unit,
                limit=limit,
            )
            for what, a, b, unit, limit in (
                ("mass", mass, ours.mass_kg, "kg", 1e-8),
                ("centre of gravity", offset, ours.offset_m, "m", 1e-8),
                ("inertia", inertia, ours.inertia_kg_m2, "kg m2", 1e-8),
            )
        ]
        rows.append(
            row_of_claim(
                f"{name}: inertia",
                "(4.39)",
                ours.inertia_kg_m2,
                "kg m2",
                abs(inertia - ours.inertia_kg_m2) < 1e-8,
                f"mass {ours.mass_kg:.4f} kg, centre of gravity {1e3 * ours.offset_m:.4f} mm",
            )
        )
        phi = np.linspace(0.0, 2.0 * np.pi, 400)
        outline: Array = np.array([radius(float(p)) for p in phi])
        panels.append(
            Panel(
                curves={name: (outline * np.cos(phi), outline * np.sin(phi))},
                x="x [m]",
                y="y [m]",
                equal=True,
                title=name,
            )
        )
    mass, offset, _ = polar_mass(polar_offset)
    rows.append(
        row_of_claim(
            "off-centre circle: offset from (4.38) as printed, without width",
            "x_bar = integral over rho dA / m",
            offset / WIDTH_M,
            "m",
            abs(offset / WIDTH_M - OFFSET_M) < 1e-4,
            "m holds the width, the integral does not; C_G and C_R are interchanged before it",
        )
    )
    solid = offset * mass / (DENSITY * WIDTH_M * np.pi * RADIUS_M**2)
    gaps.append(
        Disagreement(
            what="offset of the solid off-centre circle",
            first="polar integral",
            second="its eccentricity",
            difference=abs(solid - OFFSET_M),
            unit="m",
            limit=1e-8,
        )
    )
    return Result(rows=tuple(rows), disagreements=tuple(gaps), figures=(draw(panels),))


EXPERIMENTS = (
    Experiment(
        identity="4.38",
        chapter=4,
        title="Centre of gravity and inertia of the roll",
        where="(4.38), (4.39)",
        run=run,
    ),
)
