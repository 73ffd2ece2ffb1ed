"""A number from data, with the interval that holds the truth 95 times in 100."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array

CONFIDENCE = 0.95


class UndecidableError(PlantError):
    """The record cannot tell the parameter; the message says why and what to record instead."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A parameter with its 95 % confidence interval, all in ``unit``."""

    name: str
    value: float
    low: float
    high: float
    unit: str

    def covers(self, truth: float) -> bool:
        """Return whether the interval holds ``truth``."""
        return self.low <= truth <= self.high

    def text(self) -> str:
        """Return one line for a terminal."""
        return (
            f"{self.name} = {self.value:.6g} {self.unit} (95 %: {self.low:.6g} .. {self.high:.6g})"
        )


def estimate(
    name: str, value: float, standard_error: float, freedom: float, unit: str
) -> Estimate:
    """Return the estimate with Student's interval for ``freedom`` degrees of freedom."""
    half = float(stdtrit(freedom, 0.5 + 0.5 * CONFIDENCE)) * standard_error
    return Estimate(name=name, value=value, low=value - half, high=value + half, unit=unit)


def block_standard_error(samples: Array, blocks: int = 20) -> float:
    """Return the standard error of the mean of a stationary series, from means of blocks.

    Blocks longer than the memory of the series keep the error honest under ripple and filters.

    Raises
    ------
    UndecidableError
        When there are fewer than four samples to a block.
    """
    size = samples.size // blocks
    if size < 4:
        raise UndecidableError(
            f"{samples.size} samples are too few for an error: record at least {4 * blocks}"
        )
    means = samples[: size * blocks].reshape(blocks, size).mean(axis=1)
    return float(np.std(means, ddof=1) / np.sqrt(blocks))
