"""The page: targets against reached, then every table, then the plots."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.control.jobs import BenchRow
from benchmarks.control.laws import OWN, RIVALS, tuning
from benchmarks.control.sweep import SUBSET
from benchmarks.control.verdicts import beaten, targets


def _dB(values: Sequence[float], count: int = 4) -> str:
    return " ".join("-" if math.isnan(v) else f"{v:.0f}" for v in values[:count])


def _number(value: float, digits: int = 3) -> str:
    return "never" if math.isinf(value) else f"{value:.{digits}f}"


def _newton(values: Sequence[float]) -> str:
    return " ".join(f"{v:.3f}" for v in values[:4])


def _dB_all(values: Sequence[float]) -> str:
    return _dB(values, len(values))


def _each(values: Sequence[Any], show: Callable[[Any], str]) -> str:
    return "; ".join(show(value) for value in values)


def _settled(row: BenchRow) -> str:
    return f"{_number(row['first_turns'], 1)}, {_number(row['settle_turns'], 1)}"


COLUMNS: dict[str, list[tuple[str, Any]]] = {
    "constant": [
        ("late dB 1x-4x", lambda r: _dB(r["late_dB"])),
        ("5x-8x", lambda r: _dB(r["late_dB"][4:])),
        ("turns 10-20", lambda r: _dB(r["middle_dB"])),
        ("noise reference", lambda r: _dB(r["reference_dB"])),
        ("20 dB reached, kept [turns]", _settled),
        ("ripple / PI", lambda r: _number(r["ripple"])),
        ("start peak / PI", lambda r: _number(r["peak"], 2)),
    ],
    "ramp": [
        ("first dB 1x-4x", lambda r: _dB(r["first_dB"])),
        ("first ripple / PI", lambda r: _number(r["first_ripple"])),
        ("second dB 1x-4x", lambda r: _dB(r["second_dB"])),
        ("second ripple / PI", lambda r: _number(r["second_ripple"])),
    ],
    "roll": [
        ("mean dB 1x-4x", lambda r: _dB(r["mean_dB"])),
        ("5x-8x", lambda r: _dB(r["mean_dB"][4:])),
        ("worst window 1x-4x", lambda r: _dB(r["worst_dB"])),
        ("ripple / PI", lambda r: _number(r["ripple"])),
        ("worst 5 s", lambda r: _number(r["worst_5s"])),
        ("5 s windows worse than PI", lambda r: f"{100 * r['worse_share']:.0f} %"),
    ],
    "follower": [
        ("pull-roll 1x dB", lambda r: f"{r['pullroll_1x_dB']:.0f}"),
        ("pull-roll / PI", lambda r: _number(r["pullroll"])),
        ("unwind / PI", lambda r: _number(r["unwind"])),
        ("follower speed / PI", lambda r: _number(r["follower_speed"])),
    ],
    "timing": [
        ("p50 [us]", lambda r: f"{r['p50_us']:.0f}"),
        ("p99 [us]", lambda r: f"{r['p99_us']:.0f}"),
    ],
    "transient": [
        ("ripple / PI before", lambda r: _number(r["before"])),
        ("worst 2 s since", lambda r: _number(r["worst_2s"], 2)),
        ("largest excursion / PI", lambda r: _number(r["peak"], 2)),
        ("below 0.1 after [turns]", lambda r: _number(r["back_turns"], 1)),
        ("ripple / PI at the end", lambda r: _number(r["after"])),
    ],
    "film": [
        ("dB per order below 60 Hz", lambda r: _each(r["orders_dB"], _dB_all)),
        ("worst", lambda r: _each(r["worst_dB"], lambda v: f"{v:.0f}")),
        ("ripple / PI", lambda r: _each(r["ripple"], _number)),
        ("largest correction [m/s]", lambda r: _number(r["largest_m_s"])),
    ],
    "memory": [
        ("ticks", lambda r: f"{r['ticks']:,}"),
        ("share of a week", lambda r: f"{100 * r['ticks'] / r['week_ticks']:.1f} %"),
        ("objects, grown by", lambda r: f"{r['objects']}, {r['objects_grown']}"),
        ("bytes, grown by", lambda r: f"{r['bytes']:,}, {r['bytes_grown']}"),
        ("interpreter's blocks, grown by", lambda r: f"{r['blocks_grown']}"),
        ("resident [kB], grown by", lambda r: f"{r['resident_kB']:,}, {r['resident_grown_kB']}"),
    ],
    "wire": [
        ("PI alone 1x-4x [N]", lambda r: _newton(r["plain_N"])),
        ("with the law 1x-4x [N]", lambda r: _newton(r["with_N"])),
        ("dB 1x-4x over the wire", lambda r: _dB(r["late_dB"])),
        ("dB 1x-4x in lockstep", lambda r: _dB(r["lockstep_dB"])),
        ("ripple / PI over the wire", lambda r: _number(r["ripple"])),
        ("in lockstep", lambda r: _number(r["lockstep_ripple"])),
    ],
}
COLUMNS["mismatch"] = COLUMNS["constant"]
TITLES = {
    "constant": "Constant speed",
    "ramp": "Ramps 100 to 300 FPM in 20 s",
    "roll": "Whole roll, 8 in to 2.5 in",
    "follower": "Eccentric follower, 0.5 mm: two zones, one or two actuators",
    "mismatch": "Hidden mismatch",
    "transient": "Stop and start, emergency stop, roll change",
    "film": "Film line, 1 ms (2 ms where said), 600 to 1000 m/min; ramps: first; second",
    "wire": "Over the wire: Modbus TCP, two processes, real time",
    "timing": "Cost of one tick",
    "memory": "Memory",
}


def line(row: BenchRow) -> str:
    """Return one row as plain text."""
    cells = " | ".join(f"{head} {show(row)}" for head, show in COLUMNS[row["section"]])
    name = f"{row['section']:9s} {row['case']:34s} {row['law']:24s}"
    return f"{name} seed {row.get('seed', '')}: {cells}"


def _table(section: str, rows: Iterable[BenchRow]) -> list[str]:
    heads = [head for head, _ in COLUMNS[section]]
    out = ["| case | law | seed | " + " | ".join(heads) + " |", "|" + "---|" * (3 + len(heads))]
    for row in rows:
        cells = " | ".join(show(row) for _, show in COLUMNS[section])
        out.append(f"| {row['case']} | {row['law']} | {row.get('seed', '')} | {cells} |")
    return out


def page(rows: Sequence[BenchRow], missing: int = 0, *, quick: bool = False) -> str:
    """Return the whole page as markdown; ``missing`` rows have not been run.

    What was found out about the whole set is not said of the short one (``quick``).
    """
    out = ["# Control bench", "", *INTRODUCTION, ""]
    if missing:
        out += [f"**{missing} rows of the full table have not been run.**", ""]
    if quick:
        out += [
            "Short set (`QUICK=1`): a few rows of `docs/results/control-bench.md`, seed 1.",
            "",
        ]
    else:
        out += ["Why targets are missed: [notes](../notes/control-bench-misses.md).", ""]
    out += ["## Targets", "", *_targets(rows), ""]
    out += ["## Laws and their tuning", ""]
    out += [f"- **{law}**: {tuning(law)}." for law in (OWN, *RIVALS)]
    out += ["", f"Tuned on seed 1: {SUBSET}.", ""]
    lost = beaten(rows)
    out += ["## Rows where a rival leaves less ripple", ""]
    for r, ratio in lost:
        row = f"{r['section']}, {r['case']}, seed {r['seed']}"
        out.append(f"- {row}: {r['law']} leaves {ratio:.2f} times the shape law's ripple")
    if not lost:
        out.append("None.")
    for section, title in TITLES.items():
        part = [r for r in rows if r["section"] == section]
        if part:
            part.sort(key=lambda r: (r.get("seed", 0), r["case"], ORDER.get(r["law"], 99)))
            out += ["", f"## {title}", "", *_table(section, part)]
    return "\n".join(out) + "\n"


def _targets(rows: Sequence[BenchRow]) -> list[str]:
    seeds = sorted({r["seed"] for r in rows if r["section"] in ALL_SEEDS})
    sets = [{t.what: t for t in targets([r for r in rows if r.get("seed") == s])} for s in seeds]
    heads = " | ".join(f"seed {s}: min / median / max | met" for s in seeds)
    out = [f"| target | asked | {heads} |", "|" + "---|" * (2 + 2 * len(seeds))]
    for what in dict.fromkeys(w for found in sets for w in found):
        first = next(found[what] for found in sets if what in found)
        cells = " | ".join(
            f"{found[what].reached} | {found[what].met}" if what in found else "- | -"
            for found in sets
        )
        out.append(f"| {what} | {first.asked} | {cells} |")
    return out


ALL_SEEDS = ("constant", "ramp", "roll", "follower", "mismatch", "film")
ORDER = {law: i for i, law in enumerate((OWN, *RIVALS))}
INTRODUCTION = [
    "Written by `make bench-control` (`QUICK=1` for the short set). One line, one noise, one",
    "limit (0.3 m/s), 5 ms, one sample of transport, laws in lockstep with the simulated line, no",
    "sockets. Judged on the true mean tension of the spans at the load cell, by least squares on",
    "the roll's angle; dB against the same run with the tension PI alone. Lead and follower are",
    "0.3 mm eccentric, so ripple of other rolls is part of every row. Seed 1 was used for tuning,",
    "seed 101 never. Rows are kept in `out/control-bench`, a stopped run goes on. One row again:",
    '`python -m benchmarks.control --cases "PE 300 FPM R8 flat" --laws FxLMS --seeds 101 --out X`',
    "(names as in the tables; a case may be in several of them: `--sections roll`). P is the",
    "declared line's own noise-free answer to a push (six radii, 200 FPM):",
    "nominal rows are a best case, hidden-mismatch rows use the same P on a line that differs.",
    "Noise reference: what averaging white load-cell noise over ten turns leaves; a yardstick. A",
    "perfect roll is the same line and noise without any fault; best fixed weights are what the",
    "law learned without noise, held still: both say where the line sets the limit, not the law.",
    "",
    "![Whole roll](control-bench-roll.svg) ![By law](control-bench-laws.svg)",
]


def plots(rows: Sequence[BenchRow], folder: Path) -> None:
    """Write the plots as SVG."""
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    matplotlib.rcParams["svg.hashsalt"] = "control-bench"
    rolls = [r for r in rows if r["section"] == "roll" and r["seed"] == 1]
    if rolls:
        figure, axes = plt.subplots(figsize=(8, 4))
        for row in rolls:
            if row["case"] == rolls[0]["case"]:
                axes.semilogy(row["radius_in"], row["trace"], label=row["law"], lw=1)
        axes.set(
            xlabel="roll radius [in]", ylabel="ripple / PI alone, 5 s", title=rolls[0]["case"]
        )
        axes.invert_xaxis()
        axes.set_ylim(0.01, 30)
        axes.axhline(1.0, color="k", lw=0.5)
        axes.legend(fontsize=7)
        figure.savefig(folder / "control-bench-roll.svg", metadata={"Date": None})
        plt.close(figure)
    constant = [r for r in rows if r["section"] == "constant" and r["seed"] == 1]
    if constant:
        laws = list(dict.fromkeys(r["law"] for r in constant))
        figure, axes = plt.subplots(figsize=(8, 4))
        for at, law in enumerate(laws):
            values = [r["ripple"] for r in constant if r["law"] == law]
            axes.semilogy(at + np.linspace(-0.25, 0.25, len(values)), values, ".")
        axes.set_xticks(range(len(laws)), laws, rotation=20, fontsize=7, ha="right")
        axes.axhline(1.0, color="k", lw=0.5)
        axes.set(ylabel="total ripple / PI alone", title="Constant speed, every case")
        figure.tight_layout()
        figure.savefig(folder / "control-bench-laws.svg", metadata={"Date": None})
        plt.close(figure)
