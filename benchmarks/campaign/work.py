"""One case from number to row; runs in a worker process."""

from __future__ import annotations

import math
import shutil
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

from benchmarks.campaign import line as short
from benchmarks.campaign.alike import alternatives
from benchmarks.campaign.beyond import ANGLE
from benchmarks.campaign.cases import case_number
from benchmarks.campaign.effect_table import BY_NAME
from benchmarks.campaign.effects import Fault
from benchmarks.campaign.make import write_case
from benchmarks.campaign.refine_runs import refine_files


def coordinate_of(fault: dict[str, Any]) -> dict[str, float]:
    """Return where the free line of a fault is: Hz, 1/m of web, or order."""
    row = BY_NAME[fault["effect"]]
    if row.coordinate is not None:
        return row.coordinate(fault)
    order = row.order(fault["shape"])
    if fault["kind"] == ANGLE:
        return {"order": order}
    radius = {b[0]: b[2] for b in short.BODIES}.get(fault["location"], 0.0)
    return {"wavenumber_1_m": order / (2.0 * math.pi * radius)} if radius else {}


def run_case(job: tuple[int, int, Path]) -> dict[str, Any]:
    """Make one case (seed, number, folder to work in), refine it, and return the row."""
    seed, number, folder = job
    case = case_number(seed, number)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    begun = time.monotonic()  # noqa: TID251
    made = write_case(case, folder)
    between = time.monotonic()  # noqa: TID251
    burnt = time.process_time()
    found = refine_files(folder, case.without)
    spent, after = time.process_time() - burnt, time.monotonic()  # noqa: TID251
    faults = [asdict(f) for f in made.faults]
    known = alternatives(case, made.faults) if made.faults else {}
    row = {
        "number": number,
        "group": case.group,
        "seed": seed,
        "faults": faults,
        "snr": list(made.snr),
        "snr_wanted": case.snr,
        "floor": made.floor,
        "classes": list(case.classes),
        "without": list(case.without),
        "coordinate": coordinate_of(faults[0]) if case.classes else {},
        "made_s": between - begun,
        "refine_s": after - between,
        "refine_cpu_s": spent,
        "refine": found,
        **known,
    }
    shutil.rmtree(folder, ignore_errors=True)
    return row


def tell_again(row: dict[str, Any]) -> dict[str, Any]:
    """Return a row with what its record can show, worked out anew; nothing is refined again."""
    faults = tuple(Fault(**f) for f in row["faults"])
    if not faults:
        return row
    return row | alternatives(case_number(row["seed"], row["number"]), faults)
