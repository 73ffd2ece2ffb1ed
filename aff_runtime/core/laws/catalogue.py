"""The laws that a site file can name: one row each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from aff_runtime.core.blocks.bank import Bank, BlockKind
from aff_runtime.core.blocks.block import HarmonicBlock
from aff_runtime.core.impulse import from_response
from aff_runtime.core.law import ActuatorLaw, LawBuilder, LawSetup
from aff_runtime.core.laws.iterative import IterativeBlock
from aff_runtime.core.shape.law import ShapeLaw


def in_blocks(block: BlockKind) -> LawBuilder:
    """Return the builder of a law that is a bank of this kind of block."""

    def build(setup: LawSetup) -> ActuatorLaw:
        return Bank(
            setup.params,
            phases=setup.phases,
            response=setup.response,
            cycle_s=setup.cycle_s,
            block=block,
        )

    return build


PLAIN = in_blocks(HarmonicBlock)


def _shape(setup: LawSetup) -> ActuatorLaw:
    params, response = setup.params, setup.response
    if params.drive is None or response is None:
        return PLAIN(setup)  # the plain blocks stand in
    loop = setup.loop or from_response(
        response, cycle_s=setup.cycle_s, memory_s=params.shape.response_s
    )
    return ShapeLaw(
        params,
        drive=params.drive,
        phases=setup.phases,
        loop=loop,
        response=response,
        cycle_s=setup.cycle_s,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class LawRow:
    """One law: what it does, for the site file's reference, and how it is built."""

    text: str
    build: LawBuilder


LAW_ROWS: Mapping[str, LawRow] = {
    "blocks": LawRow(text="one amplitude and phase per order and speed.", build=PLAIN),
    "shape": LawRow(
        text="learns the roll's shape in mm through the drive, declared or identified, so a "
        "change of speed needs no learning.",
        build=_shape,
    ),
    "iterative": LawRow(
        text="as blocks, but each correction stands still for a turn of its roll while it is "
        "measured and moves in the next, so strong orders that are not corrected leave no lines "
        "beside those that are; for slow rolls and a short settle_s, answers a change one to two "
        "turns later.",
        build=in_blocks(IterativeBlock),
    ),
}
LAWS: Mapping[str, LawBuilder] = {word: row.build for word, row in LAW_ROWS.items()}
