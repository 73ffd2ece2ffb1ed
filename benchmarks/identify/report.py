"""Rows of drawn lines as a page."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from aff_runtime.core.identified import Estimate

IdentifiedLine = dict[str, Any]
PAGE = Path(__file__).resolve().parents[2] / "docs" / "results" / "identify.md"
NUMBERS = {
    "speed_gain_rad_s": "speed gain [rad/s]",
    "integral_time_s": "integral time [s]",
    "inertia_kg_m2": "inertia with web [kg m2]",
    "friction_N_m_s": "friction [N m s]",
    "delay_s": "delay [s]",
    "stiffness_N_m": "web [N/m]",
}
NEEDED = ("speed_gain_rad_s", "integral_time_s", "inertia_kg_m2")
WITHIN = 0.10
BOUNDED = "friction_N_m_s"
"""Told by its interval alone."""


def holds(row: IdentifiedLine, number: str) -> bool:
    """Return whether an interval holds the true number."""
    found = row["found"][number]
    return bool(found["low"] <= row["true"][number] <= found["high"])


def shown(row: IdentifiedLine, number: str) -> bool:
    """Return whether the probe says that it knows a number; else it gives an interval alone."""
    return row["found"] is not None and Estimate(**row["found"][number]).is_sure


def near(row: IdentifiedLine, number: str) -> bool:
    """Return whether a number is shown, and within 10 % of the true one."""
    return shown(row, number) and abs(off(row, number)) <= WITHIN


def off(row: IdentifiedLine, number: str) -> float:
    """Return how far an identified number is from the true one, as a share of it."""
    return float(row["found"][number]["value"] / row["true"][number] - 1.0)


def loss_dB(row: IdentifiedLine) -> float:
    """Return how much more ripple the identified numbers leave than the true ones."""
    ripple = row["ripple_N"]
    return 20.0 * math.log10(ripple["identified"] / ripple["true"])


def median_loss_dB(rows: Sequence[IdentifiedLine]) -> float:
    """Return the median over the lines where a drive was found."""
    found = [loss_dB(row) for row in rows if row["found"] is not None]
    return statistics.median(found) if found else math.nan


def line_of(row: IdentifiedLine) -> str:
    """Return one line as text."""
    name = f"{row['seed']} {row['web']}"
    if row["found"] is None:
        return f"{name}: {row['refused']}"
    told = ", ".join(
        f"{number.split('_')[0]} {100.0 * off(row, number):+.0f} %"
        f"{'' if shown(row, number) else ' (not shown)'}"
        f"{'' if holds(row, number) else ' (outside its interval)'}"
        for number in NEEDED
    )
    return f"{name}: {told}, {loss_dB(row):+.1f} dB"


def page(rows: Sequence[IdentifiedLine]) -> str:
    """Return the page."""
    found = [row for row in rows if row["found"] is not None]
    pulls = sorted(float(row["pulled_N"]) for row in rows)
    parts = [
        "# The drive identified by the probe",
        "",
        f"`python -m benchmarks.identify --docs`: {len(rows)} lines drawn by seed "
        f"({rows[0]['seed']} to {rows[-1]['seed']}), web, speed gain (5 to 60 rad/s), damping, "
        "inertia (of the idlers too), stiffness, radius, speed, load cell, noise, tension loop "
        "and delay (5 to 65 ms) by chance; the path of the web is Euclid's. Each is probed once, "
        "in lockstep, with words of the PLC's resolution, at most 30 mm/s, less where a single "
        "tone of that size from 0.3 to 15 Hz could pull more than 10 N (what all of them "
        "together pulled: "
        f"{pulls[0]:.1f} to {pulls[-1]:.1f} N), for at most a minute and 4 % of the radius. "
        "`found (low to high)` is the 95 % interval.",
        "",
        *_summary(rows, found),
        "",
        *_numbers_table(rows),
        "",
        *_ripple_table(found),
    ]
    return "\n".join(parts) + "\n"


def _summary(rows: Sequence[IdentifiedLine], found: Sequence[IdentifiedLine]) -> list[str]:
    lines = [
        f"{len(found)} of {len(rows)} were identified.",
        "",
        "| number | shown | within 10 % | interval holds | median error | worst error |",
        "|---|---|---|---|---|---|",
    ]
    for number, title in NUMBERS.items():
        sizes = [abs(off(row, number)) for row in found]
        kept = sum(holds(row, number) for row in found)
        told = (
            f"{sum(shown(row, number) for row in rows)} of {len(rows)}",
            f"{sum(near(row, number) for row in rows)} of {len(rows)}",
        )
        errors = f"{100.0 * statistics.median(sizes):.1f} %", f"{100.0 * max(sizes):.0f} %"
        if number == BOUNDED:
            told, errors = ("-", "-"), ("-", "-")
        cells = (title, *told, f"{kept} of {len(found)}", *errors)
        lines.append("| " + " | ".join(cells) + " |")
    held = [holds(row, number) for row in found for number in NUMBERS if number != BOUNDED]
    share = 100.0 * sum(held) / len(held)
    losses = [loss_dB(row) for row in found]
    return [
        *lines,
        "",
        f"{sum(held)} of {len(held)} intervals hold, {share:.0f} % (target 90 to 98 %; friction "
        "not counted: it is far below what a probe can tell, and its interval is the answer, not "
        "its value). *Shown* is a number whose interval is narrower than 1 to 1.7; of one that is "
        "not, the probe gives the interval alone, and here it counts as a miss.",
        "",
        f"Ripple with identified instead of true numbers: {median_loss_dB(rows):+.2f} dB in the "
        f"median (target at most +1), {min(losses):+.1f} to {max(losses):+.1f} dB. The speed is "
        "constant in these runs: there the law learns what the drive's numbers leave wrong; a "
        "change of speed asks more of them and was not run.",
    ]


def _numbers_table(rows: Sequence[IdentifiedLine]) -> list[str]:
    head = ["line", *NUMBERS.values()]
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for row in rows:
        name = f"{row['seed']} {row['web']}, {row['radius_m']:.3f} m, {row['speed_m_s']:.2f} m/s"
        if row["found"] is None:
            lines.append(f"| {name} | {row['refused']} |" + " |" * (len(NUMBERS) - 1))
            continue
        cells = []
        for number in NUMBERS:
            one = row["found"][number]
            miss = "" if holds(row, number) else " **outside**"
            cells.append(
                f"{row['true'][number]:.3g}: {one['value']:.3g} "
                f"({one['low']:.3g} to {one['high']:.3g}){miss}"
            )
        lines.append("| " + " | ".join([name, *cells]) + " |")
    return ["## True: found (interval)", "", *lines]


def _ripple_table(found: Sequence[IdentifiedLine]) -> list[str]:
    lines = [
        "## Tension ripple, 25 to 45 s after the law is switched on",
        "",
        "| line | PI alone [N] | true numbers [N] | identified [N] | loss [dB] |",
        "|---|---|---|---|---|",
    ]
    for row in found:
        ripple = row["ripple_N"]
        lines.append(
            f"| {row['seed']} {row['web']} | {ripple['PI alone']:.3f} | {ripple['true']:.3f} | "
            f"{ripple['identified']:.3f} | {loss_dB(row):+.1f} |"
        )
    return lines
