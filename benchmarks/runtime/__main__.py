"""Measure kernel, wake-up, law and wire in one run; print a table, write docs/results/bench.md."""

from __future__ import annotations

import argparse
from pathlib import Path

from aff_runtime.base.clock import wall_time_iso
from benchmarks.runtime.facts import FactRow, Section, machine
from benchmarks.runtime.instructions import instructions
from benchmarks.runtime.latency import latency
from benchmarks.runtime.law_time import law_time
from benchmarks.runtime.page import judged, markdown, read, text
from benchmarks.runtime.parts import parts
from benchmarks.runtime.shape_tick import shape_tick
from benchmarks.runtime.shape_time import shape_time
from benchmarks.runtime.whole_tick import whole_tick
from sim_plant.cli.bench_kernel import bench_kernel, table

PAGE = Path(__file__).resolve().parents[2] / "docs" / "results" / "bench.md"


def main() -> None:
    """Take about five minutes with the defaults, three of them for times.

    ``--quick``, for a look, takes a tenth of those and counts no instructions. ``--again``
    measures nothing: it judges the figures of the page anew.
    """
    parser = argparse.ArgumentParser(prog="python -m benchmarks.runtime")
    parser.add_argument("--page", type=Path, default=PAGE, help=f"page to write (default {PAGE})")
    parser.add_argument("--quick", action="store_true", help="a tenth of the time, no page")
    parser.add_argument("--again", action="store_true", help="judge the page's figures anew")
    options = parser.parse_args()
    if options.again:
        date, sections = read(options.page.read_text(encoding="utf-8"))
        options.page.write_text(markdown(judged(sections), date=date), encoding="utf-8")
        return
    share = 0.1 if options.quick else 1.0
    sections = [machine(), kernel(), latency(20.0 * share), law_time(8.0 * share)]
    sections += shape_time(6.0 * share)
    sections += [parts(20.0 * share), shape_tick(20.0 * share), *whole_tick(20.0 * share)]
    if not options.quick:
        sections.append(instructions())
    sections = judged(sections)
    print(text(sections))
    if not options.quick:
        options.page.write_text(markdown(sections, date=wall_time_iso()), encoding="utf-8")
        print(f"written: {options.page}")


def kernel() -> Section:
    """Return the speed of the compiled line with the convergence of its step."""
    found = table(bench_kernel()).splitlines()
    rows = tuple(FactRow(name=line[:12].strip(), value=line[12:].strip()) for line in found)
    return Section(title="Compiled line", note="", rows=rows)


if __name__ == "__main__":
    main()
