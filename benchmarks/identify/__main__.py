"""``python -m benchmarks.identify``: probe drawn lines, compare what is found with the truth."""

from __future__ import annotations

import argparse
import math
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

from benchmarks.identify import report
from benchmarks.identify.drawn import draw
from benchmarks.identify.probing import CYCLE_S, amplitude_m_s, measured
from benchmarks.identify.ripple import filled_in, left_N
from benchmarks.rows import read_row, write_row

FIRST, LINES = 100, 20
KEYS = ("seed", "web", "true", "found", "ripple_N", "refused", "pulled_N")


def row_of(seed: int) -> dict[str, Any]:
    """Probe one line and run it with its true and with the identified drive."""
    line = draw(seed)
    response, refused, pulled_N = measured(line, noise=1)
    found, true = response.drive, line.drive()
    radius_m = found.radius_m if found is not None else line.radius_m
    row: dict[str, Any] = {
        "seed": seed,
        "web": line.web,
        "speed_m_s": line.speed_m_s,
        "radius_m": radius_m,
        "amplitude_m_s": amplitude_m_s(line),
        "duration_s": line.duration_s,
        "pulled_N": pulled_N,
        "refused": refused,
        "found": None if found is None else asdict(found),
        "true": {
            "speed_gain_rad_s": true.K_ref_rad_s,
            "integral_time_s": 1.0 / true.corner_rad_s,
            "inertia_kg_m2": true.inertia_at(radius_m),
            "friction_N_m_s": line.declaration.rollers[0].friction_viscous_N_m_s,
            "delay_s": CYCLE_S + line.delay_s,
            "stiffness_N_m": line.stiffness_N_m,
        },
        "ripple_N": {
            "PI alone": left_N(line, None, 0.0, response),
            "true": left_N(line, true, CYCLE_S + line.delay_s, response),
        },
    }
    if found is not None:
        drive = filled_in(line, found)
        row["ripple_N"]["identified"] = left_N(line, drive, found.delay_s.value, response)
    return row


def main(arguments: list[str]) -> int:
    """Run the lines that have no row yet, then write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.identify")
    parser.add_argument("--out", type=Path, default=Path("out/identify"))
    parser.add_argument("--first", type=int, default=FIRST, help="seed of the first line")
    parser.add_argument("--lines", type=int, default=LINES)
    parser.add_argument("--docs", action="store_true", help="write docs/results/identify.md")
    options = parser.parse_args(arguments)
    rows = []
    for seed in range(options.first, options.first + options.lines):
        path = options.out / f"line{seed}.json"
        row = read_row(path, KEYS)
        if row is None:
            row = row_of(seed)
            path.parent.mkdir(parents=True, exist_ok=True)
            write_row(path, row)
        print(report.line_of(row), flush=True)
        rows.append(row)
    page = report.page(rows)
    target = report.PAGE if options.docs else options.out / "identify.md"
    target.write_text(page, encoding="utf-8")
    print(f"page: {target}")
    return 0 if math.isfinite(report.median_loss_dB(rows)) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
