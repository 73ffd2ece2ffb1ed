"""The AFF block that would cancel what was traced, to paste into a site file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import yaml

from sim_plant.base.effects import Value
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.declared.declaration import Declaration, EffectEntry
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.site_match import site_name
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.report.plain import plain
from sim_plant.refine.report.start_values import StartValue, start_values
from sim_plant.refine.report.verdict import EffectFinding

FILE = "aff_block.yaml"
REPORT = CRITERIA.report
HEAD = """\
# for the site file: each entry (from `- roll` on) goes into the list `blocks` of an actuator,
# indented as here; it replaces the entry with the same `roll` if there is one, all others stay;
# a roller that has an actuator of its own belongs there; then run `aff-runtime check` on the file
# start: deviation of the moment arm of each order for `law: shape`, tried on the roll before it is
# used; with `law: blocks` remove start and all orders but the first four
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class AffBlock:
    """One entry of a site file's list ``blocks``; ``entry`` returns it with that file's keys.

    ``start`` are deviations of the moment arm that law shape may begin from; empty: none.
    """

    roll: str
    orders: tuple[int, ...]
    settle_s: float = REPORT.block_settle_s
    amp_limit_m_s: float = REPORT.block_limit_m_s
    start: tuple[StartValue, ...] = ()

    def entry(self) -> dict[str, Any]:
        """Return the entry as YAML takes it."""
        data = plain(asdict(replace(self, roll=site_name(self.roll))))
        if not self.start:
            del data["start"]
        return dict(data)


def aff_blocks(findings: Iterable[EffectFinding]) -> list[AffBlock]:
    """Return a block for every effect that a drive can cancel."""
    return [
        AffBlock(
            roll=f.place.location, orders=tuple(BY_NAME[f.place.effect].cancelled(f.parameters))
        )
        for f in findings
        if f.cancel and f.place.effect in BY_NAME
    ]


def write_block(
    out: Path,
    findings: Sequence[EffectFinding],
    declaration: Declaration | None = None,
    record: Recording | None = None,
) -> Path | None:
    """Write the AFF blocks to paste under an actuator of the site file; None without any.

    With the ``declaration`` the block of a driven roller carries the deviations that law shape
    may start from, for every order that has one; their angles count from ``record``'s channel.
    """
    blocks = started_blocks(findings, declaration, record)
    if not blocks:
        return None
    path = out / FILE
    head = HEAD + "".join(_as_roll(block.roll, declaration) for block in blocks)
    entries = "".join(_text(block) for block in blocks)
    path.write_text(f"{head}    blocks:\n{entries}", encoding="utf-8")
    return path


def started_blocks(
    findings: Sequence[EffectFinding],
    declaration: Declaration | None = None,
    record: Recording | None = None,
) -> list[AffBlock]:
    """Return the blocks with what law shape may start from, as `write_block` writes them."""
    blocks = aff_blocks(findings)
    if declaration is None:
        return blocks
    return [with_start(block, findings, declaration, record) for block in blocks]


def _text(block: AffBlock) -> str:
    """Return one entry of a site file's list ``blocks`` as YAML, indented as it stands there."""
    text = yaml.safe_dump(block.entry(), sort_keys=False, default_flow_style=None, width=88)
    first, *rest = text.splitlines()
    return "".join(f"{line}\n" for line in [f"      - {first}", *(f"        {x}" for x in rest)])


def actuators_for(name: str, declaration: Declaration) -> str:
    """Return the driven roller whose actuator cancels a roller; of an idler those beside it."""
    drives = {drive.roller for drive in declaration.control.drives}
    if name in drives:
        return name
    at, driven = declaration.body(name), sorted(map(declaration.body, drives))
    ends = [
        max((k for k in driven if k < at), default=None),
        min((k for k in driven if k > at), default=None),
    ]
    return " or ".join(declaration.rollers[k].name for k in ends if k is not None)


def _as_roll(name: str, declaration: Declaration | None) -> str:
    """Return the comment on how an idler comes into the site file; empty for a driven roller."""
    if declaration is None or name in {drive.roller for drive in declaration.control.drives}:
        return ""
    radius_m = declaration.rollers[declaration.body(name)].radius_m
    beside = actuators_for(name, declaration)
    return (
        f"# {name} has no drive: its entry goes to the actuator of {beside}, the drives before "
        f"and after it;\n# under `rolls` of the site file, with its angle channel if it has one:\n"
        f"#   {site_name(name)}: {{ radius_m: {radius_m:.6g} }}\n"
    )


def with_start(
    block: AffBlock,
    findings: Iterable[EffectFinding],
    declaration: Declaration,
    record: Recording | None,
) -> AffBlock:
    """Return the block with start values where a drive turns its roller.

    Its orders are then those that have a start value.
    """
    if block.roll not in {drive.roller for drive in declaration.control.drives}:
        return block
    effects = [
        EffectEntry(
            effect=f.place.effect,
            location=f.place.location,
            parameters=_taken(f.place.effect, f.parameters),
        )
        for f in findings
        if f.place.location == block.roll and f.cancel
    ]
    first, last = min(block.orders), max(*block.orders, REPORT.highest_start_order)
    orders = block.orders if len(block.orders) == 1 else range(first, last + 1)
    start = tuple(start_values(declaration, effects, block.roll, orders, record))
    if not start:
        return block
    return replace(block, orders=tuple(value.order for value in start), start=start)


def _taken(effect: str, parameters: Mapping[str, Value]) -> dict[str, Value]:
    """Return the parameters that a line file accepts for the effect, none of them twice.

    A verdict gives amplitude and angle beside the cosine and sine parts: the parts stay.
    """
    known = BY_NAME[effect]
    twice = {
        name
        for pair in known.quadratures
        if pair.amplitude and pair.cos in parameters
        for name in (pair.amplitude, pair.angle)
    }
    return {k: v for k, v in parameters.items() if k in known.parameters and k not in twice}
