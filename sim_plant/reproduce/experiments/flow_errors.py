"""(4.42)-(4.50): what the flow formulas miss, harmonic by harmonic, against a closed form."""

from __future__ import annotations

import numpy as np

from sim_plant.geometry.roll_profiles import flat_spot
from sim_plant.geometry.shapes import Shape, eccentric, ellipse
from sim_plant.reproduce.drawing import bars
from sim_plant.reproduce.entry import Disagreement, Experiment, Result, beyond, row_of_claim
from sim_plant.reproduce.euclid import INCH_M
from sim_plant.reproduce.experiments.supply import supply_of

IDLER_M = 1.5 * INCH_M
ORDERS = (1, 2, 3, 4)


def run() -> Result:
    """Compare (4.46) with the exact identity and with n R_B / L."""
    cases: tuple[tuple[str, Shape, float], ...] = (
        ("flat 12 mm, L 1.2 m", flat_spot(0.012, 8.0 * INCH_M), 1.2),
        ("flat 12 mm, L 0.4 m", flat_spot(0.012, 8.0 * INCH_M), 0.4),
        ("eccentric 6.05 in, L 0.9 m", eccentric(6.05 * INCH_M, 5e-4), 0.9),
    )
    rows, gaps, groups = [], [], {}
    for name, shape, length in cases:
        supply = supply_of(shape, IDLER_M, length)
        orders = (1,) if name.startswith("ecc") else ORDERS
        found = [supply.harmonic_error(supply.arc_length, n) for n in orders]
        closed = [n * IDLER_M / length for n in orders]
        gaps.append(
            Disagreement(
                what=f"{name}: relative error of (4.46), H1-H{orders[-1]}",
                first="exact tangent",
                second="n R_B / L",
                difference=float(np.max(np.abs(np.array(found) - closed))),
                unit="-",
                limit=5e-3,
            )
        )
        groups[name] = [100.0 * e for e in found] + [0.0] * (4 - len(found))
        rows.append(
            row_of_claim(
                f"{name}: error of (4.46), first harmonic",
                "appropriate",
                100.0 * found[0],
                "%",
                found[0] < 0.01,
                "the contact point on the next roller wanders: R_B dphi/dt",
            )
        )
    flat = supply_of(cases[0][1], IDLER_M, 1.2)
    oval = supply_of(ellipse(0.2062, 0.2002), IDLER_M, 0.9)
    rows += [
        row_of_claim(
            "flat 12 mm: error of peripheral speed with dL/dt",
            "wrong (section 4.4)",
            100.0 * flat.total_error(flat.peripheral),
            "%",
            flat.total_error(flat.peripheral) > 1.0,
            "the source's own finding",
        ),
        row_of_claim(
            "ellipse +-3 mm: error of peripheral speed with dL/dt",
            "wrong (section 4.4)",
            100.0 * oval.total_error(oval.peripheral),
            "%",
            oval.total_error(oval.peripheral) > 1.0,
            "the source's own finding",
        ),
        row_of_claim(
            "ellipse +-3 mm: error of (4.46), all harmonics",
            "appropriate",
            100.0 * oval.total_error(oval.arc_length),
            "%",
            oval.total_error(oval.arc_length) < 0.01,
            "second order dominates: 2 R_B / L",
        ),
        beyond(
            "flat 12 mm: d_ex over p, largest difference",
            1e3 * float(np.max(flat.exit_distance - flat.exact)),
            "mm",
            "(4.37) takes d_ex as arm of the tension",
            claim="d_ex is the arm length",
        ),
        beyond(
            "std of dl/dt over std of p",
            float(np.std(flat.flow) / np.std(flat.exact)),
            "-",
            "tables of dl/dt and dL/dt cancel each other: noise of (4.36), (4.50)",
        ),
        row_of_claim(
            "(4.50) at (0.25, 0.5), plane through (0,0,0.5), (1,0,0.75), (1,1,1)",
            "the plane's height",
            printed_plane(),
            "-",
            abs(printed_plane() - exact_plane()) < 1e-9,
            f"n.(X - P1) = 0 gives {exact_plane():.4f}; no table is needed: "
            "delta l (i, j) = S(j) - S(i)",
        ),
    ]
    return Result(
        rows=tuple(rows),
        disagreements=tuple(gaps),
        figures=(bars(groups, [f"H{n}" for n in ORDERS], "error of (4.46) [%]"),),
    )


def printed_plane() -> float:
    """Return (4.50) to the letter for P1 (0, 0, 0.5), P2 (1, 0, 0.75), P3 (1, 1, 1)."""
    p1, n = _plane()
    return float(-(0.25 * (n[0] - p1[0]) + 0.5 * (n[1] - p1[1])) / (n[2] - p1[2]))


def exact_plane() -> float:
    """Return the height of the same plane by its own equation."""
    p1, n = _plane()
    return float(p1[2] - (n[0] * (0.25 - p1[0]) + n[1] * (0.5 - p1[1])) / n[2])


def _plane() -> tuple[list[float], list[float]]:
    p1, p2, p3 = (np.array(p) for p in ([0.0, 0.0, 0.5], [1.0, 0.0, 0.75], [1.0, 1.0, 1.0]))
    return p1.tolist(), np.cross(p2 - p1, p3 - p1).tolist()


EXPERIMENTS = (
    Experiment(
        identity="4.46",
        chapter=4,
        title="Errors of the flow formulas",
        where="(4.42)-(4.50)",
        run=run,
    ),
)
