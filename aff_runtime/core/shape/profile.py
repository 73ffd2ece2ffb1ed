"""Shapes that a law has learned, or that it may start from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapeProfile:
    """Shapes of rolls: W by (roll, order), m, at the roll angle's zero; d likewise, a number.

    ``weight_m`` is the complex deviation of the moment arm, arm = R + Re sum W e^{j n theta};
    ``response_ratio_less_1`` is the learned d, true P = (1 + d) times the assumed; it may lack.
    ``imbalance_m`` is the weight of a roll's imbalance column, 100 N m per m, where there is one.
    """

    weight_m: Mapping[tuple[str, int], complex]
    response_ratio_less_1: Mapping[tuple[str, int], complex]
    imbalance_m: Mapping[str, complex] = field(default_factory=dict)
