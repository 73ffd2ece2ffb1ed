"""Step 10: with every order on, none is held, and what each costs."""

from __future__ import annotations

import math
from collections.abc import Iterator

from aff_runtime.app.card.evidence import Evidence
from aff_runtime.app.card.figures import NAN, Figure, StepResult
from aff_runtime.app.report.block_status import WORDS, BlockStatus
from aff_runtime.base.signals import State
from aff_runtime.core.monitor import OrderState

HELD = frozenset(
    WORDS[state] for state in (OrderState.HELD_PHASE, OrderState.HELD_FREQUENCY, OrderState.RISING)
)


def measure(evidence: Evidence) -> StepResult:
    """Return how many orders are held, and per order its reduction and its cost."""
    blocks = evidence.blocks
    held = [one for one in blocks if one.state in HELD]
    missing = [] if blocks else ["no order is computed: arm, and wait until they have settled"]
    is_on = bool(blocks) and evidence.state == State.ACTIVE.name
    if blocks and not is_on:
        missing.append(f"the correction is not on: the service is {evidence.state or 'not there'}")
    count = Figure(
        name=f"orders held, of {len(blocks)}",
        value=float(len(held)) if is_on else NAN,
        limit="0",
        good=not held if is_on else None,
    )
    return StepResult(
        figures=(count, *(figure for one in blocks for figure in _of(one))),
        missing=tuple(missing),
        remarks=tuple(f"{one.actuator} {one.name}: {one.state}, {one.why}" for one in held),
    )


def _of(block: BlockStatus) -> Iterator[Figure]:
    """Yield reduction and cost of an order: amplitude of its correction per ripple taken off."""
    name = f"{block.actuator} {block.name}"
    if block.benefit_dB is not None:
        yield Figure(
            name=f"{name}: reduction, as the law sees it", value=block.benefit_dB, unit="dB"
        )
    before, now, size = block.ripple_before, block.ripple, block.amplitude
    if before is None or now is None or size is None or not before > now:
        return
    factor, unit = (1e3, "mm/s") if block.unit == "m/s" else (1.0, block.unit)
    cost = factor * size / (before - now)
    if math.isfinite(cost):
        yield Figure(name=f"{name}: cost", value=cost, unit=f"{unit} per {block.ripple_unit}")
