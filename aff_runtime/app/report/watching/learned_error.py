"""How far the mean of what a law has learned is off, by the law's own memory.

What a law learns wanders about its mean with the law's time constant T: neighbours within it say
the same, so parts of a stretch that are shorter do not show how far its mean is off.
"""

from __future__ import annotations

import math

import numpy as np

from aff_runtime.app.report.comparison.turns import Array
from aff_runtime.app.report.comparison.window import number
from aff_runtime.base.yaml_section import Section
from aff_runtime.config.models import Actuator
from aff_runtime.core.blocks.block import SETTLE_EXPONENT

MEMORY_TURNS: float = Actuator.model_fields["memory_turns"].default


def mean_and_error(values: Array, seconds: float, memory_s: float) -> tuple[float, float]:
    """Return the mean of readings over ``seconds``, and its standard error.

    Own derivation: with correlation exp(-t/T) over a time S, and u = S / T, the mean has
    g = (2 / u) (1 - (1 - exp(-u)) / u) of the variance s of a reading, and the mean square of the
    readings about their own mean is (1 - g) s; so the error is its root times sqrt(g / (1 - g)).
    """
    finite = values[np.isfinite(values)]
    if finite.size < 2 or not seconds > 0.0 or not memory_s > 0.0:
        return math.nan, math.nan
    times = seconds / memory_s
    of_mean = 2.0 / times * (1.0 + math.expm1(-times) / times)
    return float(finite.mean()), float(np.std(finite)) * math.sqrt(of_mean / (1.0 - of_mean))


def block_memory_s(actuator: Section, at: tuple[str, int]) -> float:
    """Return the time constant with which a block learns a roll's order, NaN without a block."""
    return number(block_of(actuator, at).get("settle_s"), "s") / SETTLE_EXPONENT


def shape_memory_s(actuator: Section, turn_s: float) -> float:
    """Return the time constant with which law shape learns on a roll with turns of ``turn_s``."""
    given = actuator.get("memory_turns")
    if isinstance(given, int | float) and given > 0.0:
        return turn_s * given
    return turn_s * MEMORY_TURNS


def block_of(actuator: Section, at: tuple[str, int]) -> Section:
    """Return the block of an actuator that has an order of a roll, empty without one."""
    roll, order = at
    blocks = actuator.get("blocks")
    for block in blocks if isinstance(blocks, list) else ():
        if not isinstance(block, dict) or block.get("roll") != roll:
            continue
        orders = block.get("orders")
        if isinstance(orders, list) and order in orders:
            return Section(block)
    return Section()
