"""A shape that a law may start from: at the law's angle origin, and what became of it in words."""

from __future__ import annotations

import cmath
import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from aff_runtime.app.wiring.shape_file import ShapeFile
from aff_runtime.core.controller import RollPhases
from aff_runtime.core.shape.law import ShapeLaw
from aff_runtime.core.shape.trial import Fit

PerOrder = Mapping[tuple[str, int], complex]


@dataclass(slots=True, kw_only=True)
class KnownShape:
    """One shape from elsewhere: where from, the deviations, what was learned of P.

    ``response_ratio_less_1`` : of each order, as it was learned.
    """

    source: str
    weight_m: PerOrder
    response_ratio_less_1: PerOrder
    imbalance_m: Mapping[str, complex] = field(default_factory=dict)
    file: ShapeFile | None = None

    def forget(self, rolls: Collection[str]) -> None:
        """Drop the deviations of some rolls; what was learned of P stays."""
        self.weight_m = {key: w for key, w in self.weight_m.items() if key[0] not in rolls}


def at_origin(
    law: ShapeLaw, roll: str, known: KnownShape, phases: RollPhases
) -> tuple[np.ndarray[Any, np.dtype[np.complex128]], np.ndarray[Any, np.dtype[np.complex128]]]:
    """Return a roll's deviations, m, and response ratios less 1 at the law's angle origin."""
    origin = phases.by_name[roll].origin_rad
    origin = origin if math.isfinite(origin) else 0.0
    weight = np.zeros(len(law.keys), dtype=np.complex128)
    response_ratio_less_1 = np.zeros(len(law.keys), dtype=np.complex128)
    for i, key in enumerate(law.keys):
        if key[0] == roll:
            weight[i] = known.weight_m.get(key, 0j) * cmath.exp(-1j * key[1] * origin)
            response_ratio_less_1[i] = known.response_ratio_less_1.get(key, 0j)
    return weight, response_ratio_less_1


def imbalance_at(roll: str, known: KnownShape, phases: RollPhases) -> complex:
    """Return the imbalance column's weight at the law's angle origin; 0 without one."""
    origin = phases.by_name[roll].origin_rad
    origin = origin if math.isfinite(origin) else 0.0
    return known.imbalance_m.get(roll, 0j) * cmath.exp(-1j * origin)


def with_imbalance(
    law: ShapeLaw,
    roll: str,
    weight: np.ndarray[Any, np.dtype[np.complex128]],
    imbalance_m: complex,
) -> np.ndarray[Any, np.dtype[np.complex128]]:
    """Return deviations with order 1 as the signal sees it: shape and imbalance in one."""
    seen = law.seen()
    if not imbalance_m or (roll, 1) not in law.keys or seen.size == len(law.keys):
        return weight
    first = law.keys.index((roll, 1))
    both = weight.copy()
    if abs(seen[first]) > 0.0:
        both[first] += imbalance_m * seen[-1] / seen[first]
    return both


def trial_words(source: str, fit: Fit) -> str:
    """Return what became of a shape in a trial, as a sentence."""
    if math.isnan(fit.agreement):
        return f"starts from {source}; there is no ripple to try it on"
    agreement = f"agreement {fit.agreement:.2f}, size {fit.ratio:.2f}"
    if not fit.fits:
        return f"{source} is not used: the ripple is another ({agreement}); learned anew"
    turned = math.degrees(fit.turned_rad)
    moved = f", turned by {turned:.0f} deg: the encoder's origin has moved" if turned else ""
    return f"starts from {source} ({agreement}{moved})"
