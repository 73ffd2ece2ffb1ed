"""What goes out: the sum of all orders with its bounds."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from aff_runtime.base.signals import ActuatorStep
from aff_runtime.core.compiled.binary import chosen, holding
from aff_runtime.core.shape.basis import ShapeBasis
from aff_runtime.core.shape.bounds import PeakBound

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]


class Sending:
    """Sums weight times b over the columns, by factor and shares, and bounds value and slew.

    Parameters
    ----------
    basis, bounds : of the same columns.
    weight_m : what the law has learned, (columns,).
    factor : complex, what of each the limit leaves, (columns,).
    sent_m : written: what goes out of each weight, (columns,).
    step_1_s : how fast each weight moves now, m/s, (columns,).
    shares : three of 0..1, (columns,) each.
    """

    __slots__ = (
        "_basis",
        "_bounds",
        "_compiled",
        "_factor",
        "_held",
        "_parts",
        "_sent_m",
        "_shares",
        "_step_1_s",
        "_weight_m",
    )

    def __init__(
        self,
        basis: ShapeBasis,
        bounds: PeakBound,
        *,
        weight_m: Complexes,
        factor: Complexes,
        sent_m: Complexes,
        step_1_s: Floats,
        shares: Sequence[Floats],
    ) -> None:
        self._basis, self._bounds = basis, bounds
        self._weight_m, self._sent_m, self._step_1_s = weight_m, sent_m, step_1_s
        self._factor = factor
        self._shares = tuple(shares)
        self._parts = np.zeros(weight_m.size, dtype=np.complex128)
        self._compiled = chosen()
        self._held = holding(
            *(weight_m, basis.b, basis.carrier, factor, *self._shares, step_1_s, basis.order),
            *(sent_m, self._parts, *bounds.quarter),
        )

    def step(self, gate: float, ramp_s: float) -> ActuatorStep:
        """Return what goes out now; ``ramp_s``: time of a share from 0 to 1, 0 when none moves."""
        if self._compiled is not None:
            omega_rad_s, slack, at = self._basis.omega_rad_s, self._bounds.slack, self._bounds.at
            return self._compiled.send(
                self._held, ActuatorStep, omega_rad_s, gate, ramp_s, slack, at
            )
        basis, weight_m = self._basis, self._weight_m
        sent, parts, b = self._sent_m, self._parts, basis.b
        np.multiply(weight_m, self._factor, out=sent)
        sent *= gate
        for share in self._shares:
            sent *= share
        np.multiply(sent, b, out=parts)
        value = float(parts.real.sum())
        peak, slew = self._bounds.of(parts, basis.carrier, basis.omega_rad_s)
        # a weight that moves moves the output by no more than its shares
        slew += float((self._step_1_s * math.prod(self._shares)) @ np.abs(b))
        if ramp_s > 0.0:
            slew += float(np.abs(weight_m * b).sum()) / ramp_s
        return ActuatorStep(value=value, peak_bound=max(peak, abs(value)), slew_bound=slew)
