"""`sim-plant demo-loop`: a hidden cause recorded by the service, traced, corrected and proved."""

from __future__ import annotations

import argparse
from pathlib import Path

from sim_plant.cli.output import say

Subparsers = argparse._SubParsersAction  # noqa: SLF001 (argparse names it nowhere else)


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the command's arguments."""
    parser = subparsers.add_parser(
        "demo-loop", help="trace a hidden cause from the service's records, and correct it live"
    )
    parser.add_argument("--effect", default="eccentric_roller", help="of the catalogue")
    parser.add_argument("--seed", type=int, default=1, help="draws place, size and angle")
    parser.add_argument("--wire", default="modbus", help="modbus or can (by DBC)")
    parser.add_argument(
        "--kill", choices=("recorder",), help="by SIGKILL, while it writes what the trace reads"
    )
    parser.add_argument("--out", type=Path, default=Path("out/demo-loop"))
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the demo; 0 when every target is met, 5 when one is missed."""
    from sim_plant.demo.loop.page import write_page  # noqa: PLC0415 - heavy imports
    from sim_plant.demo.loop.proof import proof_of  # noqa: PLC0415
    from sim_plant.demo.loop.session import StoryPlan, run_story  # noqa: PLC0415
    from sim_plant.demo.processes import end_as_by_hand  # noqa: PLC0415

    plan = StoryPlan(
        out=arguments.out,
        effect=arguments.effect,
        seed=arguments.seed,
        wire=arguments.wire,
        kills_recorder=arguments.kill == "recorder",
    )
    end_as_by_hand()
    story = run_story(plan, say)
    say("judging the models on the later run")
    proof = proof_of(story)
    page = write_page(story, proof)
    if proof.reduction_dB is not None:
        gained = f"{proof.before_N:.4f} N before, {proof.after_N:.4f} N after"
        say(f"1x of the hidden roller at the plant: {gained}, {proof.reduction_dB:.1f} dB")
    if story.loss is not None:
        say(str(story.loss))
    for text, met in proof.targets:
        say(f"{'met' if met else 'MISSED'}: {text}")
    say(f"page: {page}")
    return 0 if all(met for _, met in proof.targets) else 5
