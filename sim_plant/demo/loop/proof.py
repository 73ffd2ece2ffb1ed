"""What the story proves: the idler's ripple at the plant, and the model's error on a later run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim_plant.base.order_tracking import reduction_dB
from sim_plant.demo.loop.drawn import angle_of
from sim_plant.demo.loop.session import Story, first_order
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.confirm import RecordWithTwin
from sim_plant.refine.judge.holdout import evaluate
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.record_match import twin_of
from sim_plant.refine.model.run_match import run_on_line
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.pipeline import at_its_start_angles
from sim_plant.refine.records.read import read_record
from sim_plant.refine.report.verdict import Verdict

TARGET_DB = 25.0
MOST_OF_FLOOR = 1.10


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelError:
    """Error of one channel on the later run, rms in its unit."""

    declared: float
    amended: float
    floor: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Proof:
    """What was asked and what came out.

    Attributes
    ----------
    named : the trace names the hidden effect and its place, or a set that holds it.
    before_N, after_N : order 1 of the hidden roller in the plant's true tension; None where it is
        no idler, or nothing was tried.
    errors : of the model, by channel, on the run recorded after all.
    tried : no block was proposed, or a try of it came to a judgement.
    cancels : an idler has it and a drive can cancel it: a block is asked for. What a driven roll
        has, its own blocks cancel already.
    """

    verdict: Verdict
    named: bool
    before_N: float | None
    after_N: float | None
    errors: Mapping[str, ModelError]
    tried: bool = True
    cancels: bool = False

    @property
    def reduction_dB(self) -> float | None:
        """Ripple before over after; None where it was not tried."""
        if self.before_N is None or self.after_N is None:
            return None
        return reduction_dB(self.before_N, self.after_N)

    @property
    def of_floor(self) -> float:
        """Error of the amended model over the noise, in the tension where it is largest."""
        tensions = [error for name, error in self.errors.items() if name.endswith("_tension_N")]
        return max(error.amended / error.floor for error in tensions)

    @property
    def targets(self) -> tuple[tuple[str, bool], ...]:
        """What had to be reached, and whether it was."""
        found = [("the trace names effect and place, or a set that holds it", self.named)]
        if not self.tried:
            found.append(("the proposed block is tried and judged", False))
        if (gained := self.reduction_dB) is not None:
            found.append((f"1x at the plant at least {TARGET_DB:g} dB lower", gained >= TARGET_DB))
        elif self.tried and self.cancels:
            found.append(("a block that cancels it is proposed", False))
        text = (
            f"worst tension's model error on the later run at most {MOST_OF_FLOOR:g} of the noise"
        )
        found.append((text, self.of_floor <= MOST_OF_FLOOR))
        return tuple(found)


def proof_of(story: Story) -> Proof:
    """Return what the records of plant and service prove."""
    out = story.plan.out.resolve() / "refine"
    verdict = Verdict.from_json((out / "verdict.json").read_text(encoding="utf-8"))
    hidden = story.hidden[-1]
    channel = f"true_{angle_of(hidden.location)}"
    sizes = [
        first_order(story.record, span, channel) if channel in story.record and span else None
        for span in (story.before, story.after)
    ]
    amended = out / "line_amended.yaml"
    lines = (story.files.line, amended if amended.exists() else story.files.line)
    return Proof(
        verdict=verdict,
        named=verdict.names(EffectAt(hidden.effect, hidden.location)),
        before_N=sizes[0],
        after_N=sizes[1],
        errors=model_errors(lines, story.later_run),
        tried=story.decision is None or story.decision.judgement is not None,
        cancels=hidden.location not in _driven(story.files.line)
        and channel in story.record
        and 1 in BY_NAME[hidden.effect].cancelled(hidden.parameters),
    )


def _driven(line: Path) -> set[str]:
    return {drive.roller for drive in load_declaration(line).control.drives}


def model_errors(lines: tuple[Path, Path], run: str) -> dict[str, ModelError]:
    """Return the error of two declarations on a run, the one as declared, the other as amended."""
    found = [_errors(line, run) for line in lines]
    return {
        name: ModelError(declared=declared, amended=found[1][name][0], floor=found[1][name][1])
        for name, (declared, _) in found[0].items()
    }


def _errors(line: Path, run: str) -> dict[str, tuple[float, float]]:
    """Return error and noise by channel; where declared effects stand is found from the run."""
    declaration = load_declaration(line)
    record = run_on_line(declaration, read_record(Path(run)))
    recorded = at_its_start_angles(
        RecordWithTwin(record=record, twin=twin_of(declaration, record))
    )
    with SimulationPool([recorded.twin], 1) as pool:
        judged = evaluate(pool, recorded.measured, (), (), find_angles=False)
    return {
        name: (float(judged.rms_declared[k]), float(np.asarray(judged.floor)[k]))
        for k, name in enumerate(judged.channels)
    }
