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
from benchmarks.campaign.cases import Case, case_number
from benchmarks.campaign.effect_table import BY_NAME
from benchmarks.campaign.fault import Fault
from benchmarks.campaign.make import write_case
from benchmarks.campaign.refine_runs import refine_files
from benchmarks.campaign.stage import stage


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
        "moments": web_at_moments(case, made.faults),
        **known,
    }
    shutil.rmtree(folder, ignore_errors=True)
    return row


def web_at_moments(case: Case, faults: tuple[Fault, ...]) -> dict[str, tuple[float, float]]:
    """Return per effect that begins: unstretched web off the roll by then (m), speed then (m/s).

    The web leaves at the strain of the unwind zone, whose loop holds the tension.
    """
    told = stage(case, "a").told
    found = {}
    for at, fault in enumerate(faults):
        if fault.from_s >= 0.0:
            row = fault.from_s / short.SAMPLE_S
            whole = round(row)
            run_m = float(told.speed_m_s[:whole].sum()) * short.SAMPLE_S
            speed = float(told.speed_m_s[whole])
            run_m += (row - whole) * short.SAMPLE_S * speed
            found[str(at)] = run_m / (1.0 + short.WOUND_N / short.EA_N), speed
    return found


def tell_again(row: dict[str, Any]) -> dict[str, Any]:
    """Return a row with what its record can show, worked out anew; nothing is refined again."""
    faults = tuple(Fault.read(f) for f in row["faults"])
    if not faults:
        return row
    return row | alternatives(case_number(row["seed"], row["number"]), faults)
