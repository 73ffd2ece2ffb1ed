"""What the law would send if there were no limit, and what each part of it is worth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from aff_runtime.core.shape.basis import ShapeBasis

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]
FADED = 0.05  # of the largest b: the signal still answers to what has faded since


@dataclass(frozen=True, slots=True)
class Wish:
    """What the law would send without a limit, (columns,) each.

    Attributes
    ----------
    parts : terms of the output now, output units.
    carrier : e^{j n theta} where the output acts.
    worth : squared signal per squared output of each column.
    omega_rad_s : speed of each column's roll.
    learning_1_s : slew of the weights that move, output units per second, the sum.
    """

    parts: Complexes
    carrier: Complexes
    worth: Floats
    omega_rad_s: Floats
    learning_1_s: float


def wish_of(
    basis: ShapeBasis, weight_m: Complexes, step_1_s: Floats, share: Floats, signal_per_m: Floats
) -> Wish:
    """Return the wish of weights (m) that move by ``step_1_s`` (m/s), by their shares.

    ``signal_per_m`` is |P b| of each column by the assumed P. What was learned of P is left out:
    in a column that is all but quiet only the sum of disturbance and correction is seen, and its
    share in P wanders.
    """
    size = np.abs(basis.b)
    gain = signal_per_m / np.maximum(size, FADED * float(size.max()))
    return Wish(
        parts=weight_m * share * basis.b,
        carrier=basis.carrier,
        worth=gain * gain,
        omega_rad_s=basis.omega_rad_s,
        learning_1_s=float((step_1_s * share) @ size),
    )
