"""From a traced effect to the deviations a shape law may start from."""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.geometry.shapes import MAX_ORDER, Shape
from sim_plant.geometry.tangent import Body, common_tangent
from sim_plant.line.arrays.build import build_arrays, timing_of
from sim_plant.line.arrays.with_effects import apply_effects
from sim_plant.line.declared.declaration import Declaration, EffectEntry
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.records.recording import Recording

REPORT = CRITERIA.report


@dataclass(frozen=True, slots=True, kw_only=True)
class StartValue:
    """What law shape may begin an order from: amplitude of the moment arm and its angle."""

    order: int
    deviation_m: float
    angle_rad: float


def start_values(
    declaration: Declaration,
    effects: Sequence[EffectEntry],
    roller: str,
    orders: Sequence[int],
    record: Recording | None,
) -> list[StartValue]:
    """Return the start values of an AFF block.

    The moment arm of the leaving span over one turn, p = R + Re sum W_n e^{j n theta}, from the
    exact tangent; theta is what the roll's angle channel shows. Effects count angles from the
    record's first row; where the record has the channel its first value is taken off, else zero
    stands in and the runtime finds the angle when it tries the shape.
    Orders below a micrometre are left out; a roller without a leaving span gives nothing.
    """
    arm_m = moment_arm_m(declaration, effects, roller)
    if arm_m is None:
        return []
    spectrum = np.fft.rfft(arm_m) * (2.0 / arm_m.size)
    first_rad = 0.0
    if record is not None and f"{roller}_angle_rad" in record.columns:
        name = f"{roller}_angle_rad"
        first_rad = float(record.columns[name][0]) + record.zeros_rad.get(name, 0.0)
    rows = []
    for order in orders:
        w = complex(spectrum[order]) * cmath.exp(-1j * order * first_rad)
        if abs(w) >= REPORT.smallest_start_m:
            rows.append(
                StartValue(
                    order=int(order),
                    deviation_m=float(f"{abs(w):.5g}"),
                    angle_rad=float(f"{cmath.phase(w):.5f}"),
                )
            )
    return rows


def moment_arm_m(
    declaration: Declaration, effects: Sequence[EffectEntry], roller: str
) -> Array | None:
    """Return p(theta) of the span that leaves ``roller`` (angles,), m; None without one."""
    names = [r.name for r in declaration.rollers]
    leaving = next((s for s in declaration.spans if s.start == roller), None)
    if leaving is None or roller not in names:
        return None
    timing = timing_of(declaration, declaration.sample_time_s)
    arrays = apply_effects(declaration, build_arrays(declaration, timing, 1), effects)
    bodies = []
    for name in (roller, leaving.end):
        at = names.index(name)
        entry, row = declaration.rollers[at], int(arrays.bodies["shape_row"][at])
        radius_m = float(arrays.bodies["radius_m"][at])
        shape = Shape(mean_radius_m=radius_m, deviation_m=np.zeros(1, dtype=np.complex128))
        if row >= 0 and name == roller:
            support_m = np.asarray(arrays.shape_h_m[row])[:-1]
            found = np.fft.rfft(support_m) * (2.0 / support_m.size)
            shape = Shape(mean_radius_m=radius_m, deviation_m=found[1 : MAX_ORDER + 1])
        bodies.append(
            Body(
                center_x_m=entry.center_x_m,
                center_y_m=entry.center_y_m,
                rotation=1 if entry.rotation == "ccw" else -1,
                shape=shape,
            )
        )
    theta = np.linspace(0.0, 2.0 * np.pi, REPORT.start_points, endpoint=False)
    try:
        return np.asarray(common_tangent(bodies[0], bodies[1], theta, 0.0).arm_a_m)
    except PlantError:
        return None
