"""`sim-plant refine`: from measured records to what the line model lacks."""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING

from aff_runtime.base.errors import PlantError
from sim_plant.cli.output import say

if TYPE_CHECKING:
    from aff_runtime.base.refinement import RecordLacks
    from sim_plant.line.reading.load import LineFile
    from sim_plant.refine.report.outcome import Outcome, RefineRequest
    from sim_plant.refine.without_line.verdict import RecordVerdict

Subparsers = argparse._SubParsersAction  # noqa: SLF001 (argparse names it nowhere else)


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the subcommand."""
    parser = subparsers.add_parser(
        "refine",
        help="trace what a line model lacks in records",
        description="Compare records with the declared line; name the effect, place and "
        "size that explain what is left. docs/engineer/refine.md",
    )
    parser.add_argument(
        "line",
        type=Path,
        metavar="LINE.yaml",
        help="line declaration, or a record declaration where there is no line",
    )
    parser.add_argument(
        "records",
        type=Path,
        nargs="*",
        metavar="RECORD",
        help="records to fit: .csv, .csv.gz, .txt, .parquet, .mf4; columns are "
        "time_s, both references and the channels the line declares; or a run of aff-runtime, "
        "whole or a part: RUN_DIR, RUN_DIR@FROM..TO (s, m:s or h:m:s of its column time_s; its "
        "events.csv has when it was armed, edited, stopped)",
    )
    parser.add_argument(
        "--example",
        action="store_true",
        help="make two records of this line with an undeclared effect first",
    )
    parser.add_argument(
        "--holdout",
        type=Path,
        action="append",
        default=[],
        metavar="RECORD",
        help="record to judge on, not to fit",
    )
    parser.add_argument(
        "--out",
        type=Path,
        required=True,
        metavar="DIR",
        help="folder for report.html, verdict.json, line_amended.yaml and aff_block.yaml",
    )
    parser.add_argument(
        "--site",
        type=Path,
        metavar="SITE.yaml",
        help="site file of the service: written to DIR with the AFF block in its place, as "
        "site_proposed.yaml, for `aff-runtime settings try`",
    )
    parser.add_argument(
        "--pieces",
        action="store_true",
        help="of a run that is to be fitted take every piece of the running line without a "
        "break (a splice, a stop, a hole) as a record of its own, not the longest alone",
    )
    parser.add_argument(
        "--without",
        action="append",
        default=[],
        metavar="EFFECT",
        help="leave an effect out of the library; may be given again",
    )
    parser.add_argument(
        "--lacking",
        action="store_true",
        help="say what each record lacks, before any work, write lacking.json and end",
    )
    parser.add_argument(
        "--workers",
        type=int,
        default=min(2, os.cpu_count() or 1),
        metavar="N",
        help="processes that simulate (default: 2, on one core 1)",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Refine; 0 whatever the verdict, 2 when an input cannot be judged."""
    # small products only: threads of the linear algebra wait for each other more than they work
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from sim_plant.line.reading.load import line_in, read_source  # noqa: PLC0415 - heavy imports

    plan = plan_of(arguments)
    source = read_source(plan.line)  # a file that cannot be read is refused before the rest loads
    from sim_plant.refine.report.folder import check_folder  # noqa: PLC0415
    from sim_plant.refine.without_line.record_filter import (  # noqa: PLC0415
        is_record_declaration,
        record_declaration_in,
    )

    if arguments.example and is_record_declaration(source):
        raise PlantError(
            f"{plan.line}: declares records; --example needs a line, such as "
            "config/lines/euclid.yaml"
        )
    check_folder(plan)
    if arguments.example:
        from sim_plant.refine.example import write_example  # noqa: PLC0415

        print("making two records with an effect that the line file does not declare")
        try:
            first, second = write_example(source, plan.out / "records")
        except OSError as error:
            raise PlantError(f"--out {plan.out}: cannot be written ({error})") from error
        plan = replace(plan, records=(first,), holdout=(second,))
    if arguments.lacking:
        if is_record_declaration(source):
            raise PlantError(f"{plan.line}: declares records; --lacking needs a line")
        return tell_lacking(plan, line_in(source))
    if is_record_declaration(source):
        from sim_plant.refine.without_line.pipeline import refine_records  # noqa: PLC0415

        found = refine_records(plan, record_declaration_in(source), say)
        say(record_summary(found, plan.out, held=bool(plan.holdout)))
    else:
        from sim_plant.refine.pipeline import refine  # noqa: PLC0415

        say(summary(refine(plan, line_in(source), say)))
    return 0


def tell_lacking(plan: RefineRequest, line: LineFile) -> int:
    """Say what the records lack, and write it; 2 where one cannot be used."""
    from aff_runtime.base.refinement import LACKING  # noqa: PLC0415
    from sim_plant.refine.lacking import lacking  # noqa: PLC0415 - heavy imports

    found = lacking(plan, line.declaration)
    for one in found.records:
        if one.refused:
            say(f"{one.name}: cannot be used: {one.refused}")
            continue
        say(f"{one.name}: {_held(one)}")
        for text in one.lacks:
            say(f"  cannot be claimed: {text}")
        for text in one.said:
            say(f"  {text}")
    for text in found.together:
        say(text)
    try:
        plan.out.mkdir(parents=True, exist_ok=True)
        text = f"{json.dumps(asdict(found), indent=1)}\n"
        (plan.out / LACKING).write_text(text, encoding="utf-8")
    except OSError as error:
        raise PlantError(f"--out {plan.out}: cannot be written ({error})") from error
    return 0 if found.can_begin else 2


