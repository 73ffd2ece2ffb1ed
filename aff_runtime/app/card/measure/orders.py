"""Step 10: with every order on, none is held whose ripple shows, and what each costs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from aff_runtime.app.card.evidence import Evidence
from aff_runtime.app.card.figures import NAN, Figure, StepResult
from aff_runtime.app.card.measure.proof import RISE_SHARE, TURNS
from aff_runtime.app.report.block_status import WORDS, BlockStatus
from aff_runtime.app.report.comparison.comparing import estimates
from aff_runtime.app.report.comparison.turns import Estimate
from aff_runtime.app.report.comparison.window import Window, roll_angle
from aff_runtime.base.signals import State
from aff_runtime.core.monitor import OrderState

HELD = frozenset(
    WORDS[state] for state in (OrderState.HELD_PHASE, OrderState.HELD_FREQUENCY, OrderState.RISING)
)
LIMIT = f"in the noise, or at most {100.0 * RISE_SHARE:.0f} % of all"
"""Of a held order's ripple: nothing goes out for it, so it is what it is with the correction off.
As much as an order may rise in step 12 (``RISE_SHARE``): by so little none is seen in the
tension."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Held:
    """An order that is held, with its ripple in the record; None where that cannot be told."""

    block: BlockStatus
    ripple: Estimate | None

    @property
    def is_told(self) -> bool:
        """Whether its ripple rests on enough turns."""
        return self.ripple is not None and self.ripple.turns >= TURNS

    @property
    def size(self) -> float:
        """Its ripple where it stands out of the noise, else 0."""
        return self.ripple.amplitude if self.ripple and self.ripple.stands_out else 0.0


def measure(evidence: Evidence) -> StepResult:
    """Return of each held order the ripple that it leaves, and of all reduction and cost."""
    blocks = evidence.blocks
    missing = [] if blocks else ["no order is computed: arm, and wait until they have settled"]
    is_on = bool(blocks) and evidence.state == State.ACTIVE.name
    if blocks and not is_on:
        missing.append(f"the correction is not on: the service is {evidence.state or 'not there'}")
    held = [_Held(block=one, ripple=_ripple(one, evidence)) for one in blocks if one.state in HELD]
    figures = [_left(one, _together(one.block.actuator, blocks, held)) for one in held]
    cost = [one for one in figures if one.good is False]
    missing.extend(map(_untold, (one for one in held if not one.is_told)))
    count = Figure(
        name=f"orders held that leave ripple, of {len(blocks)}",
        value=float(len(cost)) if is_on else NAN,
        limit="0",
        good=not cost if is_on else None,
    )
    return StepResult(
        figures=(count, *figures, *(figure for one in blocks for figure in _of(one))),
        missing=tuple(missing),
        remarks=tuple(f"{_name(one.block)}: {one.block.state}, {one.block.why}" for one in held),
    )


def _name(block: BlockStatus) -> str:
    return f"{block.actuator} {block.name}"


def _ripple(block: BlockStatus, evidence: Evidence) -> Estimate | None:
    """Return the amplitude of an order in the record; None where it cannot be followed there."""
    actuator = evidence.site.actuators.get(block.actuator)
    if actuator is None or not evidence.windows:
        return None
    window: Window = evidence.window
    angle = roll_angle(window, window.section("rolls").section(block.roll))
    values = window.readings(actuator.error.signal)
    if angle is None or values is None:
        return None
    return estimates(angle, values, window, [block.order]).get(block.order, (None, NAN))[0]


def _together(actuator: str, blocks: Sequence[BlockStatus], held: Sequence[_Held]) -> float:
    """Return the ripple of an actuator's orders together without correction: the root of the sum.

    Of those that are held as the record has it, of the others as the law knows it.
    """
    of_held = [one.size for one in held if one.block.actuator == actuator]
    known = [
        one.ripple_before
        for one in blocks
        if one.actuator == actuator and one.state not in HELD and one.ripple_before is not None
    ]
    return math.hypot(*of_held, *known)


def _left(one: _Held, together: float) -> Figure:
    """Return the ripple that a held order leaves; needed, as it may be what the web shows."""
    found = one.ripple if one.is_told else None
    noise = found is not None and not found.stands_out
    name = f"{_name(one.block)}: held, its ripple"
    if found is None:
        return Figure(name=name, value=NAN, unit=one.block.ripple_unit, limit=LIMIT)
    return Figure(
        name=f"{name}{' (at most: in the noise)' if noise else ''}",
        value=found.floor if noise else found.amplitude,
        unit=one.block.ripple_unit,
        low=NAN if noise else found.low,
        high=NAN if noise else found.high,
        limit=f"{LIMIT} ({together:.3g} {one.block.ripple_unit})",
        good=noise or found.amplitude <= RISE_SHARE * together,
    )


def _untold(one: _Held) -> str:
    turns = one.ripple.turns if one.ripple is not None else 0
    if one.ripple is None:
        return (
            f"{_name(one.block)}: held, and the record does not show its ripple (too few samples "
            "per period, or no angle): slow the line down, or take it out of `orders`"
        )
    return f"{_name(one.block)}: held, {turns} whole turns in the record, {TURNS} are needed"


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
