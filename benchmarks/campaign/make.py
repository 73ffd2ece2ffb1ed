"""From a case to files: a machine, its faults at the wanted size, two records and a line file."""

from __future__ import annotations

import copy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from benchmarks.campaign import line as short
from benchmarks.campaign.cases import Case
from benchmarks.campaign.contact import Array
from benchmarks.campaign.fault import Fault
from benchmarks.campaign.record import simulate, write_line, write_record
from benchmarks.campaign.sizes import sized
from benchmarks.campaign.stage import JUDGED_FROM_S, RADII, rms, stage


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Made:
    """What is known of a case that was written.

    Attributes
    ----------
    faults : with their sizes.
    snr : reached by each, alone, in its strongest channel.
    floor : rms of record b less the same machine without noise, per channel: the best residual
        that any model can reach.
    """

    faults: tuple[Fault, ...]
    snr: tuple[float, ...]
    floor: dict[str, float]


def floors(noisy: dict[str, Array], quiet: dict[str, Array]) -> dict[str, float]:
    """Return rms of noise per channel; an angle's zero is free."""
    found = {}
    for name, values in quiet.items():
        apart = noisy[name] - values
        if name.endswith("_angle_rad"):
            apart = apart - apart[round(JUDGED_FROM_S / short.SAMPLE_S) :].mean()
        found[name] = rms(apart)
    return found


def declared_for(case: Case, which: str) -> dict[str, Any]:
    """Return the declaration with the sensors that this case keeps."""
    declared = copy.deepcopy(short.declaration(RADII[which]))
    if case.channels:
        looped = {t["load_cell"] for t in declared["control"]["tension_pi"]}
        declared["sensors"] = [
            s
            for s in declared["sensors"]
            if s["channel"] in case.channels or (s["roller"] in looped and "noise_sd_N" in s)
        ]
    return declared


def write_case(case: Case, folder: Path) -> Made:
    """Write ``a.csv``, ``b.csv``, ``a.yaml`` (the line) and ``b.yaml``; return what is true."""
    first = stage(case, "a")
    pairs = []
    if case.faults:
        healthy = first.quiet()
        noise = simulate(first.machine, first.told, first.angles, first.seed, colour=case.colour)
        floor_a = floors(noise.even(), healthy)
        pairs = [sized(case, first, f, healthy, floor_a) for f in case.faults]
    faults = tuple(f for f, _ in pairs)
    floor: dict[str, float] = {}
    for which in ("a", "b"):
        at = first if which == "a" else stage(case, "b")
        guilty = at.guilty(faults)
        record = simulate(guilty, at.told, at.angles, at.seed, colour=case.colour)
        declared = declared_for(case, which)
        kept = {s["channel"] for s in declared["sensors"]}
        written = kept | set(declared["reference_columns"])
        record = replace(record, values={k: v for k, v in record.values.items() if k in written})
        write_record(record, folder / f"{which}.csv")
        write_line(declared, folder / f"{which}.yaml")
        if which == "b":
            quiet = simulate(guilty, at.told, at.angles, at.seed, noise=False).even()
            floor = floors(record.even(), {k: quiet[k] for k in kept})
    return Made(faults=faults, snr=tuple(s for _, s in pairs), floor=floor)
