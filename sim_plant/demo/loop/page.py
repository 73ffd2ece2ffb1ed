"""One self-contained page of the story, and its JSON twin."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path
from statistics import mean

import numpy as np
from jinja2 import Environment, PackageLoader
from matplotlib.figure import Figure

from sim_plant.base.effects import Value
from sim_plant.base.svg import svg
from sim_plant.demo.loop.advice import advice, cancelled_rolls
from sim_plant.demo.loop.proof import Proof
from sim_plant.demo.loop.session import Story
from sim_plant.refine.report.page import headline
from sim_plant.refine.report.plain import plain
from sim_plant.refine.report.wording import size_of

PAGE, DATA = "page.html", "page.json"
BEFORE, AFTER = "#9aa0a6", "#1a7f37"


def write_page(story: Story, proof: Proof) -> Path:
    """Write page and JSON into the story's folder; return the page's path."""
    out = story.plan.out.resolve()
    verdict = proof.verdict
    template = Environment(
        loader=PackageLoader("sim_plant.demo.loop", "."), autoescape=True
    ).get_template("page.html.j2")
    page = template.render(
        seed=story.plan.seed,
        wire=story.plan.wire,
        hidden=[
            {"effect": h.effect, "location": h.location, "numbers": _numbers(h.parameters)}
            for h in story.hidden
        ],
        targets=proof.targets,
        recorded=f"{Path(story.first_run).name}",
        loss=story.loss,
        refine_s=story.refine_s,
        headline=headline(verdict),
        next_step=advice(verdict, story.decision, cancelled_rolls(story.files.site)),
        effects=[
            {
                "effect": e.place.effect,
                "location": e.place.location,
                "size": size_of(e),
                "score": e.score,
                "margin": e.margin,
            }
            for e in verdict.effects
        ],
        alike=verdict.ambiguous,
        diff=story.diff,
        decision=story.decision,
        before=story.before,
        after=story.after,
        before_N=proof.before_N,
        after_N=proof.after_N,
        reduction=proof.reduction_dB,
        tension=_tension(story),
        errors=proof.errors,
        history=story.history,
        arms=story.arms,
        missed=story.missed_ticks,
        load=mean(story.load) if story.load else 0.0,
    )
    (out / PAGE).write_text(page, encoding="utf-8")
    (out / DATA).write_text(_json(story, proof), "utf-8")
    return out / PAGE


def _json(story: Story, proof: Proof) -> str:
    """Return what the page says, as text for a file."""
    said = {
        "seed": story.plan.seed,
        "hidden": [hidden.entry() for hidden in story.hidden],
        "verdict": proof.verdict.answer,
        "named": proof.named,
        "before_N": proof.before_N,
        "after_N": proof.after_N,
        "reduction_dB": proof.reduction_dB,
        "model_error": {k: dataclasses.asdict(e) for k, e in proof.errors.items()},
        "targets": dict(proof.targets),
        "kept": story.kept,
        "decision": None if story.decision is None else dataclasses.asdict(story.decision),
        "loss": None if story.loss is None else dataclasses.asdict(story.loss),
        "refine_s": story.refine_s,
        "arms": story.arms,
        "missed_ticks": story.missed_ticks,
        "mean_load": mean(story.load) if story.load else 0.0,
    }
    return json.dumps(plain(said), indent=1) + "\n"


def _numbers(parameters: Mapping[str, Value]) -> str:
    return ", ".join(f"{name} {value}" for name, value in parameters.items())


def _tension(story: Story) -> str:
    """Return the true tension over the story, both windows marked."""
    time_s, tension = story.record["time_s"], story.record["true_unwind_tension_N"]
    step = max(1, time_s.size // 6000)
    figure = Figure(figsize=(11, 3.2))
    axis = figure.subplots()
    axis.plot(time_s[::step], tension[::step], lw=0.6, color="#0b57d0")
    axis.axvspan(*story.before, color=BEFORE, alpha=0.25)
    if story.after is not None:
        axis.axvspan(*story.after, color=AFTER, alpha=0.2)
    axis.set_ylim(float(np.quantile(tension, 0.002)) - 2, float(np.quantile(tension, 0.998)) + 2)
    axis.set_ylabel("unwind tension [N]")
    axis.set_xlabel("plant time [s]; grey: before the block, green: with it")
    axis.grid(alpha=0.3)
    return svg(figure)
