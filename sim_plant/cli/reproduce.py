"""`sim-plant reproduce`: the source's experiments as figures, numbers and verdicts."""

from __future__ import annotations

import argparse
from pathlib import Path

Subparsers = argparse._SubParsersAction  # noqa: SLF001 (argparse names it nowhere else)


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the subcommand."""
    parser = subparsers.add_parser("reproduce", help="the source's experiments, one gallery")
    parser.add_argument(
        "--only",
        action="append",
        default=[],
        metavar="ID",
        help="one experiment (repeat for more); --list names them",
    )
    parser.add_argument("--out", type=Path, default=Path("out/reproduce"), metavar="DIR")
    parser.add_argument("--docs", type=Path, metavar="FILE.md", help="write the table there too")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="processes")
    parser.add_argument("--list", action="store_true", help="name the experiments and stop")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the chosen experiments; 5 when two methods differ by more than promised."""
    from sim_plant.reproduce.gallery import chosen, counts, markdown, run_all, write_gallery  # noqa: PLC0415 (heavy imports: only when used)

    experiments = chosen(arguments.only)
    if arguments.list:
        for e in experiments:
            print(f"{e.identity:14s} {e.where:32s} {e.title}")
        return 0
    done = run_all(experiments, arguments.jobs, lambda text: print(text, flush=True))
    page = write_gallery(done, arguments.out)
    if arguments.docs is not None:
        arguments.docs.write_text(markdown(done), encoding="utf-8")
    broken = [g for d in done for g in d.result.disagreements if not g.within]
    for gap in broken:
        print(
            f"broken promise: {gap.what}: {gap.first} and {gap.second} differ by "
            f"{gap.difference:.3g} {gap.unit}"
        )
    total = counts(done)
    print(f"{total['agree']} rows agree, {total['disagree']} disagree, {total['new']} are new")
    print(f"gallery: {page}")
    return 5 if broken else 0
