"""One block of a bank, with its roll, its monitor and what is known of it now."""

from __future__ import annotations

import math
from collections.abc import Mapping

from aff_runtime.core.blocks.block import HarmonicBlock
from aff_runtime.core.monitor import OrderMonitor
from aff_runtime.core.phase import RollPhase


class Slot:
    """One block with its roll, its monitor and what is known about its present frequency.

    Attributes
    ----------
    at : index of its roll among those of the bank.
    response : P at the order's frequency, high-pass of the residual included.
    passed : what that high-pass lets through of the order, its size.
    bound_rad : of the error of P's phase.
    rate_1_s, share : adaptation rate lam, and how much of it the blocks that it meets leave, 0..1.
    scale : factor from weight to output: the roll's speed, or 1.
    fade : share of the output that goes out by its frequency, 0..1.
    """

    __slots__ = (
        "at",
        "block",
        "bound_rad",
        "fade",
        "monitor",
        "passed",
        "phase",
        "rate_1_s",
        "response",
        "roll",
        "scale",
        "share",
    )

    def __init__(
        self, roll: str, at: int, phases: Mapping[str, RollPhase], block: HarmonicBlock
    ) -> None:
        self.roll = roll
        self.at = at
        self.phase = phases[roll]
        self.block = block
        self.monitor = OrderMonitor()
        self.response = 0j
        self.passed = 1.0
        self.bound_rad = math.pi
        self.rate_1_s = 0.0
        self.share = 0.0
        self.scale = 1.0
        self.fade = 0.0

    @property
    def omega_rad_s(self) -> float:
        """How fast the order's angle turns, rad/s."""
        return self.block.order * self.phase.omega_rad_s

    @property
    def name(self) -> str:
        """Roll and order, as in the record."""
        return f"{self.roll}_{self.block.order}x"

    @property
    def phase_deg(self) -> float:
        """Angle of the weight, deg."""
        return math.degrees(math.atan2(self.block.weight.imag, self.block.weight.real))
