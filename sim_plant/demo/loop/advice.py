"""What the page of the demo says is to be done now: by what the running line cancels, or not."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from pathlib import Path

from aff_runtime.base.runs.files import yaml_values
from sim_plant.demo.loop.correcting import Decision
from sim_plant.refine.report.next_step import next_step
from sim_plant.refine.report.verdict import EffectFinding, Verdict
from sim_plant.refine.report.wording import remedy


def cancelled_rolls(site: Path) -> frozenset[str]:
    """Return the rolls of all blocks of a site file that runs, in small letters."""
    actuators = yaml_values(site.read_text(encoding="utf-8"))["actuators"].values()
    blocks = (block for actuator in actuators for block in actuator["blocks"])
    return frozenset(str(block["roll"]).lower() for block in blocks)


def advice(verdict: Verdict, decision: Decision | None, rolls: Collection[str]) -> str:
    """Return what is to be done at the machine.

    Parameters
    ----------
    decision : about the block that was proposed; None where none was.
    rolls : of the blocks that the site file has in the end, in small letters.
    """
    if verdict.ambiguous:
        return next_step(verdict)
    ripples = [e for e in verdict.effects if e.cancel]
    cancelled = [e for e in ripples if e.place.location.lower() in rolls]
    left = [e for e in ripples if e not in cancelled]
    others = [e for e in verdict.effects if not e.cancel]
    undone = decision is not None and not decision.kept
    why = "The block was not kept; ripple" if undone else "No block of the site file acts; ripple"
    said = [
        f"{how} of {_names(group)} {end}: {_remedies(group)}."
        for how, end, group in (
            ("AFF cancels the ripple", "while it runs; to be rid of its cause", cancelled),
            (why, "stays until something is done at the machine", left),
        )
        if group
    ]
    if others:
        said.append(f"No correction cancels {_names(others)}: {_remedies(others)}.")
    if verdict.unknown or not said:
        said.append(next_step(replace(verdict, effects=())))
    return " ".join(said)


def _names(effects: Sequence[EffectFinding]) -> str:
    return ", ".join(str(e.place) for e in effects)


def _remedies(effects: Sequence[EffectFinding]) -> str:
    return "; ".join(dict.fromkeys(map(remedy, effects)))