def _held(one: RecordLacks) -> str:
    """Return what a record holds: how long, at which speeds, tensions and radius."""
    slow, fast = one.speed_m_s
    low, high = one.tension_N
    speeds = f"{slow:.3g} to {fast:.3g} m/s" if fast - slow > 1e-3 * fast else f"{fast:.3g} m/s"
    tensions = f"{low:.3g} to {high:.3g} N" if high - low > 1e-3 * high else f"{high:.3g} N"
    judged = "to be judged on" if one.is_held else "to be fitted"
    return (
        f"{one.length_s:.1f} s {judged}, {speeds}, tension reference {tensions}, "
        f"unwind radius {1e3 * one.radius_m:.1f} mm"
    )


def plan_of(arguments: argparse.Namespace) -> RefineRequest:
    """Return what the command line asks for.

    Raises
    ------
    PlantError
        When it contradicts itself or names an effect that does not exist.
    """
    from sim_plant.effects.catalogue import BY_NAME  # noqa: PLC0415 - heavy imports
    from sim_plant.refine.report.outcome import RefineRequest  # noqa: PLC0415

    for name in arguments.without:
        if name not in BY_NAME:
            raise PlantError(f"--without {name}: no such effect; there are {sorted(BY_NAME)}")
    if arguments.workers < 1:
        raise PlantError(f"--workers {arguments.workers}: give at least 1")
    if arguments.example and (arguments.records or arguments.holdout):
        raise PlantError("--example makes its own records; leave RECORD and --holdout out")
    if not arguments.records and not arguments.example:
        raise PlantError("give at least one RECORD, or --example")
    return RefineRequest(
        line=arguments.line,
        records=tuple(pieces_in(arguments.records) if arguments.pieces else arguments.records),
        holdout=tuple(arguments.holdout),
        out=arguments.out,
        without=tuple(arguments.without),
        workers=arguments.workers,
        site=arguments.site,
    )


def pieces_in(records: Sequence[Path]) -> list[Path]:
    """Return records, each run in its unbroken pieces; says which where there are several."""
    from aff_runtime.base.runs.window import names_a_run  # noqa: PLC0415
    from sim_plant.refine.records.run_windows import unbroken_windows  # noqa: PLC0415 - heavy imports

    found: list[Path] = []
    for path in records:
        try:
            pieces = unbroken_windows(path) if names_a_run(path) else [path]
        except PlantError:  # what reads it says why, beside what the others hold
            pieces = [path]
        if len(pieces) > 1:
            say(f"{path.name}: {len(pieces)} records: {', '.join(one.name for one in pieces)}")
        found += pieces
    return found


def record_summary(verdict: RecordVerdict, out: Path, *, held: bool) -> str:
    """Return the verdict on records without a line as text."""
    from sim_plant.refine.without_line.wording import effect_text, spectral_line_text  # noqa: PLC0415 - heavy imports

    lines = [f"\nverdict: {verdict.answer}"]
    lines += [f"  {effect_text(x)}" for x in verdict.general_effects]
    lines += [f"  {x.axis}: {spectral_line_text(x)}" for x in verdict.unknown]
    lines += [f"  no effect: {x.frequency:.4g} Hz {x.clock}" for x in verdict.clocks]
    for name, error in verdict.residual_rms.items():
        lines.append(
            f"{name}: rms {error.before:.5g} with the declared filter alone, "
            f"{verdict.models[name].plain_rms:.5g} with plain least squares, "
            f"{error.after:.5g} with the effects and spectral lines"
        )
    return "\n".join([*lines, _last(verdict.holdout, out, held=held)])


def _last(judged: str, out: Path, *, held: bool) -> str:
    """Return what was judged on, and the page to open."""
    proof = "judged on the held-out" if held else "no proof, judged on the fitted"
    return f"{proof} {judged}; open {out / 'report.html'}"


def summary(outcome: Outcome) -> str:
    """Return the verdict and the error table as text."""
    from sim_plant.refine.report.beside_rival import beside_rival  # noqa: PLC0415
    from sim_plant.refine.report.page import facts_of  # noqa: PLC0415
    from sim_plant.refine.report.partly import partly  # noqa: PLC0415
    from sim_plant.refine.report.wording import coordinate_text, size_of  # noqa: PLC0415

    verdict, facts = outcome.verdict, facts_of(outcome)
    less = partly(verdict, facts)
    lines = [f"\nverdict: {verdict.answer}", *([f"  {less}"] if less else [])]
    for e in verdict.effects:
        lines.append(f"  {e.place}: {size_of(e)}")
        lines.append(
            f"    score {e.score:.0f}, runner-up {e.runner_up or ''}, margin {e.margin:.0f}"
        )
        beside = beside_rival(e, verdict.residual_rms)
        lines += [f"    {beside}"] if beside else []
    for a in verdict.ambiguous:
        lines.append(f"  not identifiable: {a.place} or {', '.join(map(str, a.alternatives))}")
        lines += [f"    to tell: {what}" for what in a.experiments]
    for u in verdict.unknown:
        where = coordinate_text(u.unknown_class, u.coordinate, u.begins, u.also, facts.tolerances)
        lines.append(f"  unknown, class {u.unknown_class}: {where}")
    lines.append(
        f"{'channel':28s} {'before':>10s} {'after':>10s} {'floor':>10s} {'after/floor':>11s}"
    )
    for name, error in verdict.residual_rms.items():
        share = error.after / error.noise_floor if error.noise_floor else 0.0
        lines.append(
            f"{name:28s} {error.before:10.4g} {error.after:10.4g} "
            f"{error.noise_floor:10.4g} {share:11.3f}"
        )
    lines.append(_last(verdict.holdout, outcome.plan.out, held=bool(outcome.plan.holdout)))
    return "\n".join(lines)
