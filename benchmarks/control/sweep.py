"""``python -m benchmarks.control.sweep``: the best setting of every rival on a stated subset.

Grid search on seed 1. The score of a setting is the geometric mean, over the subset, of total
ripple against PI alone, each row counted as at most ten, so that a rival may lose a row it cannot
hold. The best setting of each goes into ``tuned.json`` and serves every row of the bench.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.control import cases, scores
from benchmarks.control.laws import rival
from benchmarks.control.lockstep import Recording, run
from benchmarks.rows import write_row
from benchmarks.workers import LostJobError, WorkerPool

Score = tuple[str, dict[str, Any], float, list[float]]
LIMIT_S = 1800.0
"""For one setting: six rows of seconds each."""
SEED = 1
WORST = 10.0
GRIDS: dict[str, dict[str, list[Any]]] = {
    "plain blocks": {"orders": [4, 8], "settle_s": [3.0, 6.0, 12.0, 25.0, 50.0]},
    "printed (5.14)": {"orders": [1, 2, 4], "gain": [1e-4, 2.5e-4, 5e-4, 1e-3]},
    "angle, no phase": {"orders": [1, 2, 4], "gain": [1e-4, 2.5e-4, 5e-4, 1e-3]},
    "resonators": {"orders": [4, 8, 16], "gain": [0.05, 0.1, 0.2, 0.3]},
    "FxLMS": {
        "orders": [16, 24],
        "turns": [3.0, 5.0, 8.0, 15.0],
        "fade_Hz": [(14.0, 16.0), (17.0, 19.0)],
    },
    "repetitive": {"gain": [0.1, 0.2, 0.4], "q_Hz": [4.0, 6.0, 8.0, 10.0], "bins": [48]},
}
SUBSET = (
    "constant Tyvek 200 FPM 8 in flat, Tyvek 300 FPM 4.75 in asym, PE 200 FPM 6.375 in bulge; "
    "first ramp Tyvek 8 in flat; all five hidden, Tyvek 200 FPM 8 in flat; 6.3 to 5.9 in of "
    "the Tyvek roll at 300 FPM"
)


def _rows() -> list[tuple[str, cases.Case, Any, float]]:
    """Return name, case, speed profile and start of the judged part of every row."""
    constant = cases.constant_cases()
    chosen = [constant[3], constant[8], constant[13]]
    rows: list[tuple[str, cases.Case, Any, float]] = [
        (c.name, c, np.full(round(40.0 / c.cycle_s), c.speed_m_s), 25.0) for c in chosen
    ]
    rows.append(("ramp", cases.ramp_cases()[0], cases.ramp_profile()[:10000], 30.0))
    hidden = next(c for c in cases.mismatch_cases() if c.note == "all5")
    rows.append((hidden.name, hidden, np.full(9000, hidden.speed_m_s), 30.0))
    roll = replace(cases.roll_cases()[0], radius_in=6.3)
    count = round(cases.roll_duration_s(roll, 5.9) / roll.cycle_s)
    rows.append(("crossing", roll, np.full(count, roll.speed_m_s), 15.0))
    return rows


_PLAIN: dict[str, Recording] = {}


def score(job: tuple[str, dict[str, Any]]) -> Score:
    """Return law, setting, geometric mean and the ripple of every row."""
    law, setting = job
    found = []
    for name, case, profile, from_s in _rows():
        common: dict[str, Any] = {
            "seed": SEED,
            "on_s": cases.ON_S,
            "cycle_s": case.cycle_s,
            "hidden": case.hidden,
        }
        if name not in _PLAIN:
            _PLAIN[name] = run(case.line(), {}, profile, **common)
        builder = rival(law, case.material, case.cycle_s, setting)
        record = run(case.line(), {"unwind": builder}, profile, **common)
        part = scores.between(record, from_s, float(record.time_s[-1]))
        ratio = scores.rms(record.tension_N[part]) / scores.rms(_PLAIN[name].tension_N[part])
        found.append(min(WORST, ratio) if math.isfinite(ratio) else WORST)
    return law, setting, float(np.exp(np.mean(np.log(found)))), found


def _jobs(laws: list[str]) -> Iterator[tuple[str, dict[str, Any]]]:
    for law in laws:
        grid = GRIDS[law]
        for values in itertools.product(*grid.values()):
            yield law, dict(zip(grid, values, strict=True))


def scored(jobs: Sequence[tuple[str, dict[str, Any]]], processes: int) -> list[Score]:
    """Return the scores in the order of the jobs, and print them as they come.

    Raises
    ------
    LostJobError
        When a setting has lost every process that was given it: the best could be that one.
    """
    found: dict[int, Score] = {}
    with WorkerPool(score, processes, limit_s=LIMIT_S, tell=_say) as pool:
        for number, result in pool.run(jobs):
            if isinstance(result, LostJobError):
                raise result
            found[number] = result
            law, setting, mean, rows = result
            _say(f"{law:16s} {setting} {mean:.3f}: {' '.join(f'{r:.3f}' for r in rows)}")
    return [found[number] for number in sorted(found)]


def _say(text: str) -> None:
    sys.stderr.write(f"{text}\n")


def main() -> int:
    """Search, print, write ``tuned.json``."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.control.sweep")
    parser.add_argument("--laws", default=",".join(GRIDS))
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "tuned.json")
    given = parser.parse_args()
    laws = [law for law in GRIDS if law in given.laws.split(",")]
    best: dict[str, Any] = json.loads(given.out.read_text()) if given.out.exists() else {}
    tried: dict[str, list[Any]] = {law: [] for law in laws}
    for law, setting, mean, rows in scored(list(_jobs(laws)), given.processes):
        tried[law].append((mean, setting, rows))
    for law, all_of in tried.items():
        mean, setting, rows = min(all_of, key=lambda t: t[0])
        best[law] = {
            "setting": setting,
            "score": mean,
            "tried": len(all_of),
            "rows": [round(r, 4) for r in rows],
        }
    write_row(given.out, best)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
